"""Whether the name of a gesture is that of a head movement: NOD, HeadShake, head_tilt_left."""

import re

_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_MOVEMENTS = frozenset(
    {"nod", "nods", "nodding", "shake", "shakes", "tilt", "tilts", "headnod", "headshake", "headtilt", "nodhead"}
)
_WITH_THEM = frozenset(  # words that say how, and carry no meaning of their own
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
    """Checks whether all words of a name speak of a nod, a shake or a tilt; `shake_hands` does not."""
    words = {word.lower() for word in _WORD.findall(lexeme)}
    return bool(words & _MOVEMENTS) and words <= _MOVEMENTS | _WITH_THEM
