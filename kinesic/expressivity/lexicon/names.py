"""Splitting of gesture names into words and the hand they mention."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

from kinesic.bml.block import HandMode

SIDE_WORDS: dict[str, HandMode] = {"left": "left", "right": "right", "both": "both"}
NAME_CACHE_SIZE = 4096  # largest number of cached names, because documents may hold any number of names
MESSAGE_NAME_LENGTH = 60  # [characters] longer names are cut in messages
CATEGORY_WORDS = frozenset(
    {"metaphoric", "iconic", "emblem", "emblematic", "adaptor", "performative", "adjectival", "lexicalized"}
)

_WORD_PATTERN = re.compile(r"\d+[hH](?![^\W\d_])|\d+|[A-Z]?[^\W\d_A-Z]+|[A-Z]+(?![^\W\d_A-Z])")
_APOSTROPHE_PATTERN = re.compile(r"['\u2019`]")
_NAO_FOLDERS = re.compile(r"^(animations/)?(stand|sit|sitonpod)/(\w+/)+", re.IGNORECASE)  # folders of NAO names
_HAND_ABBREVIATIONS: dict[str, HandMode] = {
    **dict.fromkeys(("l", "lf", "lh", "lhand", "larm"), "left"),
    **dict.fromkeys(("r", "rt", "rh", "rhand", "rarm"), "right"),
    **dict.fromkeys(("b", "bt", "bh", "2h"), "both"),
}
_LIMB_WORDS = frozenset({"arm", "arms", "hand", "hands"})  # limb words that may follow the abbreviation of a hand
_EMPTY_WORDS = frozenset(  # words without meaning for the gesture
    {"a", "an", "the", "x", "zz", "1h", "ges", "gesture", "pos", "pose", "posture", "lexeme", "signal", "loop"}
    | {"anim", "animation", "motion", "motex", "greta"}
)
# Words that qualify a movement without changing its meaning.
_LEADING_QUALIFIERS = frozenset({"very", "really", "slow", "fast", "quick", "strong", "soft"})
_TRAILING_QUALIFIERS = _LEADING_QUALIFIERS | {
    *("low", "mid", "middle", "medium", "high", "center", "centre", "small", "big", "large"),
    *("strongly", "softly", "slowly", "quickly", "hold", "social", "new", "old"),
}


@dataclass(frozen=True)
class GestureName:
    """Words and hand of a gesture name, possibly with words left out."""

    words: tuple[str, ...]  # lower-case, in order, numbers included
    hand: HandMode = "unspecified"  # hand named by a suffix such as R, Lf, 2H, or by a removed word
    left_out: tuple[str, ...] = ()  # words removed from the name that mean more than the hand
    limbs: frozenset[str] = frozenset()  # words after the letter of a hand, as in `RArm_Offer`

    def shortened(self) -> Iterator["GestureName"]:
        """Yield the whole name, then variants with fewer qualifying words.

        Numbers and categories distinguish variants. Left, right and both name the hand, unless a suffix does. Low, big
        or slowly qualify the movement. Arm and hand after the letter of a hand add nothing to it.
        """
        yield self
        numberless = self._without(frozenset(word for word in self.words if word.isdigit()))
        yield numberless
        named = numberless._without(CATEGORY_WORDS)
        yield named
        yield named._trimmed()
        bare = named.sideless()
        yield bare
        yield bare._trimmed()
        if self.limbs:
            yield bare._without(self.limbs)._trimmed()

    def sideless(self) -> "GestureName":
        """Interpret the words left, right and both as the performing hand.

        They are left out where another hand is named.
        """
        sides = {SIDE_WORDS[word] for word in self.words if word in SIDE_WORDS}
        if not sides or sides == set(self.words):
            return self
        rest = self._without(frozenset(SIDE_WORDS))
        if len(sides) == 1 and self.hand in ("unspecified", *sides):
            return replace(rest, hand=sides.pop())
        return replace(rest, left_out=(*self.left_out, *(word for word in self.words if word in SIDE_WORDS)))

    def without(self, words: frozenset[str]) -> "GestureName":
        """Move the given words from the name to `left_out`."""
        kept, cut = ([word for word in self.words if (word in words) == is_removed] for is_removed in (False, True))
        return replace(self, words=tuple(kept), left_out=(*self.left_out, *cut))

    def _without(self, words: frozenset[str]) -> "GestureName":
        """Remove the given words, but keep the name if no word remains."""
        return replace(self, words=tuple(word for word in self.words if word not in words) or self.words)

    def _trimmed(self) -> "GestureName":
        """Move qualifiers from both ends of the name to `left_out`."""
        first, last = 0, len(self.words)
        while last - first > 1 and self.words[last - 1] in _TRAILING_QUALIFIERS:
            last -= 1
        while last - first > 1 and self.words[first] in _LEADING_QUALIFIERS:
            first += 1
        left_out = (*self.left_out, *self.words[:first], *self.words[last:])
        return replace(self, words=self.words[first:last], left_out=left_out)


def word_set(text: str) -> frozenset[str]:
    """Return the set of words in a text."""
    return frozenset(text.split())


def shorten_name(name: str) -> str:
    """Shorten a name for use in a message."""
    return name if len(name) <= MESSAGE_NAME_LENGTH else f"{name[:MESSAGE_NAME_LENGTH]}..."


@lru_cache(maxsize=NAME_CACHE_SIZE)
def split_words(name: str) -> tuple[str, ...]:
    """Split a name into words at non-letters, capitals and numbers.

    `GreetWave-RH2` gives greet, wave, rh, 2.
    """
    return tuple(word.lower() for word in _WORD_PATTERN.findall(_APOSTROPHE_PATTERN.sub("", name)))


@lru_cache(maxsize=NAME_CACHE_SIZE)
def read_name(name: str) -> GestureName:
    """Split a gesture name into words, and find the named hand.

    `Rise_Arm_R2` gives ("rise", "arm", "2") and the right hand; articles are removed.
    """
    words = split_words(_NAO_FOLDERS.sub("", name.strip()))
    hands = [_HAND_ABBREVIATIONS[word] for word in words if word in _HAND_ABBREVIATIONS]
    numbered = tuple(word.lstrip("0") or "0" if word.isdigit() else word for word in words)
    kept = tuple(word for word in numbered if word not in _HAND_ABBREVIATIONS and word not in _EMPTY_WORDS)
    limbs = frozenset(after for word, after in pairwise(words) if word in _HAND_ABBREVIATIONS and after in _LIMB_WORDS)
    return GestureName(kept, hands[-1] if hands else "unspecified", limbs=limbs)
