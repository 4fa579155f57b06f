import pytest

from kinesic.speech.spelling import SOUNDS, VOWELS, mora_sounds, number_sounds, syllables, word_sounds


@pytest.mark.parametrize(
    ("word", "count"),
    [("a", 1), ("the", 1), ("make", 1), ("little", 2), ("banana", 3), ("laboratory", 5), ("rhythm", 1), ("hmm", 1)],
)
def test_english_syllables(word: str, count: int):
    assert syllables(word_sounds(word)) == count


def test_a_final_e_is_silent_only_where_the_language_has_it_so():
    assert syllables(word_sounds("sole", language="en-GB")) == 1
    assert syllables(word_sounds("sole", language="fr")) == 1
    assert syllables(word_sounds("sole", language="it")) == 2


def test_accents_and_case_do_not_matter():
    assert word_sounds("NAÏVE") == word_sounds("naive")
    assert word_sounds("caf\u00e9") == word_sounds("cafe\u0301", language="en")


def test_spellings_of_two_letters_are_one_sound():
    assert word_sounds("ship") == ("ʃ", "i", "p")
    assert word_sounds("think") == ("θ", "i", "n", "k")
    assert word_sounds("moon") == ("m", "u", "n")


def test_lips_close_for_a_word_with_m():
    assert "m" in word_sounds("mama")


def test_an_unknown_script_is_neutral_vowels():
    assert word_sounds("Привет") == ("ə", "ə")


def test_a_number_is_read_digit_by_digit():
    assert number_sounds("42") == word_sounds("four") + word_sounds("two")
    assert number_sounds("4.2") == number_sounds("42")


def test_characters_that_spell_their_sound_are_said():
    assert mora_sounds("か") == ("k", "a")
    assert mora_sounds("カ") == ("k", "a")
    assert mora_sounds("한") == ("h", "a", "n")
    assert mora_sounds("漢") == ("ə",)


def test_every_spelling_is_a_small_letter_or_several():
    assert all(spelling == spelling.casefold() and sounds for spelling, sounds in SOUNDS.items())
    assert {"a", "e", "i", "o", "u"} < VOWELS
