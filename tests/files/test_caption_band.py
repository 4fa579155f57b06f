"""Words of a film stand in a band at its lower edge, at their time."""

import numpy as np
import pytest

from kinesic.files.caption_band import caption_box, words_at, write_caption

SIZE = (640, 360)
SPOKEN = ((0.5, 1.0, "Hello,"), (1.0, 2.0, "and welcome"))
LONG = "a sentence that says more than fits into two lines of a film, " * 6


@pytest.mark.parametrize(
    ("time", "words"), [(0.49, ""), (0.5, "Hello,"), (0.99, "Hello,"), (1.0, "and welcome"), (2.0, "")]
)
def test_words_are_there_while_they_are_said(time: float, words: str):
    assert words_at(SPOKEN, time) == words


@pytest.mark.parametrize("words", ["Hello,", LONG])
def test_words_are_written_into_their_box_alone(words: str):
    picture = np.full((360, 640, 3), 128, dtype=np.uint8)
    write_caption(picture, words)
    box = caption_box(words, SIZE)
    assert box is not None
    left, top, right, low = box
    assert 0 <= left < right <= 640
    assert 360 * 0.7 < top < low <= 360
    assert left % 2 == top % 2 == 0
    changed = picture != 128
    assert changed[top:low, left:right].mean() > 0.9
    changed[top:low, left:right] = False
    assert not changed.any()
    assert picture.max() > 240, "light letters"


def test_more_words_than_two_lines_end_in_dots():
    one, two, more = (caption_box(words, SIZE) for words in ("word", LONG[:90], LONG))
    assert one is not None
    assert two is not None
    assert more is not None
    assert one[3] - one[1] < two[3] - two[1] <= more[3] - more[1] < 360 * 0.2


def test_without_words_nothing_is_written():
    picture = np.full((360, 640, 3), 128, dtype=np.uint8)
    write_caption(picture, "")
    assert (picture == 128).all()
    assert caption_box("", SIZE) is None
