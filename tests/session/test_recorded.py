import json
import wave
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.utterance import Sound
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan_recording
from kinesic.session.recorded import SpokenRecording, write_recording
from kinesic.session.setup import set_up
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from tests.speech.recorded.speaking import RECORDED_TEXT, SpokenText, speak


@pytest.fixture(scope="module")
def setup() -> Setup:
    if why := espeak_fault():
        pytest.skip(why)
    return set_up(voice="espeak")


@pytest.fixture(scope="module")
def spoken(setup: Setup) -> SpokenText:
    return speak(Espeak(), pauses={3: 1.0})


@pytest.fixture(scope="module")
def recording(spoken: SpokenText, tmp_path_factory: pytest.TempPathFactory) -> SpokenRecording:
    folder = tmp_path_factory.mktemp("recorded")
    return SpokenRecording(write(spoken.sound, folder / "talk.wav"))


def write(sound: Sound, path: Path) -> Path:
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, sound.rate, 0, "NONE", ""))
        file.writeframes(np.round(32767 * np.clip(sound.samples, -1, 1)).astype("<i2").tobytes())
    return path


def test_recording_with_text_plays_with_its_marks_at_the_word_onsets(
    recording: SpokenRecording, spoken: SpokenText, setup: Setup
):
    plan = plan_recording(RECORDED_TEXT, recording, setup)
    utterance = plan.utterances["s"]
    assert (utterance.voice, utterance.duration) == ("recording", spoken.sound.duration)
    marks = {int(name[1:]) - 1: time for name, time in utterance.marks.items()}
    assert marks
    for word, time in marks.items():
        assert time == pytest.approx(spoken.starts[word], abs=0.12)
    assert not [notice.text for notice in plan.notices if "not played" in notice.text]


def test_recording_without_text_takes_its_text_from_the_file_of_word_times(
    recording: SpokenRecording, spoken: SpokenText, setup: Setup
):
    words = [
        {"word": word, "start": float(start), "end": float(start) + 0.1}
        for word, start in zip(RECORDED_TEXT.split(), spoken.starts, strict=True)
    ]
    path = recording.audio.with_suffix(".json")
    path.write_text(json.dumps({"words": words}))
    written = write_recording(None, SpokenRecording(recording.audio, path), setup)
    assert "umbrella" in written.bml
    assert f'kinesic:words="{path}"' in written.bml
    assert written.warnings == ()


def test_recording_without_text_gets_gestures_and_a_notice(recording: SpokenRecording, setup: Setup):
    plan = plan_recording(None, recording, setup)
    assert plan.utterances["s"].phonemes
    assert any("there is no text" in notice.text for notice in plan.notices)
    types = {type(behaviour.action).__name__ for behaviour in plan.timeline.block.behaviours}
    assert {"Speech", "Gesture"} <= types


def test_missing_recording_and_invalid_word_times_are_refused(recording: SpokenRecording, setup: Setup, tmp_path: Path):
    (tmp_path / "w.json").write_text('{"words": [{"word": "a", "start": -1}]}')
    with pytest.raises(ConfigError, match=r"none\.wav"):
        write_recording("Hi", SpokenRecording(tmp_path / "none.wav"), setup)
    with pytest.raises(ConfigError, match=r"w\.json: words\[0\] start is -1"):
        write_recording("Hi", SpokenRecording(recording.audio, tmp_path / "w.json"), setup)
