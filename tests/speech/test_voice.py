import os
import pickle
import wave
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.choices import VoiceName
from kinesic.body.config import ConfigError
from kinesic.body.utterance import Mark, Recording, Script
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.planning.speech import choose_rate_and_pitch, synthesise_block
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.speech import voice as module
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.hibari.model import find_package
from kinesic.speech.recording import RecordingError, read_wav
from kinesic.speech.voice import HIBARI_TABLES_MODULE, RecordedVoice, table_modules, voice

RECORDED_VOICE = RecordedVoice(DurationModel())
SAMPLE_RATE = 8000  # [Hz]
SPEECH_DOCUMENT = (  # document with one mark in its speech
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<speech id="s"><text>Hello, my <sync id="m"/>friend</text></speech></bml>'
)

AUDIO_TEMPLATE = (  # document with a recording of a given file name
    '<bml id="b"><speech id="s">hi<description type="audio/wav"><audio ref="{}"/></description></speech></bml>'
)


def test_auto_voice_speaks_if_an_engine_is_installed():
    if espeak_fault():
        pytest.skip(espeak_fault())
    utterance = plan(SPEECH_DOCUMENT, set_up(voice="auto")).utterances["s"]
    assert utterance.voice == ("espeak-ng" if find_package() is None else "hibari")
    assert utterance.sound is not None
    assert utterance.sound.duration == pytest.approx(utterance.duration)


@pytest.mark.parametrize("language", ["en", "en-GB", "fr"])
def test_auto_voice_without_the_neural_one_is_espeak(language: str, monkeypatch: pytest.MonkeyPatch, espeak: Espeak):
    monkeypatch.setattr(module, "find_package", lambda: None)
    script = Script("Hello, my friend", (Mark("m", 7),), language)
    utterance, expected = voice("auto").say(script), espeak.say(script)
    assert (utterance.voice, utterance.marks, utterance.phonemes) == ("espeak-ng", expected.marks, expected.phonemes)
    assert utterance.sound is not None
    assert expected.sound is not None
    assert np.array_equal(utterance.sound.samples, expected.sound.samples)


def test_neural_voice_lists_its_table_module_and_the_silent_voice_lists_none(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "find_package", lambda: Path("hibari"))
    assert table_modules(voice("auto")) == (HIBARI_TABLES_MODULE,)
    assert table_modules(voice("durations")) == ()


@pytest.mark.parametrize("name", ["emma", "fable", "fenrir", "kore"])
def test_voices_that_would_be_downloaded_are_refused(name: str):
    with pytest.raises(ConfigError, match=f"{name} is not in the package"):
        voice(cast(VoiceName, name))


def test_auto_voice_is_silent_without_an_engine_and_warns(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "find_package", lambda: None)
    monkeypatch.setattr(module, "espeak_fault", lambda: "espeak-ng is not installed: pip install it")
    planned = plan(SPEECH_DOCUMENT, set_up(voice="auto"))
    assert planned.utterances["s"].voice == "durations"
    (notice,) = planned.notices
    assert notice.id == "b:s"
    assert "pip install it" in notice.text


def test_requesting_the_espeak_voice_without_espeak_raises_an_error(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "espeak_fault", lambda: "espeak-ng is not installed: pip install it")
    with pytest.raises(ConfigError, match="pip install it"):
        voice("espeak")


def test_default_voice_of_the_library_is_silent_without_warnings():
    planned = plan(SPEECH_DOCUMENT, set_up())
    assert planned.utterances["s"].sound is None
    assert planned.notices == ()


@pytest.mark.parametrize("name", ["auto", "durations"])
def test_pickled_and_restored_voice_gives_the_same_mark_times(name: VoiceName):
    block = parse(SPEECH_DOCUMENT)
    setup, other_setup = set_up(voice=name), set_up()
    object.__setattr__(other_setup, "voice", pickle.loads(pickle.dumps(setup.voice)))
    assert synthesise_block(block, other_setup)["s"].marks == synthesise_block(block, setup)["s"].marks


