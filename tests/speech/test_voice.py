import os
import pickle
import wave
from pathlib import Path

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.config import ConfigError
from kinesic.body.utterance import Mark, Recording, Script
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.planning.speech import choose_rate_and_pitch, synthesise_block
from kinesic.speech import voice as module
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.recording import RecordingError, read_wav
from kinesic.speech.voice import Recorded, voice

VOICE = Recorded(DurationModel())
RATE = 8000
SPEECH = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<speech id="s"><text>Hello, my <sync id="m"/>friend</text></speech></bml>'
)

SPOKEN = '<bml id="b"><speech id="s">hi<description type="audio/wav"><audio ref="{}"/></description></speech></bml>'


def test_auto_speaks_where_an_engine_is_installed():
    if espeak_fault():
        pytest.skip(espeak_fault())
    said = plan(SPEECH, set_up(voice="auto")).utterances["s"]
    assert said.voice == "espeak-ng"
    assert said.sound is not None
    assert said.sound.duration == pytest.approx(said.duration)


def test_auto_is_silent_elsewhere_and_warns(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "espeak_fault", lambda: "espeak-ng is not installed: pip install it")
    planned = plan(SPEECH, set_up(voice="auto"))
    assert planned.utterances["s"].voice == "durations"
    (notice,) = planned.notices
    assert notice.id == "b:s"
    assert "pip install it" in notice.text


def test_an_engine_asked_for_by_name_must_be_there(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "espeak_fault", lambda: "espeak-ng is not installed: pip install it")
    with pytest.raises(ConfigError, match="pip install it"):
        voice("espeak")


def test_the_library_is_silent_and_says_nothing_of_it_unless_asked():
    planned = plan(SPEECH, set_up())
    assert planned.utterances["s"].sound is None
    assert planned.notices == ()


@pytest.mark.parametrize("name", ["auto", "durations"])
def test_a_voice_can_go_to_another_process(name: module.VoiceName):
    block = parse(SPEECH)
    ours, theirs = set_up(voice=name), set_up()
    object.__setattr__(theirs, "voice", pickle.loads(pickle.dumps(ours.voice)))
    assert synthesise_block(block, theirs)["s"].marks == synthesise_block(block, ours)["s"].marks


def test_a_neutral_style_speaks_as_the_voice_does():
    assert choose_rate_and_pitch(Style()) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("manner", "faster", "higher"),
    [
        (Expressivity(temporal=1.0), True, None),
        (Expressivity(temporal=-1.0), False, None),
        (Expressivity(power=1.0), None, True),
        (Expressivity(activation=-1.0), None, False),
    ],
)
def test_manner_changes_rate_and_pitch(manner: Expressivity, faster: bool | None, higher: bool | None):
    for value, expected in zip(choose_rate_and_pitch(Style.uniform(manner)), (faster, higher), strict=True):
        assert (value > 1.0, value < 1.0) == {None: (False, False), True: (True, False), False: (False, True)}[expected]


def test_a_fast_style_is_heard_sooner():
    calm, fast = (
        plan(SPEECH, set_up(style=Style.uniform(Expressivity(temporal=t)))).utterances["s"].duration
        for t in (-1.0, 1.0)
    )
    assert calm / fast == pytest.approx(1.25**2)


def wav(path: Path, seconds: float = 2.0, *, width: int = 2, channels: int = 1) -> Path:
    """A tone of half the largest loudness."""
    tone = 0.5 * np.sin(2 * np.pi * 200 * np.arange(round(seconds * RATE)) / RATE)
    whole = np.round(tone * (2 ** (8 * width - 1) - 1)).astype("<i4")
    if width == 1:
        whole = whole + 128
    data = whole.view(np.uint8).reshape(-1, 4)[:, :width]
    with wave.open(str(path), "wb") as file:
        file.setnchannels(channels)
        file.setsampwidth(width)
        file.setframerate(RATE)
        file.writeframes(np.repeat(data[:, None], channels, axis=1).tobytes())
    return path


@pytest.mark.parametrize("width", [1, 2, 3, 4])
@pytest.mark.parametrize("channels", [1, 2])
def test_plain_files_of_every_width_are_read(width: int, channels: int, tmp_path: Path):
    sound = read_wav(wav(tmp_path / "tone.wav", width=width, channels=channels))
    assert (sound.rate, sound.duration) == (RATE, 2.0)
    assert np.abs(sound.samples).max() == pytest.approx(0.5, abs=0.01)
    assert sound.samples.mean() == pytest.approx(0.0, abs=0.01)


def test_a_recording_is_played_with_the_times_that_it_is_given(tmp_path: Path):
    recording = Recording(wav(tmp_path / "tone.wav"), (("two", 1.25),))
    said = VOICE.say(Script("one two", (Mark("two", 4),), recording=recording), rate=2.0)
    assert (said.duration, said.marks["two"], said.voice) == (2.0, 1.25, "recording")
    assert said.sound is not None
    assert said.remarks == ()
    assert said.phonemes[-1].start + said.phonemes[-1].duration == pytest.approx(2.0)


def test_a_mark_without_a_time_is_estimated_and_says_so(tmp_path: Path):
    recording = Recording(wav(tmp_path / "tone.wav"))
    said = VOICE.say(Script("one two", (Mark("two", 4),), recording=recording))
    assert said.marks["two"] == pytest.approx(1.0)
    assert "two" in said.remarks[0]


