"""Tests of overlong words, of which the first 80 characters are spoken."""

import pytest

from kinesic.intent.manuscript.long_words import MAX_WORD_LENGTH
from kinesic.intent.manuscript.pieces import Manuscript
from kinesic.intent.manuscript.reading import read_manuscript, read_more

KEY = "aB3+/" * 1000


def read_in_pieces(text: str, length: int) -> tuple[str, tuple[str, ...]]:
    """Read a text that arrives in pieces of some characters."""
    state, spoken, warnings = Manuscript(), "", list[str]()
    for begin in range(0, len(text), length):
        state, more, news = read_more(state, text[begin : begin + length], ends=begin + length >= len(text))
        spoken, warnings = spoken + more, [*warnings, *news]
    return spoken, tuple(warnings)


@pytest.mark.parametrize("length", [1, 7, 79, 80, 81, 3000])
def test_overlong_word_is_truncated_with_one_warning_for_different_chunk_lengths(length: int):
    spoken, warnings = read_in_pieces(f"The key is {KEY}. Keep it.", length)
    assert spoken == f"The key is {KEY[:MAX_WORD_LENGTH]}\u2026. Keep it."
    assert warnings == (f"a word is cut after 80 characters: {KEY[:20]}\u2026",)


@pytest.mark.parametrize(
    "text",
    ["a" * MAX_WORD_LENGTH, f"{'a' * 70} well\u2026what {'b' * 60}", "\u5b57" * 200, "\u043c" * 100, "word " * 60],
)
def test_words_up_to_80_characters_and_words_of_other_scripts_are_spoken_whole(text: str):
    assert read_manuscript(text) == (text, ())
