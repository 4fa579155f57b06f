"""Reads a document as a block, whatever somebody wrote: BML, or FML-APML, whose intentions become behaviours."""

from kinesic.bml.block import Block
from kinesic.bml.parse import parse
from kinesic.intent.fml.author import is_fml, parse_fml
from kinesic.planning.setup import Setup


def read_block(text: str | bytes, known: Setup, *, source: str = "<text>") -> Block:
    """Reads one document; intentions are shown as the seed of the setup has it.

    Raises:
        BmlError: the document is refused.
    """
    if known.dialect in ("auto", "fml-apml") and is_fml(text):
        return parse_fml(text, source=source, performer=known.character, seed=known.idling.seed)
    return parse(text, source=source, dialect=known.dialect, performer=known.character)
