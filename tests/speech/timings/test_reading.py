import os
import random
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
        (b'{"time":0,"type":"word","val\xffe":"a"}', "byte 28 is not UTF-8"),
    ],
)
def test_wrong_or_hostile_timing_file_is_refused_in_one_line(content: bytes, message: str):
    with pytest.raises(TimingError, match=message) as error:
        read_timed_words(content, source="times.json")
    assert str(error.value).startswith("times.json: ")
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 300


def test_damaged_timing_files_are_read_or_refused_without_a_crash():
    samples = (
        b'{"segments": [{"words": [{"word": "a", "start": 0.1, "end": 0.5}, {"word": "b", "start": 0.5, "end": 1}]}]}',
        b'{"time":6,"type":"word","value":"a"}\n{"time":9,"type":"viseme","value":"p"}\n',
        b'[{"audioOffset": 500000, "duration": 2500000, "text": "Hello", "boundaryType": "Word"}]',
        b'File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n1\n<exists>\n1\n"IntervalTier"\n"words"\n'
        b'0\n1\n1\n0\n1\n"a"\n',
        b"WEBVTT\n\n00:01.000 --> 00:02.000\nHello <00:01.500>you\n",
    )
    chance = random.Random(7)
    pieces = (b"-1", b"NaN", b"1e999", b'"', b"{", b"[", b"<", b"null", b"9" * 30, b"\xff", b"\x00", b"-->", b"")
    for _ in range(400):
        content = bytearray(chance.choice(samples))
        for _ in range(chance.randint(1, 3)):
            begin = chance.randrange(len(content) + 1)
            content[begin : begin + chance.choice((0, 1, 5, 30))] = chance.choice(pieces)
        try:
            timed = read_timed_words(bytes(content))
        except TimingError:
            continue
        assert all(0.0 <= word.start <= word.end <= 1300.0 for word in timed.words)


def test_timing_file_above_the_size_limit_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(reading, "MAX_BYTES", 10)
    (tmp_path / "a.json").write_bytes(b"[]" * 10)
    with pytest.raises(TimingError, match=r"a\.json has more than 10 bytes"):
        read_words_file(tmp_path / "a.json")


def test_subtitle_file_is_read_by_its_path(tmp_path: Path):
    (tmp_path / "a.srt").write_text("1\n00:00:00,000 --> 00:00:01,000\nHi\n")
    assert read_words_file(tmp_path / "a.srt").text == "Hi"


@pytest.mark.parametrize("name", ["missing.json", "."])
def test_missing_timing_file_is_refused_with_its_path(name: str, tmp_path: Path):
    with pytest.raises(TimingError, match=r"missing\.json|is not a regular file|directory"):
        read_words_file(tmp_path / name)


def test_pipe_as_timing_file_is_refused_without_waiting(tmp_path: Path):
    os.mkfifo(tmp_path / "endless.json")
    with pytest.raises(TimingError, match="is not a regular file"):
        read_words_file(tmp_path / "endless.json")
