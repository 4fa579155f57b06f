"""Tests of word patterns of cues."""

import pytest

from kinesic.intent.meaning.patterns import Span, read_pattern


def matched(pattern: str, text: str) -> Span | None:
    words = text.split()
    return read_pattern(pattern).match(words, 0, len(words), str.isdigit)


@pytest.mark.parametrize(
    ("pattern", "text", "last"),
    [
        ("no problem/worries", "no worries at all", 1),
        ("no problem (at all)", "no problem at all", 3),
        ("break~ down", "broke down", None),
        ("stir~", "stirring it", 0),
        ("for # days", "for 3 days", 2),
        ("give _ up", "give it up", 2),
        ("(so) hot (today)", "hot soup", None),
        ("(so) hot (today)", "so hot", 1),
        ("^(so) hot", "hot", 0),
    ],
)
def test_pattern_matches_alternatives_options_inflections_and_numbers(pattern: str, text: str, last: int | None):
    span = matched(pattern, text)
    assert (span.last if span else None) == last


def test_stroke_falls_on_the_marked_word_of_a_pattern():
    assert matched("not *bad (at all)", "not bad at all") == Span(0, 3, 1)
    assert matched("not bad", "not bad") == Span(0, 1, -1)


def test_cue_pattern_without_a_required_word_is_refused():
    with pytest.raises(ValueError, match="no required word"):
        read_pattern("(so) _")
