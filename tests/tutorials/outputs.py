"""Comparison of an output with the one that a page shows, word by word."""

import re

ANY_TEXT = "..."
DECIMAL = re.compile(r"(?<![\w.])-?\d+\.\d+(?![\w.]*\d)")
TOLERANCE = 0.02  # largest difference of two decimals / shown number


def matches(shown: str, printed: str, *, is_measured: bool = False) -> bool:
    """Return whether a printed output matches the output shown on a page.

    White space is ignored. `...` stands for any text. Numbers with a decimal point may differ by 2 % or by one unit of
    the last shown place, all others not at all.

    Args:
        shown: text of the page.
        printed: output of the commands.
        is_measured: whether numbers with a decimal point depend on the machine, and may be any number.
    """
    words = printed.split()
    places = {0}  # numbers of printed words that the shown words so far can stand for
    for word in shown.split():
        if word == ANY_TEXT:
            places = set(range(min(places), len(words) + 1))
        elif ANY_TEXT in word:
            ends = {(place, end) for place in places for end in range(place + 1, len(words) + 1)}
            places = {end for place, end in ends if _is_same(word, " ".join(words[place:end]), is_measured)}
        else:
            places = {place + 1 for place in places if place < len(words) and _is_same(word, words[place], is_measured)}
        if not places:
            return False
    return len(words) in places


def _is_same(shown: str, printed: str, is_measured: bool) -> bool:
    """Return whether a word, and each decimal in it, is as shown."""
    decimals = DECIMAL.findall(shown)
    parts = [re.escape(part).replace(re.escape(ANY_TEXT), ".*") for part in DECIMAL.split(shown)]
    found = re.fullmatch(r"(-?\d+\.\d+)".join(parts), printed)
    return found is not None and (is_measured or all(map(_is_close, decimals, found.groups())))


def _is_close(shown: str, printed: str) -> bool:
    """Return whether a decimal differs by at most 2 %, or by one unit of the last shown place."""
    unit = 10.0 ** -len(shown.partition(".")[2])
    return abs(float(printed) - float(shown)) <= max(TOLERANCE * abs(float(shown)), 1.001 * unit)
