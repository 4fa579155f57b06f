"""Fractions, telephone numbers, dates, ranges and Roman numerals as they are spoken."""

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
        ("Call 555-1234, or 867-5309 now", "Call 5 5 5, 1 2 3 4, or 8 6 7, 5 3 0 9 now"),
        ("Call 1-800-555-1234 or 555.867.5309", "Call 1, 8 0 0, 5 5 5, 1 2 3 4 or 5 5 5, 8 6 7, 5 3 0 9"),
        ("My number is 300-1200 or 123-0456", "My number is 3 0 0, 1 2 0 0 or 123-0456"),
        ("10-20 people, 300-1200 or 250-1234 of us", "10 to 20 people, 300 to 1200 or 2 5 0, 1 2 3 4 of us"),
        ("See pages 345-1234 and 250-1234 trees", "See pages 345 to 1234 and 250 to 1234 trees"),
        ("Part 978-3-16-148410-0 is 1 2 3", "Part 978-3-16-148410-0 is 1 2 3"),
    ],
)
def test_phone_numbers_dates_and_ranges_are_spoken_without_their_signs(text: str, spoken: str):
    assert written(text) == spoken


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("Add 1/2 cup, 3/4 or 2 1/2.", "Add one half cup, three quarters or 2 and one half"),
        ("1/3, 2/3 and 15/16", "one third, two thirds and fifteen sixteenths"),
        ("A 1/2-inch nail, 5 3/8-inch", "A one half-inch nail, 5 and three eighths-inch"),
        ("\xbd cup, 2\xbd or 2 \xbe", "one half cup, 2 and one half or 2 and three quarters"),
        ("Open 24/7 since 9/11, a 50/50 chance", "Open 24 7 since 9 11, a 50 50 chance"),
        ("On 3/4/2026, on 3/4 we met on 3/4 of it", "On 3 4 2026, on 3 4 we met on three quarters of it"),
        ("Rated 8/10 and 4/5 stars, in 3/4 time", "Rated 8 out of 10 and 4 out of 5 stars, in 3 4 time"),
        ("Step 1/3: go 80 km/h, 9 m/s", "Step 1 of 3: go 80 kilometres per hour, 9 metres per second"),
        ("1/2/3, 16/9, 0/4, 1/2x, a/b, and/or", "1/2/3, 16/9, 0/4, 1/2x, a/b, and/or"),
    ],
)
def test_fractions_ratings_and_units_are_spoken_by_their_names(text: str, spoken: str):
    assert written(text) == spoken


@pytest.mark.parametrize(
    ("language", "text", "spoken"),
    [
        ("de", "3/4 Liter, 2 1/2 km, 80 km/h", "drei Viertel Liter, 2 und ein halb km, 80 Kilometer pro Stunde"),
        ("de", "Teil 1/3 am 03.12.2026, am 3/4", "Teil 1 von 3 am 03 12 2026, am 3 4"),
        ("fr", "3/4 de litre \xe0 80 km/h", "trois quarts de litre \xe0 80 kilom\xe8tres \xe0 l'heure"),
        ("es", "2/3 de litro el 3/4", "dos tercios de litro el 3 4"),
        ("it", "1/8 di litro, 4/5 stelle", "un ottavo di litro, 4 su 5 stelle"),
        ("pt", "5/6 de litro, passo 1/3", "cinco sextos de litro, passo 1 de 3"),
        ("nl", "3/4 liter op 3-12-2026", "drie kwart liter op 3 12 2026"),
        (
            "ja",
            "1/2, 2/3",
            "\u306b\u3076\u3093\u306e\u3044\u3061, \u3055\u3093\u3076\u3093\u306e\u306b",
        ),
        (
            "ja",
            "\u307f\u305a\u30922/3\u3067\u3059",
            "\u307f\u305a\u3092\u3055\u3093\u3076\u3093\u306e\u306b\u3067\u3059",
        ),
        ("ja", "2 1/2, 5/13", "2\u3068\u306b\u3076\u3093\u306e\u3044\u3061, 5/13"),
    ],
)
def test_fractions_units_and_dates_are_spoken_in_the_language_of_the_text(language: str, text: str, spoken: str):
    assert written(text, language) == spoken


@pytest.mark.parametrize("language", ["fi"])
@pytest.mark.parametrize("text", ["1/2 x, 2 1/2 y", "2\xbd, \xbd z, 555-0123", "80 km/h"])
def test_fractions_stay_as_written_in_languages_without_fraction_names(text: str, language: str):
    assert written(text, language) == text


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
