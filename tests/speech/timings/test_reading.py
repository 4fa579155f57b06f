import os
from pathlib import Path

import pytest

from kinesic.speech.timings import reading
from kinesic.speech.timings.reading import read_timed_words, read_words_file
from kinesic.speech.timings.timed_words import TimingError


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "the file is empty"),
        (b"  \n", "the file is empty"),
        (b"Hello my friend", "the format is unknown; the formats are Whisper, ElevenLabs"),
        (b"\x00\xff\x80binary", "byte 1 is not UTF-8"),
        (b'{"hello": 1}', "the JSON has none of the keys segments, words"),
        (b'{"segments": []}', r"no word has a time \(Whisper JSON\)"),
        (b'{"segments": [{"words": [{"word": "a", "start": NaN}]}]}', "JSON is malformed"),
        (b'{"segments": [{"words": [', "truncated"),
        (b"<html></html>", "the XML is no file of ELAN"),
        (b'{"words":' + b"[" * 100_000, "nested|malformed|truncated|got `array`"),
        (b"[" * 100_000, "nested|malformed|truncated|got `array`"),
        (b'{"a":' * 100_000, "nested|malformed|truncated"),
        (b"[1]", "Expected `object`, got `int`"),
    ],
)
def test_wrong_or_hostile_file_is_refused_in_one_line(content: bytes, message: str):
    with pytest.raises(TimingError, match=message) as error:
        read_timed_words(content, source="times.json")
    assert str(error.value).startswith("times.json: ")
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 300


def test_file_above_the_size_limit_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(reading, "MAX_BYTES", 10)
    (tmp_path / "a.json").write_bytes(b"[]" * 10)
    with pytest.raises(TimingError, match=r"a\.json has more than 10 bytes"):
        read_words_file(tmp_path / "a.json")


def test_file_is_read_by_its_path(tmp_path: Path):
    (tmp_path / "a.srt").write_text("1\n00:00:00,000 --> 00:00:01,000\nHi\n")
    assert read_words_file(tmp_path / "a.srt").text == "Hi"


@pytest.mark.parametrize("name", ["missing.json", "."])
def test_missing_file_is_refused_with_its_path(name: str, tmp_path: Path):
    with pytest.raises(TimingError, match=r"missing\.json|is not a regular file|directory"):
        read_words_file(tmp_path / name)


def test_pipe_is_refused_without_waiting(tmp_path: Path):
    os.mkfifo(tmp_path / "endless.json")
    with pytest.raises(TimingError, match="is not a regular file"):
        read_words_file(tmp_path / "endless.json")
