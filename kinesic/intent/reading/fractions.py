"""Spoken form of fractions, ratings and other numbers with a slash."""

import re
import unicodedata
from collections.abc import Iterator, Sequence

from kinesic.intent.reading.language import Fractions, Language

_FRACTION_SIGNS = "\xbc-\xbe\u2150-\u215e"  # fractions of one character
KANA_KANJI = "\u3040-\u30ff\u4e00-\u9fff"  # characters beside a Japanese number without a space
# Fraction, also after a whole number.
FRACTION_PATTERN = (
    rf"(?:(?:\d{{1,3}}[ -])?\d{{1,3}}[/\u2044]\d{{1,3}}|(?:\d{{1,3}}[ ]?)?[{_FRACTION_SIGNS}])"
    rf"(?![^\W{KANA_KANJI}]|[/@]|-\d|[.,:]\d)"
)
_SIGN_PATTERN = re.compile(f"[{_FRACTION_SIGNS}]")
_PARTS_PATTERN = re.compile(r"(?:(\d+)[ -]+)?(\d+)[/\u2044](\d+)")


def split_fraction(text: str, language: Language, before: Sequence[str], after: str) -> Iterator[tuple[str, str]]:
    """Yield each spoken word of a fraction, with the text before it.

    Args:
        text: fraction, also after a whole number.
        language: its names of fractions; without them the fraction stays as written.
        before: preceding words of the sentence.
        after: beginning of the following text.
    """
    match = _PARTS_PATTERN.fullmatch(
        _SIGN_PATTERN.sub(lambda sign: f" {unicodedata.normalize('NFKC', sign[0])}", text).strip()
    )
    words = _name(match, language, before, after) if match and language.fractions else ""
    if words:
        for k, word in enumerate(words.split()):
            yield " " if k else "", word
        return
    end = 0
    for part in re.finditer(rf"\d+|[{_FRACTION_SIGNS}]", text):
        yield text[end : part.start()], part[0]
        end = part.end()


def _name(match: re.Match[str], language: Language, before: Sequence[str], after: str) -> str:
    """Return a fraction as spoken, or empty text."""
    names = language.fractions
    assert names is not None  # the caller checks it
    whole, top, bottom = match.groups()
    following = re.match(r"[ -]?([^\W\d_]*)", after)
    word = following[1].lower() if following else ""
    head = before[-1] if before else ""
    if not whole and (spoken := _name_pair(top, bottom, names, head, word)):
        return spoken
    is_date = head in names.date_heads and (not word or language.has("function", word)) and word not in names.part_words
    if not whole and is_date:
        return f"{top} {bottom}"
    forms = names.denominators.get(bottom, [])
    if not forms or not 0 < int(top) < int(bottom):
        return ""
    numerator, denominator = names.numerators[int(top) - 1], forms[top != "1"]
    if names.begins_with_denominator:
        return f"{whole or ''}{names.joint if whole else ''}{denominator}{numerator}"
    fraction = f"{numerator} {denominator}"
    return f"{whole} {names.joint} {fraction}" if whole else fraction


def _name_pair(top: str, bottom: str, names: Fractions, head: str, word: str) -> str:
    """Return words of a pair, count or rating `a/b`, otherwise empty text."""
    if f"{top}/{bottom}" in names.pairs or word in names.pair_ends:
        return f"{top} {bottom}"
    if int(top) > int(bottom):
        return ""
    if head in names.count_heads:
        return f"{top} {names.count_word} {bottom}"
    is_rating = bottom in names.rating_scales or word in names.rating_ends
    return f"{top} {names.rating_words} {bottom}" if is_rating else ""
