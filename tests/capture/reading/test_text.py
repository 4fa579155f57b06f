"""Bounds of the text of motion files."""

import os

import numpy as np
import pytest

from kinesic.capture.reading import text
from kinesic.capture.reading.text import (
    CaptureError,
    check_regular,
    check_times,
    decode,
    parse_count,
    parse_numbers,
    read_file,
    split_lines,
)


def test_motion_text_file_with_too_many_or_too_long_lines_is_refused(monkeypatch):
    monkeypatch.setattr(text, "MAX_LINES", 2)
    monkeypatch.setattr(text, "MAX_LINE_LENGTH", 4)
    assert split_lines(b"\xef\xbb\xbfab\r\n\nabcd", "f") == ["ab", "", "abcd"]
    with pytest.raises(CaptureError, match="f: a line has more than 4 characters"):
        split_lines(b"ab\nabcde", "f")
    with pytest.raises(CaptureError, match="f: more than 2 lines"):
        split_lines(b"\n\n\n", "f")


def test_motion_files_up_to_64_megabytes_are_read(tmp_path, monkeypatch):
    assert text.MAX_FILE_SIZE == 64_000_000
    monkeypatch.setattr(text, "MAX_FILE_SIZE", 4)
    (tmp_path / "a").write_bytes(b"abcd")
    (tmp_path / "b").write_bytes(b"abcde")
    assert read_file(tmp_path / "a") == b"abcd"
    for read in (lambda: read_file(tmp_path / "b"), lambda: decode(b"abcde", "b"), lambda: split_lines(b"abcde", "b")):
        with pytest.raises(CaptureError, match=r"b: more than 0 MB"):
            read()


def test_size_of_a_too_large_motion_file_is_given_in_megabytes(tmp_path, monkeypatch):
    monkeypatch.setattr(text, "MAX_FILE_SIZE", 2_000_000)
    (tmp_path / "a").touch()
    os.truncate(tmp_path / "a", 2_000_001)
    with pytest.raises(CaptureError, match=r"a: more than 2 MB"):
        read_file(tmp_path / "a")


def test_folder_or_missing_file_in_place_of_a_motion_file_is_refused(tmp_path):
    for check in (check_regular, read_file):
        with pytest.raises(CaptureError, match=r"none: No such file"):
            check(tmp_path / "none")
        with pytest.raises(CaptureError, match=str(tmp_path)):
            check(tmp_path)
    (tmp_path / "a").touch()
    check_regular(tmp_path / "a")


@pytest.mark.parametrize(("data", "expected"), [(b"\xef\xbb\xbfa\r\nb\rc\n", "a\nb\rc\n"), (b"a\xff", "a\ufffd")])
def test_motion_file_is_decoded_without_byte_order_mark_and_carriage_returns(data, expected):
    assert decode(data, "f") == expected


def test_motion_files_have_at_most_200_000_frames_2_million_lines_and_1000_joints():
    assert (text.MAX_FRAMES, text.MAX_LINES, text.MAX_LINE_LENGTH, text.MAX_JOINTS) == (200_000, 2 * 10**6, 10**6, 1000)


@pytest.mark.parametrize("word", ["0", "7", " 3 "])
def test_number_of_frames_or_joints_in_a_motion_file_is_parsed_up_to_its_maximum(word):
    assert parse_count(word, "f:2", most=7) == int(word)


@pytest.mark.parametrize(
    ("word", "problem"),
    [
        ("-1", "-1 must be from 0 to 7"),
        ("8", "8 must be from 0 to 7"),
        ("2.5", "'2.5' must be a whole number"),
        ("many" * 9, "'manymanymanymanymany' must be a whole number"),
    ],
)
def test_count_in_a_motion_file_outside_its_range_is_refused_with_its_line(word, problem):
    with pytest.raises(CaptureError, match=f"f:2: {problem}"):
        parse_count(word, "f:2", most=7)


@pytest.mark.parametrize(
    ("times", "problem"),
    [
        ([], "it has 0 frames; it needs from 2 to 4"),
        ([0.0], "it has 1 frames"),
        ([0, 1, 2, 3, 4], "it has 5 frames"),
        ([0.0, 1.0, 1.0], r"not in order of time \(frame 3\)"),
        ([0.0, -1.0, -2.0], r"not in order of time \(frame 2\)"),
        ([0.0, 1.0], None),
        ([0, 1, 2, 3], None),
    ],
)
def test_frame_times_of_a_motion_file_are_at_least_two_and_increase(monkeypatch, times, problem):
    monkeypatch.setattr(text, "MAX_FRAMES", 4)
    if problem is None:
        check_times(np.array(times, float), "f")
        return
    with pytest.raises(CaptureError, match=f"f: .*{problem}"):
        check_times(np.array(times, float), "f")


@pytest.mark.parametrize("words", [["1e308", "1e308"], ["-1e308", "-1e308"], ["1" * 400], ["1e13", "-1e13"]])
def test_numbers_in_a_motion_file_whose_sum_overflows_or_cancels_are_refused(words):
    with pytest.raises(CaptureError, match="f:1: a number"):
        parse_numbers(words, "f:1")