def test_neutral_style_keeps_the_speech_rate_and_pitch_of_the_voice():
    assert choose_rate_and_pitch(Style()) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("expressivity", "faster", "higher"),
    [
        (Expressivity(temporal=1.0), True, None),
        (Expressivity(temporal=-1.0), False, None),
        (Expressivity(power=1.0), None, True),
        (Expressivity(activation=-1.0), None, False),
    ],
)
def test_expressivity_changes_speech_rate_and_pitch(
    expressivity: Expressivity, faster: bool | None, higher: bool | None
):
    for value, expected in zip(choose_rate_and_pitch(Style.uniform(expressivity)), (faster, higher), strict=True):
        assert (value > 1.0, value < 1.0) == {None: (False, False), True: (True, False), False: (False, True)}[expected]


def test_fast_style_shortens_speech():
    calm, fast = (
        plan(SPEECH_DOCUMENT, set_up(style=Style.uniform(Expressivity(temporal=t)))).utterances["s"].duration
        for t in (-1.0, 1.0)
    )
    assert calm / fast == pytest.approx(1.25**2)


def write_tone(path: Path, seconds: float = 2.0, *, width: int = 2, channels: int = 1) -> Path:
    """Write a recording of a tone with half the maximum amplitude."""
    tone = 0.5 * np.sin(2 * np.pi * 200 * np.arange(round(seconds * SAMPLE_RATE)) / SAMPLE_RATE)
    whole = np.round(tone * (2 ** (8 * width - 1) - 1)).astype("<i4")
    if width == 1:
        whole = whole + 128
    data = whole.view(np.uint8).reshape(-1, 4)[:, :width]
    with wave.open(str(path), "wb") as file:
        file.setnchannels(channels)
        file.setsampwidth(width)
        file.setframerate(SAMPLE_RATE)
        file.writeframes(np.repeat(data[:, None], channels, axis=1).tobytes())
    return path


@pytest.mark.parametrize("width", [1, 2, 3, 4])
@pytest.mark.parametrize("channels", [1, 2])
def test_wav_recordings_of_every_sample_width_are_read(width: int, channels: int, tmp_path: Path):
    sound = read_wav(write_tone(tmp_path / "tone.wav", width=width, channels=channels))
    assert (sound.rate, sound.duration) == (SAMPLE_RATE, 2.0)
    assert np.abs(sound.samples).max() == pytest.approx(0.5, abs=0.01)
    assert sound.samples.mean() == pytest.approx(0.0, abs=0.01)


def test_recording_keeps_the_mark_times_given_in_the_document(tmp_path: Path):
    recording = Recording(write_tone(tmp_path / "tone.wav"), (("two", 1.25),))
    utterance = RECORDED_VOICE.say(Script("one two", (Mark("two", 4),), recording=recording), rate=2.0)
    assert (utterance.duration, utterance.marks["two"], utterance.voice) == (2.0, 1.25, "recording")
    assert utterance.sound is not None
    assert utterance.remarks == ()
    assert utterance.phonemes[-1].start + utterance.phonemes[-1].duration == pytest.approx(2.0)


def test_recording_mark_without_a_time_is_estimated_with_a_remark(tmp_path: Path):
    recording = Recording(write_tone(tmp_path / "tone.wav"))
    utterance = RECORDED_VOICE.say(Script("one two", (Mark("two", 4),), recording=recording))
    assert utterance.marks["two"] == pytest.approx(1.0)
    assert "two" in utterance.remarks[0]


def write_bursts(path: Path, spans: tuple[tuple[float, float], ...]) -> Path:
    """Write a recording of tones in given spans [s] and faint noise."""
    times = np.arange(round(spans[-1][1] * SAMPLE_RATE)) / SAMPLE_RATE
    samples = np.random.default_rng(1).normal(0.0, 1e-3, len(times))
    for begin, end in spans:
        samples[(times >= begin) & (times < end)] = 0.3
    data = np.round(32767 * samples).astype("<i2")
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(SAMPLE_RATE)
        file.writeframes(data.tobytes())
    return path


