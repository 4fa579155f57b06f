"""Loading of the pronunciation lexicon at import, before processes are forked.

The lexicon takes 95 MB. The model is loaded in each process, because its library has threads, which a fork loses.
"""

from contextlib import suppress

from kinesic.speech.engines.phrase import EngineError
from kinesic.speech.hibari.pronunciation import load_reader

with suppress(EngineError):  # a speech reports the reason
    load_reader()
