"""Telephone numbers, dates, ranges and Roman numerals as they are spoken."""

import pytest

from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text


def written(text: str, language: str = "en") -> str:
    return "".join(word.before + word.text for word in read_text(text, load_language(language)).words)


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("Call 030 1234567 now", "Call 0 3 0, 1 2 3 4 5 6 7 now"),
        ("Call +44 (0)20 7946 0958 now", "Call +4 4, 0, 2 0, 7 9 4 6, 0 9 5 8 now"),
        ("Call (030) 123-4567 or 555-867-5309", "Call 0 3 0, 1 2 3, 4 5 6 7 or 5 5 5, 8 6 7, 5 3 0 9"),
        ("On 2024-11-30 or 30/11/2024", "On 2024 11 30 or 30 11 2024"),
        ("pages 7-9 and 2019\u20132021", "pages 7 to 9 and 2019 to 2021"),
        ("a 5-10% rise", "a 5 to 10% rise"),
        ("F-16, 3-4-5, 10-5.5, 12/3 and 3.11.24", "F-16, 3-4-5, 10-5.5, 12/3 and 3.11.24"),
        ("Part 978-3-16-148410-0 is 1 2 3", "Part 978-3-16-148410-0 is 1 2 3"),
    ],
)
def test_numbers_with_signs_are_spoken_without_the_signs(text: str, spoken: str):
    assert written(text) == spoken


@pytest.mark.parametrize(("language", "spoken"), [("de", "7 bis 9"), ("fr", "7 \xe0 9"), ("fi", "7, 9")])
def test_range_of_numbers_is_spoken_in_the_language_of_the_text(language: str, spoken: str):
    assert written("7-9", language) == spoken


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("Henry VIII and Louis XIV", "Henry the 8th and Louis the 14th"),
        ("Edward III and George II", "Edward the 3rd and George the 2nd"),
        ("In chapter IV of World War II, Act V", "In chapter 4 of World War 2, Act 5"),
        ("I saw Elizabeth I think", "I saw Elizabeth I think"),
        ("Ask Anna, I know the IV drip", "Ask Anna, I know the I.V drip"),
    ],
)
def test_roman_numerals_after_names_are_spoken_as_numbers(text: str, spoken: str):
    assert written(text) == spoken