def test_lip_sounds_stay_in_the_audible_parts_between_given_marks(tmp_path: Path):
    spans = ((0.4, 0.9), (0.95, 1.2), (2.8, 3.0), (3.1, 3.7))
    marks = (Mark("a", 0, 0.4), Mark("b", 7, 2.8), Mark("c", 10))
    recording = Recording(write_bursts(tmp_path / "bursts.wav", spans))
    utterance = RECORDED_VOICE.say(Script("Hello, my friend.", marks, recording=recording))
    starts = {sound.symbol: sound.start for sound in reversed(utterance.phonemes)}
    assert (starts["h"], starts["m"]) == pytest.approx((0.4, 2.8), abs=0.011)
    assert utterance.marks["c"] == starts["f"]
    assert 2.8 < starts["f"] < 3.3
    for sound in utterance.phonemes:  # none in the silences of more than a plosive's closure
        middle = sound.start + sound.duration / 2
        assert 0.39 < middle < 1.21 or 2.79 < middle < 3.01 or 3.09 < middle < 3.71, sound


def test_lip_sounds_of_a_silent_recording_fill_the_time_between_its_marks(tmp_path: Path):
    silent = Recording(write_bursts(tmp_path / "silent.wav", ((1.99, 2.0),)), (("two", 1.5),))
    utterance = RECORDED_VOICE.say(Script("one two", (Mark("two", 4),), recording=silent))
    first = [sound for sound in utterance.phonemes if sound.start < 1.5]
    assert (first[0].start, first[-1].start + first[-1].duration) == pytest.approx((0.0, 1.5), abs=0.01)


def test_speech_mark_defined_only_by_the_recording_is_kept(tmp_path: Path):
    recording = Recording(write_tone(tmp_path / "tone.wav"), (("bell", 0.5),))
    assert RECORDED_VOICE.say(Script("", recording=recording)).marks == {"bell": 0.5}


@pytest.mark.parametrize("time", [-1.0, 9.0])
def test_speech_mark_outside_the_recording_moves_to_the_nearest_end(time: float, tmp_path: Path):
    recording = Recording(write_tone(tmp_path / "tone.wav"), (("m", time),))
    utterance = RECORDED_VOICE.say(Script("one", (Mark("m", 0),), recording=recording))
    assert utterance.marks["m"] == min(max(time, 0.0), 2.0)
    assert "outside" in utterance.remarks[0]


def write_damaged(path: Path, damage: str) -> Path:
    whole = write_tone(path).read_bytes()
    data = {
        "empty": b"",
        "text": b"hello",
        "short": whole[:40],
        "odd": whole[:-3],
        "float": whole.replace(b"\1\0", b"\3\0", 1),
    }
    path.write_bytes(data[damage])
    return path


@pytest.mark.parametrize("damage", ["empty", "text", "short", "float"])
def test_invalid_recording_is_replaced_by_the_fallback_voice(damage: str, tmp_path: Path):
    path = write_damaged(tmp_path / "broken.wav", damage)
    with pytest.raises(RecordingError, match=r"broken\.wav"):
        read_wav(path)
    utterance = RECORDED_VOICE.say(Script("one", recording=Recording(path)))
    assert utterance.voice == "durations"
    assert "broken.wav" in utterance.remarks[0]


def test_truncated_recording_is_read_partly_or_rejected(tmp_path: Path):
    try:
        sound = read_wav(write_damaged(tmp_path / "broken.wav", "odd"))
    except RecordingError:
        return
    assert 1.9 < sound.duration <= 2.0


