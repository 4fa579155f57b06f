"""Takes the name of a gesture apart, word by word: what may carry its meaning, and the hand that it names."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

from kinesic.bml.block import HandMode

SIDE_WORDS: dict[str, HandMode] = {"left": "left", "right": "right", "both": "both"}
NAMES_KEPT = 4096  # names that are remembered taken apart; documents of strangers may hold any number
CHARACTERS_SHOWN = 60  # characters of a name in a message
CATEGORIES = frozenset(
    {"metaphoric", "iconic", "emblem", "emblematic", "adaptor", "performative", "adjectival", "lexicalized"}
)

_WORD = re.compile(r"\d+[hH](?![^\W\d_])|\d+|[A-Z]?[^\W\d_A-Z]+|[A-Z]+(?![^\W\d_A-Z])")
_APOSTROPHES = re.compile(r"['\u2019`]")
_FOLDERS = re.compile(r"^(animations/)?(stand|sit|sitonpod)/(\w+/)+", re.IGNORECASE)  # of NAO's animations
_HANDS: dict[str, HandMode] = {
    **dict.fromkeys(("l", "lf", "lh", "lhand", "larm"), "left"),
    **dict.fromkeys(("r", "rt", "rh", "rhand", "rarm"), "right"),
    **dict.fromkeys(("b", "bt", "bh", "2h"), "both"),
}
_LIMBS = frozenset({"arm", "arms", "hand", "hands"})
_NOISE = frozenset(  # says nothing of the meaning
    {"a", "an", "the", "x", "zz", "1h", "ges", "gesture", "pos", "pose", "posture", "lexeme", "signal", "loop"}
    | {"anim", "animation", "motion", "motex", "greta"}
)
_BEFORE = frozenset({"very", "really", "slow", "fast", "quick", "strong", "soft"})  # how something is done
_BEHIND = _BEFORE | {  # likewise, behind what is done
    *("low", "mid", "middle", "medium", "high", "center", "centre", "small", "big", "large"),
    *("strongly", "softly", "slowly", "quickly", "hold", "social", "new", "old"),
}


@dataclass(frozen=True)
class GestureName:
    """A name taken apart, or what is left of it after some words were put aside."""

    words: tuple[str, ...]  # lower-case, in order, numbers included
    hand: HandMode = "unspecified"  # that a suffix names, such as R, Lf, 2H, or a word that was put aside
    left_out: tuple[str, ...] = ()  # words put aside that say more than a hand
    limbs: frozenset[str] = frozenset()  # words that follow the letter of a hand: `RArm_Offer`

    def shortened(self) -> Iterator["GestureName"]:
        """Yields the name whole, then with less and less of what says how, and not what, is done.

        Numbers and categories tell variants apart; left, right and both name the hand, where no suffix does; low, big
        or slowly say how; arm and hand behind the letter of a hand say no more than it does.
        """
        yield self
        numberless = self._without(frozenset(word for word in self.words if word.isdigit()))
        yield numberless
        named = numberless._without(CATEGORIES)
        yield named
        yield named._trimmed()
        bare = named.sideless()
        yield bare
        yield bare._trimmed()
        if self.limbs:
            yield bare._without(self.limbs)._trimmed()

    def sideless(self) -> "GestureName":
        """Takes left, right and both as the hand, or leaves them out where another hand is named."""
        sides = {SIDE_WORDS[word] for word in self.words if word in SIDE_WORDS}
        if not sides or sides == set(self.words):
            return self
        rest = self._without(frozenset(SIDE_WORDS))
        if len(sides) == 1 and self.hand in ("unspecified", *sides):
            return replace(rest, hand=sides.pop())
        return replace(rest, left_out=(*self.left_out, *(word for word in self.words if word in SIDE_WORDS)))

    def without(self, words: frozenset[str]) -> "GestureName":
        """Puts words aside that the gesture does not show."""
        kept, cut = ([word for word in self.words if (word in words) == put] for put in (False, True))
        return replace(self, words=tuple(kept), left_out=(*self.left_out, *cut))

    def _without(self, words: frozenset[str]) -> "GestureName":
        """Puts words aside without a remark, unless nothing would be left."""
        return replace(self, words=tuple(word for word in self.words if word not in words) or self.words)

    def _trimmed(self) -> "GestureName":
        """Puts aside what says how, before and behind."""
        first, last = 0, len(self.words)
        while last - first > 1 and self.words[last - 1] in _BEHIND:
            last -= 1
        while last - first > 1 and self.words[first] in _BEFORE:
            first += 1
        left_out = (*self.left_out, *self.words[:first], *self.words[last:])
        return replace(self, words=self.words[first:last], left_out=left_out)


def word_set(text: str) -> frozenset[str]:
    """Makes a set of words from a text."""
    return frozenset(text.split())


def shorten_name(name: str) -> str:
    """Cuts a name of a stranger to what a message can show."""
    return name if len(name) <= CHARACTERS_SHOWN else f"{name[:CHARACTERS_SHOWN]}..."


@lru_cache(maxsize=NAMES_KEPT)
def split_words(name: str) -> tuple[str, ...]:
    """Splits a name at everything but letters, at capitals and at numbers: `GreetWave-RH2` is greet, wave, rh, 2."""
    return tuple(word.lower() for word in _WORD.findall(_APOSTROPHES.sub("", name)))


@lru_cache(maxsize=NAMES_KEPT)
def read_name(name: str) -> GestureName:
    """Takes a name apart: `Rise_Arm_R2` is ("rise", "arm", "2"), right hand; articles say nothing."""
    words = split_words(_FOLDERS.sub("", name.strip()))
    hands = [_HANDS[word] for word in words if word in _HANDS]
    told = tuple(word.lstrip("0") or "0" if word.isdigit() else word for word in words)
    kept = tuple(word for word in told if word not in _HANDS and word not in _NOISE)
    limbs = frozenset(after for word, after in pairwise(words) if word in _HANDS and after in _LIMBS)
    return GestureName(kept, hands[-1] if hands else "unspecified", limbs=limbs)
