"""Detection of head movements by gesture names: NOD, HeadShake, head_tilt_left."""

import re

_WORD_PATTERN = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")  # words of a camel-case name
_HEAD_MOVEMENT_WORDS = frozenset(  # words for head movements
    {"nod", "nods", "nodding", "shake", "shakes", "tilt", "tilts", "headnod", "headshake", "headtilt", "nodhead"}
)
_MODIFIER_WORDS = frozenset(  # words for direction, size, speed, count or hand
    {
        "head",
        "left",
        "right",
        "up",
        "down",
        "aside",
        "big",
        "large",
        "strong",
        "small",
        "subtle",
        "tiny",
        "slow",
        "fast",
    }
    | {"once", "twice", "double", "single", "lh", "rh", "h"}
)


def names_head_movement(lexeme: str) -> bool:
    """Return whether a gesture's name contains only words for head movements.

    Such movements are nods, shakes and tilts; `shake_hands` is none of them.
    """
    words = {word.lower() for word in _WORD_PATTERN.findall(lexeme)}
    return bool(words & _HEAD_MOVEMENT_WORDS) and words <= _HEAD_MOVEMENT_WORDS | _MODIFIER_WORDS
