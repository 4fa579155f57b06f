"""Tests of acronyms, spelled or spoken, and of stressed words in capitals."""

import pytest

from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text


@pytest.mark.parametrize(
    ("text", "words", "stressed"),
    [
        ("I live in the US and work for the WHO.", "I live in the US and work for the W.H.O", ""),
        ("He told US, WHO did it", "He told us who did it", "us who"),
        ("We met in LA with NASA and the ESC", "We met in LA with NASA and the E.S.C", ""),
        ("I want it NOW and I MUST have PIZZA", "I want it now and I must have pizza", "now must pizza"),
        ("The HTML page and less CO2", "The H.T.M.L page and less C O 2", ""),
        ("My TV is OK", "My TV is OK", ""),
        ("It is 5 PM and I AM tired", "It is 5 P.M and I am tired", "am"),
    ],
)
def test_word_in_capitals_is_an_acronym_or_stressed(text: str, words: str, stressed: str):
    result = read_text(text, load_language()).words
    assert " ".join(word.text for word in result) == words
    assert " ".join(word.text for word in result if word.emphatic) == stressed


def test_german_acronyms_and_abbreviations_are_not_emphasised_and_end_no_sentence():
    passage = read_text("Die EU hat z.B. Dr. Brandt, d.h. Nr. 5.", load_language("de"))
    assert len(passage.kinds) == 1
    assert not [word.text for word in passage.words if word.emphatic]


def test_acronym_us_differs_from_the_pronoun_us():
    assert [word.plain for word in read_text("the US", load_language()).words] == ["the", "u.s"]


@pytest.mark.parametrize(
    ("text", "sentences"),
    [
        ("See Dr. Smith, i.e. the boss, e.g. today.", 1),
        ("It is No. 5 of 3.5 kg at 10:30 a.m. today.", 1),
        ("No. I will not.", 2),
        ("She left the U.S. Then she came back.", 2),
        ("She left the U.S. in May.", 1),
    ],
)
def test_full_stop_of_an_abbreviation_within_a_sentence_does_not_end_it(text: str, sentences: int):
    assert len(read_text(text, load_language()).kinds) == sentences


@pytest.mark.parametrize(("language", "text"), [("fr", "Prenez p. ex. du lait."), ("es", "Tome p. ej. leche.")])
def test_full_stops_of_a_divided_abbreviation_end_no_sentence(language: str, text: str) -> None:
    assert len(read_text(text, load_language(language)).kinds) == 1


def test_number_abbreviation_no_is_not_a_negation():
    words = read_text("No. 5 is here.", load_language()).words
    assert [word.text for word in words] == ["number", "5", "is", "here"]
    assert words[0].plain != "no"
