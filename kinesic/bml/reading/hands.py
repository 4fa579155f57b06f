"""The hand that the name of a gesture or of an animation decides: `cup_LH`, `LHandOnHip`, `Idle01_RArm_Offer`."""

import re
from collections.abc import Iterator
from itertools import pairwise

from kinesic.bml.block import Mode

_TOKEN = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+|_")
_SIDES: dict[str, Mode] = {"l": "left", "left": "left", "r": "right", "right": "right", "both": "both"}
_LIMBS = frozenset({"hand", "hands", "arm", "arms"})
_WHOLE: dict[str, Mode] = {  # words that say it by themselves
    **dict.fromkeys(("lh", "lhand", "larm"), "left"),
    **dict.fromkeys(("rh", "rhand", "rarm"), "right"),
    **dict.fromkeys(("bh", "botharms", "bothhands"), "both"),
}
_NUMBERED: dict[str, Mode] = {"lf": "left", "lt": "left", "rt": "right"}  # `BeatMidRt01`


def hands_named(name: str) -> Mode:
    """Reads which hands a name decides; of several the last counts, since a posture stands before what is done in it.

    A letter alone (`Ges_L`) and the words left and right by themselves are left to the lexicon.
    """
    found: list[Mode] = list(_modes(["_", *_TOKEN.findall(name.lower() if name.isupper() else name), "_"]))
    return found[-1] if found else "unspecified"


def _modes(tokens: list[str]) -> Iterator[Mode]:
    words = [token.lower() for token in tokens]
    for k, (word, following) in enumerate(pairwise(words)):
        limb = words[k + 2] if following == "_" and k + 2 < len(words) else following
        if word in _WHOLE:
            yield _WHOLE[word]
        elif word in _SIDES and limb in _LIMBS:
            yield _SIDES[word]
        elif (word, following) == ("2", "h") or words[k - 1 : k + 2] == ["_", "arms", "_"]:
            yield "both"
        elif word in _NUMBERED and (following.isdecimal() or following == "_"):
            yield _NUMBERED[word]
