"""Selection of the speech engine, and playback of recordings.

A recording has precedence over an engine, and an engine over the duration model.
"""

from kinesic.body.choices import VoiceName
from kinesic.body.config import ConfigError
from kinesic.body.utterance import Voice
from kinesic.speech.durations import DurationModel
from kinesic.speech.engines.engine_voice import EngineVoice
from kinesic.speech.engines.phrase import SpeechEngine
from kinesic.speech.english_voice import EnglishVoice
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.hibari.engine import Hibari
from kinesic.speech.hibari.model import find_installation_fault, find_package
from kinesic.speech.recorded.voice import RecordedVoice

HIBARI_TABLES_MODULE = "kinesic.speech.hibari.read_ahead"  # module that reads the lexicon of hibari at import
DOWNLOADED_VOICES = ("emma", "fable", "fenrir", "kore")  # voices of hibari-tts that are not in its package


def voice(name: VoiceName = "durations", *, engine: SpeechEngine | None = None) -> Voice:
    """Create the voice with a name such as `auto` or `espeak`.

    Every voice also plays recordings.

    Args:
        name: `hibari` and `espeak` are audible; `durations` is silent and the same on every machine; `auto` is hibari
            for English if it is installed, else espeak if it works, else durations with a remark in every utterance.
        engine: own engine that speaks all languages in place of the named voice.

    Raises:
        ConfigError: a voice is requested explicitly and does not work, or would have to be downloaded.
    """
    if engine is not None:
        return RecordedVoice(EngineVoice(engine))
    if name in DOWNLOADED_VOICES:
        raise ConfigError(f"the voice {name} is not in the package hibari-tts and nothing is downloaded; use hibari")
    if name == "durations":
        return RecordedVoice(DurationModel())
    if name == "hibari":
        if why := find_installation_fault():
            raise ConfigError(f"the voice hibari cannot speak: {why}; --voice durations is silent and needs nothing")
        return RecordedVoice(EnglishVoice(EngineVoice(Hibari(), Espeak()), Espeak(), is_requested=True))
    if name == "auto" and find_package() is not None:
        return RecordedVoice(EnglishVoice(EngineVoice(Hibari(), Espeak()), Espeak()))
    why = espeak_fault()
    if why and name == "espeak":
        raise ConfigError(f"the voice espeak cannot speak: {why}; --voice durations is silent and needs nothing")
    if why:
        return RecordedVoice(DurationModel(f"no sound, only an estimated duration: {why}"))
    return RecordedVoice(Espeak())


def table_modules(voice: Voice) -> tuple[str, ...]:
    """Return names of modules that load a voice's lexicon at import."""
    match voice:
        case RecordedVoice():
            return table_modules(voice.voice)
        case EnglishVoice():
            return table_modules(voice.english)
        case EngineVoice(engine=Hibari()):
            return (HIBARI_TABLES_MODULE,)
    return ()
