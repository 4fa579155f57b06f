"""Truncation of overlong words, such as keys and encoded data."""

import re

from kinesic.intent.manuscript.pieces import Manuscript, Step

MAX_WORD_LENGTH = 80  # [characters] longest spoken beginning of a word such as a key or encoded data
_LONG_WORD = re.compile(r"[A-Za-z0-9+/=-]+")
_WORD_BEGINNING = re.compile(r"[A-Za-z0-9][A-Za-z0-9+/=-]*\Z")  # beginning of a word that may continue
# Word at the end of the text that has already been cut off, with an ellipsis.
_CUT_WORD = re.compile(rf"[A-Za-z0-9][A-Za-z0-9+/=-]{{{MAX_WORD_LENGTH - 1}}}\u2026\Z")


def cut_long_word(state: Manuscript) -> Step | None:
    """Cut off a word after `MAX_WORD_LENGTH` characters.

    The rest is not spoken.

    Returns:
        None for a shorter word.
    """
    match = _LONG_WORD.match(state.rest)
    if match is None or match.end() + len(state.spoken) <= MAX_WORD_LENGTH:
        return None
    if _CUT_WORD.search(state.spoken):
        return Step(match.end())
    begun = _WORD_BEGINNING.search(state.spoken)
    before = begun[0] if begun else ""
    left = MAX_WORD_LENGTH - len(before)
    if match.end() <= left or not (before or match[0][0].isalnum()):
        return None
    if left > 0:
        return Step(left, state.rest[:left])
    return Step(match.end(), "\u2026", f"a word is cut after {MAX_WORD_LENGTH} characters: {before[:20]}\u2026")
