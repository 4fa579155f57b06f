import pickle
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.utterance import Mark, Phoneme, Script
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.speech.engines import program as module
from kinesic.speech.engines.engine_voice import EngineVoice
from kinesic.speech.engines.phrase import EngineError, Phrase, UnreadableError
from kinesic.speech.engines.program import EngineProgram

TONE_PROGRAM = Path(__file__).with_name("tone_program.py")  # path of a speech program whose words are tones
WORD_DURATION = 0.3  # [s] duration of a word that the program speaks


def start(fault: str = "") -> EngineProgram:
    return EngineProgram((sys.executable, str(TONE_PROGRAM), *filter(None, [fault])))


@pytest.fixture(autouse=True)
def _ended() -> Iterator[None]:
    yield
    module._dismiss()
    assert module._running == {}


@pytest.mark.parametrize("form", ["", "wav"])
def test_speech_program_provides_the_sound_and_word_times_of_a_phrase(form: str):
    engine = start(form)
    utterance = EngineVoice(engine).say(Script("one two. Three", (Mark("two", 4),)), rate=2.0)
    assert utterance.sound is not None
    assert utterance.remarks == ()
    assert utterance.marks["two"] == pytest.approx(WORD_DURATION / 2, abs=0.001)
    assert np.abs(utterance.sound.samples).max() == pytest.approx(12000 / 32768, abs=1e-4)
    assert utterance.voice == engine.name


def test_speech_program_reports_phonemes_with_their_articulation_times():
    (phoneme,) = start("phonemes").speak(Phrase("one")).phonemes
    assert phoneme == Phoneme("b", 0.1, pytest.approx(0.2), 0.04, 0.1)


def test_speech_program_is_started_once_for_two_phrases():
    engine = start()
    engine.speak(Phrase("one"))
    (process,) = module._running.values()
    engine.speak(Phrase("two"))
    assert list(module._running.values()) == [process]


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("error", "no such voice"),
        ("odd", "3 bytes at 8000 Hz are no samples"),
        ("long", "bytes, must be 0 to"),
        ("rate", "at 0 Hz"),
        ("short", "its sound ends after"),
        ("broken_wav", "no WAV file"),
        ("json", "no valid JSON"),
        ("ends", "the program ended: model not found"),
    ],
)
def test_faulty_answer_of_a_speech_program_is_reported_with_its_reason(fault: str, reason: str):
    with pytest.raises(EngineError, match=reason):
        start(fault).speak(Phrase("one two"))


def test_phrase_that_the_speech_program_cannot_read_raises_an_unreadable_error():
    with pytest.raises(UnreadableError, match="not a word"):
        start("unreadable").speak(Phrase("one"))


def test_speech_program_that_does_not_answer_within_the_timeout_is_stopped(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "ANSWER_TIMEOUT", 0.2)
    with pytest.raises(EngineError, match=r"no answer within 0\.2 s"):
        start("hangs").speak(Phrase("one"))
    assert module._running == {}


@pytest.mark.parametrize("text", ["", "no_such_program_here -x", "'unclosed"])
def test_speech_command_that_names_no_installed_program_is_rejected(text: str):
    with pytest.raises(ConfigError, match="the speech engine"):
        EngineProgram.of(text)


def test_speech_command_in_the_setup_gives_the_mark_times_of_a_block():
    command = shlex.join([sys.executable, str(TONE_PROGRAM)])
    block = '<bml id="b"><speech id="s"><text>one <sync id="m"/>two</text></speech></bml>'
    planned = plan(block, set_up(engine=command))
    assert planned.utterances["s"].marks["m"] == pytest.approx(WORD_DURATION, abs=0.001)
    assert planned.notices == ()
    assert pickle.loads(pickle.dumps(EngineProgram.of(command))) == EngineProgram.of(command)


def test_display_name_of_a_long_speech_command_has_at_most_60_characters():
    assert len(EngineProgram(("python", "x" * 200)).name) <= 60
