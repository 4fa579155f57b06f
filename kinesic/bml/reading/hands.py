"""The hand that the name of a gesture or of an animation decides: `cup_LH`, `LHandOnHip`, `Idle01_RArm_Offer`."""

import re
from collections.abc import Iterator, Mapping
from itertools import pairwise

from kinesic.bml.block import HandMode

_TOKEN = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+|_")
_SIDES: dict[str, HandMode] = {"l": "left", "left": "left", "r": "right", "right": "right", "both": "both"}
_LIMBS = frozenset({"hand", "hands", "arm", "arms"})
_WHOLE: dict[str, HandMode] = {  # words that say it by themselves
    **dict.fromkeys(("lh", "lhand", "larm"), "left"),
    **dict.fromkeys(("rh", "rhand", "rarm"), "right"),
    **dict.fromkeys(("bh", "botharms", "bothhands"), "both"),
}
_SHORT: dict[str, HandMode] = {"lf": "left", "lt": "left", "rt": "right"}  # `BeatMidRt01`


def hands_named(name: str, *, of_animation: bool = False) -> HandMode:
    """Reads which hands a name decides; of several the last counts, since a posture stands before what is done in it.

    A letter alone (`Ges_L`) and the words left and right by themselves are left to the lexicon.

    Args:
        name: of a gesture, a pose or an animation.
        of_animation: whether `Lf01` and `Rt01` are hands, too; in a lexeme they may be anything.
    """
    words = ["_", *(token.lower() for token in _TOKEN.findall(name.lower() if name.isupper() else name)), "_"]
    found = list(_modes(words, {**_WHOLE, **(_SHORT if of_animation else {})}))
    return found[-1] if found else "unspecified"


def _modes(words: list[str], whole: Mapping[str, HandMode]) -> Iterator[HandMode]:
    for k, (word, following) in enumerate(pairwise(words)):
        limb = words[k + 2] if following == "_" and k + 2 < len(words) else following
        if word in whole:
            yield whole[word]
        elif word in _SIDES and limb in _LIMBS:
            yield _SIDES[word]
        elif (word, following) == ("2", "h") or words[k - 1 : k + 2] == ["_", "arms", "_"]:
            yield "both"
