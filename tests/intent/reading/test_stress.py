"""Tests of syllable counts and stressed syllables of English words."""

import pytest

from kinesic.intent.reading.stress import count_syllables, stressed_english_syllable


@pytest.mark.parametrize(
    ("word", "count"),
    [
        ("a", 1), ("hm", 1), ("cake", 1), ("table", 2), ("tables", 2), ("wanted", 2), ("walked", 1), ("agreed", 2),
        ("boxes", 2), ("makes", 1), ("radio", 3), ("computer", 3), ("don't", 1),
        ("7", 2), ("42", 3), ("1000", 6), ("かな", 2), ("きゃく", 2), ("日本", 4), ("コンピュータ", 5),
    ],
)  # fmt: skip
def test_english_syllables_are_counted_by_spelling(word: str, count: int) -> None:
    assert count_syllables(word) == count


@pytest.mark.parametrize(
    ("word", "syllable"),
    [
        ("cat", 0), ("table", 0), ("42", 0), ("about", 1), ("remember", 1), ("under", 0), ("computer", 1),
        ("banana", 1), ("nation", 0), ("ambition", 1), ("education", 2), ("imagination", 3),
        ("electricity", 2), ("physics", 0),
        ("electric", 1), ("musical", 0), ("musically", 0), ("japanese", 2), ("myself", 1),
        ("cassette", 1), ("afternoon", 2), ("tion", 0), ("beginning", 1), ("offices", 0),
        ("bananas", 1), ("carelessness", 0), ("Remember", 1), ("hopefully", 0),
    ],
)  # fmt: skip
def test_english_word_stress_follows_endings_before_prefixes(word: str, syllable: int) -> None:
    assert stressed_english_syllable(word) == syllable


@pytest.mark.parametrize("word", ["tion", "ity", "ics", "self", "ee", "sion", "ions", "ious"])
def test_word_that_equals_an_ending_of_the_stress_rules_still_has_a_stressed_syllable(word: str) -> None:
    assert 0 <= stressed_english_syllable(word) < count_syllables(word)
