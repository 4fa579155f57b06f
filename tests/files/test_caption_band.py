"""Tests of captions in the dark band of a film."""

import numpy as np
import pytest

from kinesic.files.caption_band import (
    BAND_PADDING,
    LETTER_HEIGHT,
    MAX_LINE_WIDTH,
    caption_box,
    words_at,
    write_caption,
)

PICTURE_SIZE = (640, 360)
SPOKEN_WORDS = ((0.5, 1.0, "Hello,"), (1.0, 2.0, "and welcome"))
LONG_TEXT = "a sentence that says more than fits into two lines of a film, " * 6


@pytest.mark.parametrize(
    ("time", "words"), [(0.49, ""), (0.5, "Hello,"), (0.99, "Hello,"), (1.0, "and welcome"), (2.0, "")]
)
def test_film_caption_shows_words_while_they_are_spoken(time: float, words: str):
    assert words_at(SPOKEN_WORDS, time) == words


@pytest.mark.parametrize("words", ["Hello,", LONG_TEXT])
def test_film_caption_changes_only_pixels_in_its_box(words: str):
    picture = np.full((360, 640, 3), 128, dtype=np.uint8)
    write_caption(picture, words)
    box = caption_box(words, PICTURE_SIZE)
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


def test_film_caption_has_up_to_two_lines_and_less_than_a_fifth_of_the_picture_height():
    one, two, more = (caption_box(words, PICTURE_SIZE) for words in ("word", LONG_TEXT[:90], LONG_TEXT))
    assert one is not None
    assert two is not None
    assert more is not None
    assert one[3] - one[1] < two[3] - two[1] <= more[3] - more[1] < 360 * 0.2


@pytest.mark.parametrize("size", [PICTURE_SIZE, (1920, 1080)])
def test_caption_wraps_a_long_text_but_keeps_a_short_phrase_on_one_line(size: tuple[int, int]):
    width, height = size
    padding = 2 * round(BAND_PADDING * LETTER_HEIGHT * height) + 2
    word, words, long = (caption_box(text, size) for text in ("says", "fits in one line", LONG_TEXT))
    assert word is not None
    assert words is not None
    assert long is not None
    assert words[2] - words[0] > 2 * (word[2] - word[0] - padding)
    assert abs((words[3] - words[1]) - (word[3] - word[1])) <= 0.01 * height, "a single line, too"
    assert 0.6 * width < long[2] - long[0] <= 1.1 * MAX_LINE_WIDTH * width + padding, "with an ellipsis"


def test_empty_film_caption_draws_nothing():
    picture = np.full((360, 640, 3), 128, dtype=np.uint8)
    write_caption(picture, "")
    assert (picture == 128).all()
    assert caption_box("", PICTURE_SIZE) is None
