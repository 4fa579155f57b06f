r"""Emoticons and kaomoji of texts, such as `:-P`, `(^_^)` and `¯\_(ツ)_/¯`."""

import re
from functools import lru_cache

from kinesic.intent.manuscript.acts import load_acts
from kinesic.intent.manuscript.emoji import perform_emoji
from kinesic.intent.manuscript.pieces import Manuscript, Step

_FACE_LETTERS = "\u03c9\u0414\u0ca0\u1d25\u1d17\u76ca\u76bf\u0ca5"  # letters that stand for eyes or a mouth in kaomoji
# Signs that distinguish a face from punctuation.
_FACE_SIGNS = rf"\^\xb0\u2022\u25d5\u203f\u25e1\u25bd\u2267\u2266\u2565\u25d4\u2299{_FACE_LETTERS}"
_FACE_PART = rf"(?:[^\w\n()<>\"'\uff08\uff09]|[_{_FACE_LETTERS}])"  # pattern of one character of a face
# Face in brackets, without words.
_FACE_PATTERN = re.compile(rf"[(\uff08](?=[^)\uff09\n]{{0,14}}[{_FACE_SIGNS}]){_FACE_PART}{{3,14}}[)\uff09]")
_OPEN_FACE = re.compile(rf"[(\uff08]{_FACE_PART}{{0,14}}")


def read_emoticon(state: Manuscript, *, ends: bool) -> Step | None:
    """Read an emoticon as the emoji with the same meaning.

    Returns:
        Length 0 without an emoticon, None if it may be incomplete.
    """
    rest = state.rest
    if state.spoken[-1:].isalnum():
        return Step(0)
    pattern, beginnings = _list_emoticons()
    if not ends and (rest in beginnings or _OPEN_FACE.fullmatch(rest)):
        return None
    match = pattern.match(rest)
    if match:
        return perform_emoji(load_acts().emoticons[match[0]], match.end())
    face = _FACE_PATTERN.match(rest)
    return Step(face.end(), " ", f"emoji is not shown: {face[0]}") if face else Step(0)


@lru_cache(maxsize=1)
def _list_emoticons() -> tuple[re.Pattern[str], frozenset[str]]:
    """Return a pattern of all emoticons, and their beginnings."""
    emoticons = sorted(load_acts().emoticons, key=len, reverse=True)
    pattern = re.compile(f"(?:{'|'.join(map(re.escape, emoticons))})(?!\\w)")
    return pattern, frozenset(text[:length] for text in emoticons for length in range(1, len(text) + 1))
