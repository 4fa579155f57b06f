"""Spoken form of fractions, telephone numbers, dates, ranges and Roman numerals."""

import re
from collections.abc import Iterator, Sequence

from kinesic.intent.reading.fractions import FRACTION_PATTERN, KANA_KANJI, split_fraction
from kinesic.intent.reading.language import Language

_PHONE_PATTERN = (
    r"\+\d{1,3}(?:[ -]?\(\d{1,4}\))?[ -]?\d{2,8}(?:[ -]\d{2,8}){1,5}|\(?0\d{2,5}\)?[ /-]\d{3,8}(?:[ -]\d{2,8}){0,3}"
    r"|(?:1[ -])?(?:\(\d{3}\)[ ]?|\d{3}[ -])\d{3}-\d{4}|\d{3}\.\d{3}\.\d{4}"
)
_LOCAL_PHONE_PATTERN = r"[2-9]\d{2}-\d{4}"  # local telephone number of North America, or a range
_DATE_PATTERN = r"\d{4}-\d{2}-\d{2}|\d{1,2}-\d{1,2}-\d{4}|\d{1,2}\.\d{1,2}\.\d{4}|\d{1,2}/\d{1,2}/\d{2,4}"
_RANGE_PATTERN = r"[1-9]\d{0,3}[\u2013-][1-9]\d{0,3}"
_END_PATTERN = r"(?![\w/@-]|[.,:]\d)"
_SIGNED_PATTERN = rf"(?:{_DATE_PATTERN}|{_PHONE_PATTERN}|{_LOCAL_PHONE_PATTERN}|{_RANGE_PATTERN}){_END_PATTERN}"
# Numbers with hyphens, slashes or brackets.
NUMBER_PATTERN = rf"(?<![^\W{KANA_KANJI}])(?<![.,:/@+-])(?:{_SIGNED_PATTERN}|{FRACTION_PATTERN})".replace(" ", r"\ ")
_RANGE_RE = re.compile(_RANGE_PATTERN)
_LOCAL_PHONE = re.compile(_LOCAL_PHONE_PATTERN)
_FRACTION_RE = re.compile(FRACTION_PATTERN)
_FICTIONAL_EXCHANGE = "555-"  # beginning of telephone numbers in examples and films
MAX_HEAD_DISTANCE = 4  # [words] largest distance of a word such as `call` before a telephone number
_DATE_RE = re.compile(_DATE_PATTERN)
_NUMERAL_PATTERN = re.compile(r"(X{0,3})(IX|IV|V?I{0,3})")  # Roman numeral up to 39
_DIGIT_VALUES = {"X": 10, "V": 5, "I": 1}
_ORDINAL_ENDINGS = {1: "st", 2: "nd", 3: "rd"}  # last digit -> ending of an English ordinal; others: th


def split_number(
    text: str, language: Language, *, before: Sequence[str] = (), after: str = ""
) -> Iterator[tuple[str, str]]:
    """Yield (preceding signs, part) for each spoken part of a number.

    The digits of a telephone number are spoken one by one.

    Args:
        text: number with its signs.
        language: its names of numbers and signs.
        before: preceding words of the sentence, in lower case.
        after: beginning of the following text.
    """
    parts = re.findall(r"\d+", text)
    if _DATE_RE.fullmatch(text):
        yield from ((" " if k else "", part) for k, part in enumerate(parts))
    elif _FRACTION_RE.fullmatch(text):
        yield from split_fraction(text, language, before, after)
    elif (
        _LOCAL_PHONE.fullmatch(text) and not _is_phone(text, language, before, after) and not _RANGE_RE.fullmatch(text)
    ):
        yield "", parts[0]
        yield "-", parts[1]
    elif _RANGE_RE.fullmatch(text) and not _is_phone(text, language, before, after):
        to = "".join(language.classes.get("range_word", ()))
        yield "", parts[0]
        if to:
            yield " ", to
        yield " " if to else ", ", parts[1]
    else:
        for k, part in enumerate(parts):
            yield ", " if k else text[: text.startswith("+")], " ".join(part)


def _is_phone(text: str, language: Language, before: Sequence[str], after: str) -> bool:
    """Return whether two numbers with a hyphen are a local telephone number."""
    if not _LOCAL_PHONE.fullmatch(text) or "phone_heads" not in language.classes:
        return False
    heads = before[-MAX_HEAD_DISTANCE:]
    if text.startswith(_FICTIONAL_EXCHANGE) or any(language.has("phone_heads", head) for head in heads):
        return True
    if not _RANGE_RE.fullmatch(text):
        return True
    is_rounded = text[2] == "0" and text[-1] == "0"
    following = re.match(r" ([^\W\d_]+)", after)
    counts = following is not None and not language.has("function", following[1].lower())
    return not (is_rounded or counts or any(language.has("range_heads", head) for head in heads[-1:]))


def read_numeral(text: str, before: str, language: Language) -> str:
    """Return a Roman numeral's number as spoken, or empty text.

    Args:
        text: word in capitals.
        before: preceding word of its sentence; empty: it is the first one.
        language: its kings' names, and its words before numerals.
    """
    match = _NUMERAL_PATTERN.fullmatch(text)
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
