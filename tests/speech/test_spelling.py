import pytest

from kinesic.speech.spelling import (
    SPELLING_SOUNDS,
    VOWEL_SOUNDS,
    count_syllables,
    mora_sounds,
    number_sounds,
    word_sounds,
)


@pytest.mark.parametrize(
    ("word", "count"),
    [("a", 1), ("the", 1), ("make", 1), ("little", 2), ("banana", 3), ("laboratory", 5), ("rhythm", 1), ("hmm", 1)],
)
def test_english_syllables_are_counted(word: str, count: int):
    assert count_syllables(word_sounds(word)) == count


def test_final_e_is_silent_only_in_some_languages():
    assert count_syllables(word_sounds("sole", language="en-GB")) == 1
    assert count_syllables(word_sounds("sole", language="fr")) == 1
    assert count_syllables(word_sounds("sole", language="it")) == 2


def test_estimated_phonemes_of_a_word_ignore_accents_and_case():
    assert word_sounds("NAÏVE") == word_sounds("naive")
    assert word_sounds("caf\u00e9") == word_sounds("cafe\u0301", language="en")


def test_two_letter_spellings_give_one_phoneme():
    assert word_sounds("ship") == ("ʃ", "i", "p")
    assert word_sounds("think") == ("θ", "i", "n", "k")
    assert word_sounds("moon") == ("m", "u", "n")


def test_letter_m_gives_the_phoneme_m():
    assert "m" in word_sounds("mama")


def test_word_in_an_unknown_script_gives_neutral_vowels():
    assert word_sounds("Привет") == ("ə", "ə")


def test_phonemes_of_a_number_are_those_of_its_digits():
    assert number_sounds("42") == word_sounds("four") + word_sounds("two")
    assert number_sounds("4.2") == number_sounds("42")


def test_kana_and_hangul_give_their_sounds_and_kanji_a_neutral_vowel():
    assert mora_sounds("か") == ("k", "a")
    assert mora_sounds("カ") == ("k", "a")
    assert mora_sounds("한") == ("h", "a", "n")
    assert mora_sounds("漢") == ("ə",)


def test_patterns_of_the_spelling_rules_are_lower_case():
    assert all(spelling == spelling.casefold() and sounds for spelling, sounds in SPELLING_SOUNDS.items())
    assert {"a", "e", "i", "o", "u"} < VOWEL_SOUNDS
