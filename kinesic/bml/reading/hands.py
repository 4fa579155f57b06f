"""Inference of the hand from the name of a gesture or animation.

Examples: `cup_LH`, `LHandOnHip`, `Idle01_RArm_Offer`.
"""

import re
from collections.abc import Iterator, Mapping
from itertools import pairwise

from kinesic.bml.block import HandMode

_TOKEN_PATTERN = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+|_")  # words of a camel-case name, numbers, underscores
# words for a side
_SIDE_WORDS: dict[str, HandMode] = {"l": "left", "left": "left", "r": "right", "right": "right", "both": "both"}
_LIMB_WORDS = frozenset({"hand", "hands", "arm", "arms"})  # words that follow a side word: `left_hand`
_HAND_WORDS: dict[str, HandMode] = {  # words that name the hands
    **dict.fromkeys(("lh", "lhand", "larm"), "left"),
    **dict.fromkeys(("rh", "rhand", "rarm"), "right"),
    **dict.fromkeys(("bh", "botharms", "bothhands"), "both"),
}
_ANIMATION_HANDS: dict[str, HandMode] = {"lf": "left", "lt": "left", "rt": "right"}  # abbreviation in animation names


def infer_hands(name: str, *, of_animation: bool = False) -> HandMode:
    """Return the hands that a gesture or animation name indicates.

    The last indication counts, since the posture comes before the action in such names. A single letter (`Ges_L`) and
    the plain words left and right are interpreted by the lexicon. Without an indication the result is `unspecified`.

    Args:
        name: name of a gesture, a pose or an animation.
        of_animation: whether `Lf01` and `Rt01` indicate hands, too; in a lexeme they may have another meaning.
    """
    words = ["_", *(token.lower() for token in _TOKEN_PATTERN.findall(name.lower() if name.isupper() else name)), "_"]
    modes = list(_find_modes(words, {**_HAND_WORDS, **(_ANIMATION_HANDS if of_animation else {})}))
    return modes[-1] if modes else "unspecified"


def _find_modes(words: list[str], whole: Mapping[str, HandMode]) -> Iterator[HandMode]:
    for k, (word, following) in enumerate(pairwise(words)):
        limb = words[k + 2] if following == "_" and k + 2 < len(words) else following
        if word in whole:
            yield whole[word]
        elif word in _SIDE_WORDS and limb in _LIMB_WORDS:
            yield _SIDE_WORDS[word]
        elif (word, following) == ("2", "h") or words[k - 1 : k + 2] == ["_", "arms", "_"]:
            yield "both"