@pytest.mark.parametrize("name", ["missing.wav", "."])
def test_missing_recording_is_replaced_by_synthesis(name: str, tmp_path: Path):
    utterance = RECORDED_VOICE.say(Script("one", recording=Recording(tmp_path / name)))
    assert utterance.voice == "durations"
    assert "its text is spoken instead" in utterance.remarks[0]


def test_pipe_as_recording_is_rejected_without_waiting(tmp_path: Path):
    os.mkfifo(tmp_path / "endless.wav")
    with pytest.raises(RecordingError, match="is not a regular file"):
        read_wav(tmp_path / "endless.wav")


# marks with name, character and optional time [s]
TIMED_MARKS = (Mark("m", 6, 0.25), Mark("n", 10), Mark("late", 10, 9.0))


def test_marks_keep_times_given_in_the_text_and_differing_estimates_give_a_remark():
    utterance = RECORDED_VOICE.say(Script("Hello my friend", TIMED_MARKS))
    assert (utterance.marks["m"], utterance.marks["late"]) == (0.25, utterance.duration)
    assert utterance.marks["n"] == DurationModel().say(Script("Hello my friend", TIMED_MARKS)).marks["n"]
    (remark,) = utterance.remarks
    assert "m (given 0.25 s, said " in remark
    assert "late (given 9 s" in remark
    close_time = DurationModel().say(Script("Hello my friend", TIMED_MARKS)).marks["m"] + 0.04
    assert RECORDED_VOICE.say(Script("Hello my friend", (Mark("m", 6, close_time),))).remarks == ()


def test_speech_mark_times_given_in_the_text_apply_to_a_recording(tmp_path: Path):
    with wave.open(str(tmp_path / "hello.wav"), "wb") as file:
        file.setparams((1, 2, SAMPLE_RATE, 0, "NONE", ""))
        file.writeframes(bytes(2 * 2 * SAMPLE_RATE))
    named = Recording(tmp_path / "hello", (("n", 1.5),))
    utterance = RECORDED_VOICE.say(Script("Hello my friend", (Mark("m", 6, 0.25), Mark("n", 10, 0.5)), recording=named))
    assert (utterance.voice, utterance.marks, utterance.remarks) == ("recording", {"m": 0.25, "n": 1.5}, ())
    missing = RECORDED_VOICE.say(Script("Hello", (Mark("m", 5, 0.125),), recording=Recording(tmp_path / "none")))
    assert missing.marks["m"] == 0.125
    assert "its text is spoken instead" in missing.remarks[0]


@pytest.mark.parametrize("name", ["../away.wav", "{outside}/away.wav", "link.wav", "link", "../away", "pipe.wav"])
def test_recording_outside_the_document_folder_is_not_played(name: str, tmp_path: Path):
    folder = tmp_path / "folder"
    folder.mkdir()
    write_tone(tmp_path / "away.wav")
    (folder / "link.wav").symlink_to("../away.wav")
    os.mkfifo(folder / "pipe.wav")
    document = AUDIO_TEMPLATE.format(name.format(outside=tmp_path))
    utterance = synthesise_block(parse(document, source=str(folder / "my.bml")), set_up())["s"]
    assert utterance.voice != "recording"
    assert "its text is spoken instead" in utterance.remarks[0]
    assert "is outside of the folder" in utterance.remarks[0] or "is not a regular file" in utterance.remarks[0]


@pytest.mark.parametrize("name", ["own.wav", "own", "below/own.wav", "near.wav"])
def test_recording_in_the_document_folder_is_played(name: str, tmp_path: Path):
    (tmp_path / "below").mkdir()
    write_tone(tmp_path / "own.wav")
    write_tone(tmp_path / "below" / "own.wav")
    (tmp_path / "near.wav").symlink_to("below/own.wav")
    utterance = synthesise_block(parse(AUDIO_TEMPLATE.format(name), source=str(tmp_path / "my.bml")), set_up())["s"]
    assert (utterance.voice, utterance.duration) == ("recording", 2.0)
