"""Sentence position of marked words that may be a stage direction."""

import re

from kinesic.intent.manuscript.acts import load_acts
from kinesic.intent.manuscript.pieces import DIRECTED_PAUSE, END_OF_SENTENCE, Manuscript, Step, direct, pause


def is_waiting(after: str, *, ends: bool) -> bool:
    """Return whether the character after a markup has not been received yet."""
    return not ends and not after.lstrip(" \t")


def begins_phrase(state: Manuscript) -> bool:
    """Return whether a sentence, phrase or line begins at a markup."""
    before = state.spoken.rstrip(" \t\"'\u201c\u201d\u2019)")
    return state.is_line_start or not before or before[-1] in END_OF_SENTENCE + ",;:\u2014-\n>"


def is_interjected(state: Manuscript, after: str) -> bool:
    """Return whether a sentence would be complete without the marked text."""
    before = re.search(r"([^\W\d_]+)\s+$", state.spoken)
    following = re.match(r"[ \t]+([^\W\d_]+)", after)
    if before is None or following is None:
        return False
    acts = load_acts()
    return not acts.has("leading", before[1].lower()) and not acts.has("trailing", following[1].lower())


def ends_sentence(after: str) -> bool:
    """Return whether a sentence or line ends with a markup."""
    following = after.lstrip(" \t")[:1]
    return not following.isalnum() or following.isupper()


def direct_words(words: str, length: int) -> Step:
    """Convert a stage direction to a pause, or to words to perform."""
    if load_acts().is_pause(words):
        return Step(length, pause(DIRECTED_PAUSE))
    return Step(length, direct(words))
