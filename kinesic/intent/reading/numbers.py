"""Spoken form of telephone numbers, dates, ranges and Roman numerals."""

import re
from collections.abc import Iterator

from kinesic.intent.reading.language import Language

_PHONE_PATTERN = (
    r"\+\d{1,3}(?:[ -]?\(\d{1,4}\))?[ -]?\d{2,8}(?:[ -]\d{2,8}){1,5}|\(?0\d{2,5}\)?[ /-]\d{3,8}(?:[ -]\d{2,8}){0,3}"
    r"|(?:\(\d{3}\)[ ]?|\d{3}[ -])\d{3}-\d{4}"
)
_DATE_PATTERN = r"\d{4}-\d{2}-\d{2}|\d{1,2}/\d{1,2}/\d{2,4}"
_RANGE_PATTERN = r"[1-9]\d{0,3}[\u2013-][1-9]\d{0,3}"
# Numbers with hyphens, slashes or brackets.
NUMBER_PATTERN = rf"(?<![\w.,:/@+-])(?:{_DATE_PATTERN}|{_PHONE_PATTERN}|{_RANGE_PATTERN})(?![\w/@-]|[.,:]\d)".replace(
    " ", r"\ "
)
_RANGE = re.compile(_RANGE_PATTERN)
_DATE = re.compile(_DATE_PATTERN)
_NUMERAL = re.compile(r"(X{0,3})(IX|IV|V?I{0,3})")  # Roman numeral up to 39
_DIGIT_VALUES = {"X": 10, "V": 5, "I": 1}
_ORDINAL_ENDINGS = {1: "st", 2: "nd", 3: "rd"}  # last digit -> ending of an English ordinal; others: th


def split_number(text: str, language: Language) -> Iterator[tuple[str, str]]:
    """Yield the signs before each spoken part of a number, and the part.

    The digits of a telephone number are spoken one by one.
    """
    parts = re.findall(r"\d+", text)
    if _DATE.fullmatch(text):
        yield from ((" " if k else "", part) for k, part in enumerate(parts))
    elif _RANGE.fullmatch(text):
        to = "".join(language.classes.get("range_word", ()))
        yield "", parts[0]
        if to:
            yield " ", to
        yield " " if to else ", ", parts[1]
    else:
        for k, part in enumerate(parts):
            yield ", " if k else text[: text.startswith("+")], " ".join(part)


def read_numeral(text: str, before: str, language: Language) -> str:
    """Return a Roman numeral's number as spoken, or empty text.

    Args:
        text: word in capitals.
        before: preceding word of its sentence; empty: it is the first one.
        language: its kings' names, and its words before numerals.
    """
    match = _NUMERAL.fullmatch(text)
    is_king = language.has("regnal", before.lower())
    is_part = language.has("numeral_heads", before.lower())
    if match is None or not (is_king or is_part or (len(text) > 1 and before[:1].isupper())):
        return ""
    if "regnal" not in language.classes or text == "I":
        return ""
    ones = {"IX": 9, "IV": 4}.get(match[2], sum(_DIGIT_VALUES[letter] for letter in match[2]))
    number = 10 * len(match[1]) + ones
    if not is_king:
        return str(number)
    ending = "th" if 10 < number < 20 else _ORDINAL_ENDINGS.get(number % 10, "th")
    return f"the {number}{ending}"
