import pytest

from kinesic.body.utterance import Script
from kinesic.speech.durations import DurationModel
from kinesic.speech.engines.engine_voice import EngineVoice
from kinesic.speech.english_voice import EnglishVoice

from .engines.tone_engine import ToneEngine

ENGLISH, OTHER = EngineVoice(ToneEngine()), DurationModel()


@pytest.mark.parametrize(
    ("language", "chosen", "requested"),
    [
        ("en", "tones", "tones"),
        ("EN_us", "tones", "tones"),
        ("en-GB", "durations", "tones"),
        ("fr", "durations", "durations"),
    ],
)
def test_english_voice_speaks_en_us_text_and_british_text_only_on_request(language: str, chosen: str, requested: str):
    script = Script("one", language=language)
    said = EnglishVoice(ENGLISH, OTHER).say(script)
    assert (said.voice, said.remarks) == (chosen, ())
    asked = EnglishVoice(ENGLISH, OTHER, is_requested=True).say(script)
    assert asked.voice == requested
    assert bool(asked.remarks) == (language in ("en-GB", "fr"))