def test_a_mark_of_the_recording_alone_is_a_mark(tmp_path: Path):
    recording = Recording(wav(tmp_path / "tone.wav"), (("bell", 0.5),))
    assert VOICE.say(Script("", recording=recording)).marks == {"bell": 0.5}


@pytest.mark.parametrize("time", [-1.0, 9.0])
def test_a_mark_outside_is_at_the_nearest_end(time: float, tmp_path: Path):
    recording = Recording(wav(tmp_path / "tone.wav"), (("m", time),))
    said = VOICE.say(Script("one", (Mark("m", 0),), recording=recording))
    assert said.marks["m"] == min(max(time, 0.0), 2.0)
    assert "outside" in said.remarks[0]


def damaged(path: Path, damage: str) -> Path:
    whole = wav(path).read_bytes()
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
def test_a_file_that_is_no_recording_is_said_instead(damage: str, tmp_path: Path):
    path = damaged(tmp_path / "broken.wav", damage)
    with pytest.raises(RecordingError, match=r"broken\.wav"):
        read_wav(path)
    said = VOICE.say(Script("one", recording=Recording(path)))
    assert said.voice == "durations"
    assert "broken.wav" in said.remarks[0]


def test_a_file_that_ends_too_soon_is_read_as_far_as_it_goes_or_refused(tmp_path: Path):
    try:
        sound = read_wav(damaged(tmp_path / "broken.wav", "odd"))
    except RecordingError:
        return
    assert 1.9 < sound.duration <= 2.0


@pytest.mark.parametrize("name", ["missing.wav", "."])
def test_a_file_that_is_not_there_is_said_instead(name: str, tmp_path: Path):
    said = VOICE.say(Script("one", recording=Recording(tmp_path / name)))
    assert said.voice == "durations"
    assert "said instead" in said.remarks[0]


def test_a_pipe_is_no_recording_and_nobody_waits_for_it(tmp_path: Path):
    os.mkfifo(tmp_path / "endless.wav")
    with pytest.raises(RecordingError, match="is no ordinary file"):
        read_wav(tmp_path / "endless.wav")


TIMED = (Mark("m", 6, 0.25), Mark("n", 10), Mark("late", 10, 9.0))


def test_marks_fall_when_the_document_says():
    said = VOICE.say(Script("Hello my friend", TIMED))
    assert (said.marks["m"], said.marks["late"]) == (0.25, said.duration)
    assert said.marks["n"] == DurationModel().say(Script("Hello my friend", TIMED)).marks["n"]
    (remark,) = said.remarks
    assert "m (given 0.25 s, said " in remark
    assert "late (given 9 s" in remark
    near = DurationModel().say(Script("Hello my friend", TIMED)).marks["m"] + 0.04
    assert VOICE.say(Script("Hello my friend", (Mark("m", 6, near),))).remarks == ()


def test_marks_in_the_text_say_when_they_fall_in_a_recording(tmp_path: Path):
    with wave.open(str(tmp_path / "hello.wav"), "wb") as file:
        file.setparams((1, 2, RATE, 0, "NONE", ""))
        file.writeframes(bytes(2 * 2 * RATE))
    named = Recording(tmp_path / "hello", (("n", 1.5),))
    said = VOICE.say(Script("Hello my friend", (Mark("m", 6, 0.25), Mark("n", 10, 0.5)), recording=named))
    assert (said.voice, said.marks, said.remarks) == ("recording", {"m": 0.25, "n": 1.5}, ())
    gone = VOICE.say(Script("Hello", (Mark("m", 5, 0.125),), recording=Recording(tmp_path / "none")))
    assert gone.marks["m"] == 0.125
    assert "it is said instead" in gone.remarks[0]


@pytest.mark.parametrize("name", ["../away.wav", "{outside}/away.wav", "link.wav", "link", "../away", "pipe.wav"])
def test_a_document_plays_no_recording_of_another_folder(name: str, tmp_path: Path):
    folder = tmp_path / "folder"
    folder.mkdir()
    wav(tmp_path / "away.wav")
    (folder / "link.wav").symlink_to("../away.wav")
    os.mkfifo(folder / "pipe.wav")
    document = SPOKEN.format(name.format(outside=tmp_path))
    said = synthesise_block(parse(document, source=str(folder / "my.bml")), set_up())["s"]
    assert said.voice != "recording"
    assert "it is said instead" in said.remarks[0]
    assert "is outside of the folder" in said.remarks[0] or "is no ordinary file" in said.remarks[0]


@pytest.mark.parametrize("name", ["own.wav", "own", "below/own.wav", "near.wav"])
def test_a_document_plays_recordings_of_its_folder(name: str, tmp_path: Path):
    (tmp_path / "below").mkdir()
    wav(tmp_path / "own.wav")
    wav(tmp_path / "below" / "own.wav")
    (tmp_path / "near.wav").symlink_to("below/own.wav")
    said = synthesise_block(parse(SPOKEN.format(name), source=str(tmp_path / "my.bml")), set_up())["s"]
    assert (said.voice, said.duration) == ("recording", 2.0)
