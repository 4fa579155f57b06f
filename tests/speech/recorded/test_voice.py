import json
import wave
from pathlib import Path

import numpy as np
import pytest

from kinesic.bml.block import Speech
from kinesic.bml.parse import parse
from kinesic.body.utterance import Mark, Recording, Script, Sound
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak import Espeak
from kinesic.speech.recorded.voice import RecordedVoice
from tests.speech.recorded.speaking import RECORDED_TEXT, speak

# marks before two words and at the end of the text
TEXT_MARKS = (
    Mark("a", RECORDED_TEXT.index("please")),
    Mark("b", RECORDED_TEXT.index("umbrella")),
    Mark("end_of_text", len(RECORDED_TEXT)),
)


def write(sound: Sound, path: Path) -> Path:
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, sound.rate, 0, "NONE", ""))
        file.writeframes(np.round(32767 * np.clip(sound.samples, -1, 1)).astype("<i2").tobytes())
    return path


def write_words(path: Path, words: list[tuple[str, float, float]]) -> Path:
    path.write_text(json.dumps({"words": [{"word": w, "start": a, "end": b} for w, a, b in words]}))
    return path


def test_marks_of_a_recording_without_word_times_are_located_by_sound(espeak: Espeak, tmp_path: Path):
    spoken = speak(espeak, pauses={3: 1.0})
    recording = Recording(write(spoken.sound, tmp_path / "r.wav"))
    utterance = RecordedVoice(espeak).say(Script(RECORDED_TEXT, TEXT_MARKS, recording=recording), rate=2.0)
    assert utterance.marks["a"] == pytest.approx(spoken.starts[1], abs=0.06)
    assert utterance.marks["b"] == pytest.approx(spoken.starts[6], abs=0.06)
    assert utterance.marks["end_of_text"] == pytest.approx(spoken.sound.duration, abs=0.3)
    assert (utterance.voice, utterance.remarks) == ("recording", ())
    assert utterance.duration == spoken.sound.duration


def test_marks_take_the_exact_word_times_of_a_timing_file(espeak: Espeak, tmp_path: Path):
    spoken = speak(espeak)
    texts = RECORDED_TEXT.replace(",", "").replace(".", "").split()
    ends = [*(spoken.starts[1:] - 0.01), spoken.sound.duration]
    spans = zip(texts, spoken.starts, ends, strict=True)
    words = write_words(tmp_path / "r.json", [(text, float(begin), float(end)) for text, begin, end in spans])
    recording = Recording(write(spoken.sound, tmp_path / "r.wav"), words=words)
    utterance = RecordedVoice(espeak).say(Script(RECORDED_TEXT, TEXT_MARKS, recording=recording))
    assert utterance.marks["a"] == float(spoken.starts[1])
    assert utterance.marks["b"] == float(spoken.starts[6])
    assert utterance.remarks == ()


def test_words_without_a_time_in_the_timing_file_are_counted_in_a_remark(espeak: Espeak, tmp_path: Path):
    spoken = speak(espeak)
    words = write_words(tmp_path / "r.json", [("please", float(spoken.starts[1]), float(spoken.starts[2]) - 0.01)])
    recording = Recording(write(spoken.sound, tmp_path / "r.wav"), words=words)
    utterance = RecordedVoice(espeak).say(Script(RECORDED_TEXT, TEXT_MARKS, recording=recording))
    (remark,) = utterance.remarks
    assert "11 of 12 words of the text have no time in the Whisper JSON" in remark
    assert utterance.marks["b"] == pytest.approx(spoken.starts[6], abs=0.08)


def test_invalid_timing_file_is_reported_and_words_are_located_by_sound(espeak: Espeak, tmp_path: Path):
    spoken = speak(espeak)
    (tmp_path / "r.json").write_text('{"words": [{"word": "please", "start": -1}]}')
    recording = Recording(write(spoken.sound, tmp_path / "r.wav"), words=tmp_path / "r.json")
    utterance = RecordedVoice(espeak).say(Script(RECORDED_TEXT, TEXT_MARKS, recording=recording))
    (remark,) = utterance.remarks
    assert "words[0] start is -1" in remark
    assert remark.endswith("the words are found by their sound")
    assert utterance.marks["b"] == pytest.approx(spoken.starts[6], abs=0.06)


