"""Chooses who speaks: an engine where one is installed, else the model of durations."""

from kinesic.body.choices import VoiceName
from kinesic.body.config import ConfigError
from kinesic.body.utterance import Voice
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.recorded import Recorded


def voice(name: VoiceName = "durations") -> Voice:
    """Makes the voice of a name; each plays recordings, too.

    Args:
        name: `espeak` is heard; `durations` is silent and the same on every machine; `auto` is espeak where it works,
            else durations, and then every utterance remarks why it is not heard.

    Raises:
        ConfigError: espeak is asked for by its name and does not work.
    """
    why = "" if name == "durations" else espeak_fault()
    if why and name == "espeak":
        raise ConfigError(f"the voice espeak cannot speak: {why}; --voice durations is silent and needs nothing")
    if why or name == "durations":
        return Recorded(DurationModel(f"nothing is heard, only the time that it takes is known: {why}" if why else ""))
    return Recorded(Espeak())
