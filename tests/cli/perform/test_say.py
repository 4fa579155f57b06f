import json
import wave

import numpy as np
import pytest

TEXT = "Hello! There were three big boxes."


def test_say_prints_bml_that_plan_reads(kinesic):
    printed = kinesic("say", TEXT, "--to", "bml")
    assert printed.code == 0
    assert "kinesic:reason=" in printed.out
    assert kinesic("plan", "-", stdin=printed.out.encode()).code == 0


def test_say_prints_bml_of_standard_input(kinesic):
    typed, piped = kinesic("say", TEXT, "--to", "bml"), kinesic("say", "-", "--to", "bml", stdin=TEXT.encode())
    assert (piped.code, piped.out) == (typed.code, typed.out) == (0, typed.out)


def test_report_of_a_plain_text_file_states_why_each_behaviour_was_chosen(kinesic, tmp_path):
    (tmp_path / "story.txt").write_text(TEXT)
    ended = kinesic("perform", tmp_path / "story.txt", "--no-film", "--json", "--voice", "durations")
    rows = json.loads(ended.out)["behaviours"]
    assert all(row["reason"] for row in rows if row["type"] != "speech")
    assert "dropped" not in {row["outcome"] for row in rows}


def test_report_of_a_spoken_text_names_said_as_its_input_because_there_is_no_file(kinesic, tmp_path):
    ended = kinesic("say", TEXT, "--no-film", "--voice", "durations", "--out", tmp_path / "out")
    assert ended.code == 0, ended.err
    assert json.loads((tmp_path / "out" / "report.json").read_text())["input"] == "said"


def write_noise(path):
    """Write a second of noise between silences."""
    samples = np.concatenate([np.zeros(4000), np.random.default_rng(1).normal(0.0, 6000.0, 8000), np.zeros(4000)])
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 8000, 0, "NONE", ""))
        file.writeframes(samples.astype("<i2").tobytes())
    return path


def test_bml_of_a_recording_refers_to_the_audio_file_and_its_word_times(kinesic, tmp_path):
    (tmp_path / "talk.srt").write_text("1\n00:00:00,500 --> 00:00:01,500\nThree big boxes.\n")
    audio = write_noise(tmp_path / "talk.wav")
    ended = kinesic("say", "--audio", audio, "--words", tmp_path / "talk.srt", "--to", "bml", "--voice", "durations")
    assert ended.code == 0, ended.err
    assert "big" in ended.out
    assert f'<audio ref="{audio}" kinesic:words="{tmp_path / "talk.srt"}"/>' in ended.out


def test_say_warns_that_speech_from_a_recording_has_no_text(kinesic, tmp_path):
    ended = kinesic("say", "--audio", write_noise(tmp_path / "talk.wav"), "--to", "bml")
    assert ended.code == 0
    assert "there is no text" in ended.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "give a TEXT or a recording"),
        (("Hi", "--words", "w.json"), "--words: the times of words need a recording"),
        (("-", "--audio", "talk.wav"), "standard input has no recording"),
        (("--audio", "missing.wav"), "missing.wav: No such file"),
    ],
)
def test_invalid_use_of_recordings_is_refused_without_a_traceback(kinesic, arguments, message):
    ended = kinesic("say", *arguments, "--to", "bml")
    assert ended.code == 2
    assert message in ended.err
    assert "Traceback" not in ended.err
