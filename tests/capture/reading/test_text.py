"""Bounds of the text of motion files."""

import pytest

from kinesic.capture.reading import text
from kinesic.capture.reading.text import CaptureError, split_lines


def test_motion_text_file_with_too_many_or_too_long_lines_is_refused(monkeypatch):
    monkeypatch.setattr(text, "MAX_LINES", 2)
    monkeypatch.setattr(text, "MAX_LINE_LENGTH", 4)
    assert split_lines(b"\xef\xbb\xbfab\r\n\nabcd", "f") == ["ab", "", "abcd"]
    with pytest.raises(CaptureError, match="f: a line has more than 4 characters"):
        split_lines(b"ab\nabcde", "f")
    with pytest.raises(CaptureError, match="f: more than 2 lines"):
        split_lines(b"\n\n\n", "f")