def test_given_word_times_place_marks_without_an_engine(tmp_path: Path):
    words = write_words(tmp_path / "r.json", [("one", 0.2, 0.5), ("two", 1.4, 1.8)])
    sound = Sound.of(8000, 0.3 * np.ones(16_000))
    recording = Recording(write(sound, tmp_path / "r.wav"), words=words)
    utterance = RecordedVoice(DurationModel()).say(Script("One two", (Mark("m", 4),), recording=recording))
    assert utterance.marks["m"] == pytest.approx(1.4)
    assert utterance.remarks == ()


def test_visemes_of_a_timing_file_become_the_phonemes_of_the_recording(espeak: Espeak, tmp_path: Path):
    (tmp_path / "r.jsonl").write_text(
        '{"time":100,"type":"word","value":"Pa"}\n{"time":100,"type":"viseme","value":"p"}\n'
        '{"time":200,"type":"viseme","value":"a"}\n{"time":900,"type":"viseme","value":"sil"}\n'
    )
    sound = Sound.of(8000, 0.3 * np.random.default_rng(1).normal(size=8000))
    recording = Recording(write(sound, tmp_path / "r.wav"), words=tmp_path / "r.jsonl")
    utterance = RecordedVoice(espeak).say(Script("Pa", recording=recording))
    assert [(s.symbol, s.start, pytest.approx(s.end)) for s in utterance.phonemes] == [("p", 0.1, 0.2), ("a", 0.2, 0.9)]


@pytest.mark.parametrize("attribute", ["words", "kinesic:words"])
def test_words_attribute_of_an_audio_element_sets_the_timing_file(attribute: str, tmp_path: Path):
    document = (
        '<bml xmlns:kinesic="urn:kinesic" id="b"><speech id="s">one two<description type="audio/wav">'
        f'<audio ref="r.wav" {attribute}="r.json"/></description></speech></bml>'
    )
    (behaviour,) = parse(document, source=str(tmp_path / "my.bml")).behaviours
    assert isinstance(behaviour.action, Speech)
    recording = behaviour.action.script.recording
    assert recording == Recording(tmp_path / "r.wav", (), tmp_path, tmp_path / "r.json")


def test_timing_file_outside_the_folder_of_the_recording_is_not_read(espeak: Espeak, tmp_path: Path):
    folder = tmp_path / "folder"
    folder.mkdir()
    spoken = speak(espeak)
    words = write_words(tmp_path / "away.json", [("please", 0.0, 0.1)])
    recording = Recording(write(spoken.sound, folder / "r.wav"), (), folder, words)
    (remark,) = RecordedVoice(espeak).say(Script(RECORDED_TEXT, TEXT_MARKS, recording=recording)).remarks
    assert "is outside of the folder" in remark


def test_recording_without_text_moves_the_lips_by_its_sound_with_a_remark(espeak: Espeak, tmp_path: Path):
    spoken = speak(espeak)
    recording = Recording(write(spoken.sound, tmp_path / "r.wav"), (("bell", 99.0),))
    for voice in (espeak, DurationModel()):
        utterance = RecordedVoice(voice).say(Script("", (Mark("m", 0),), recording=recording))
        assert utterance.phonemes
        assert utterance.marks == {"m": 0.0, "bell": spoken.sound.duration}
        assert "lips follow its loudness and spectrum alone" in utterance.remarks[0]


def test_document_parsed_from_text_uses_recordings_only_from_a_given_folder(tmp_path: Path):
    document = (
        '<bml id="b"><speech id="s">one<description type="audio/wav"><audio ref="r.wav"/></description></speech></bml>'
    )
    (behaviour,) = parse(document, recordings=tmp_path).behaviours
    assert isinstance(behaviour.action, Speech)
    assert behaviour.action.script.recording == Recording(tmp_path / "r.wav", (), tmp_path)
    (unplayed,) = parse(document).behaviours
    assert isinstance(unplayed.action, Speech)
    assert unplayed.action.script.recording is None
