"""Selection of the speech engine, and playback of recordings.

A recording has precedence over an engine, and an engine over the duration model.
"""

from kinesic.body.choices import VoiceName
from kinesic.body.config import ConfigError
from kinesic.body.utterance import Voice
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.recorded.voice import RecordedVoice


def voice(name: VoiceName = "durations") -> Voice:
    """Create the voice with a name such as `auto` or `espeak`.

    Every voice also plays recordings.

    Args:
        name: `espeak` is audible; `durations` is silent and the same on every machine; `auto` is espeak if it works,
            else durations
            with a remark in every utterance.

    Raises:
        ConfigError: espeak is requested explicitly and does not work.
    """
    why = "" if name == "durations" else espeak_fault()
    if why and name == "espeak":
        raise ConfigError(f"the voice espeak cannot speak: {why}; --voice durations is silent and needs nothing")
    if why or name == "durations":
        return RecordedVoice(DurationModel(f"nothing is heard, only its duration is estimated: {why}" if why else ""))
    return RecordedVoice(Espeak())
