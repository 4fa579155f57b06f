"""Tests of word patterns of cues."""

import pytest

from kinesic.intent.meaning.patterns import Pattern, Span, read_pattern, spell_out


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
        ("i can't/don't see", "i cannot see", 2),
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


@pytest.mark.parametrize(
    ("pattern", "text", "stroke"),
    [
        ("^don't touch", "do not touch", -1),
        ("*can't/won't (really) say", "will not say", 1),
        ("(don't) move it", "move it", -1),
        ("can't see *it", "can not see it", 3),
        ("it's/that's *fair", "that is fair", 2),
        ("they'll *come", "they will come", 2),
        ("*i'm late", "i am late", 0),
    ],
)
def test_pattern_with_a_contraction_also_matches_its_full_form(pattern: str, text: str, stroke: int):
    full = spell_out(read_pattern(pattern))
    assert isinstance(full, Pattern)
    words = text.split()
    assert full.match(words, 0, len(words), str.isdigit) == Span(0, len(words) - 1, stroke)
    assert spell_out(read_pattern("not bad")) is None
    assert spell_out(read_pattern("my mother's (it's) *turn")) is None


def test_inflected_word_of_a_pattern_also_matches_irregular_forms_of_the_verb():
    forms = {"break": frozenset({"broke", "broken"})}
    for word in ("breaks", "breaking", "broke", "broken"):
        assert read_pattern("break~ up", forms).match([word, "up"], 0, 2, str.isdigit) is not None
    assert read_pattern("break up", forms).match(["broke", "up"], 0, 2, str.isdigit) is None
