"""Words for directions, and the order of axes, in gesture files."""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import suggestion

FILE_ORDER = (1, 2, 0)  # indices of outward, up, forward in an array (3,) forward, outward, up
MAX_WORD_REPEATS = 3  # largest number of equal words in a printed direction; other directions are printed as numbers
_DIRECTION_VECTORS: Mapping[str, tuple[int, int, int]] = {  # unit vectors forward, outward, up by direction word
    "forward": (1, 0, 0),
    "back": (-1, 0, 0),
    "out": (0, 1, 0),
    "in": (0, -1, 0),
    "up": (0, 0, 1),
    "down": (0, 0, -1),
}
_WORD_PAIRS = (("out", "in"), ("up", "down"), ("forward", "back"))  # positive and negative words in the file's order


def read_direction(words: str) -> Floats:
    """Convert direction words to their mean unit vector: forward, outward, up.

    Raises:
        ValueError: a word is no direction, or the words cancel out.
    """
    total = np.zeros(3)
    for word in words.split():
        if word not in _DIRECTION_VECTORS:
            raise ValueError(f"{word} is no direction{suggestion(word, list(_DIRECTION_VECTORS))}")
        total += _DIRECTION_VECTORS[word]
    length = float(np.linalg.norm(total))
    if length == 0:
        raise ValueError(f"{words!r} points nowhere; such as 'up' or 'forward in'")
    return sealed(total / length)


def format_direction(direction: Floats) -> str:
    """Return the words for a direction (3,) forward, outward, up.

    Directions of no few words become numbers in the file's order.
    """
    components = direction[list(FILE_ORDER)]
    smallest = np.abs(components)[np.abs(components) > 1e-6].min()
    counts = np.rint(components / smallest).astype(int)
    if np.abs(counts).max() > MAX_WORD_REPEATS or not np.allclose(counts * smallest, components, atol=1e-6):
        return " ".join(f"{value:.1f}" for value in components)
    pairs = zip(_WORD_PAIRS, counts.tolist(), strict=True)
    return " ".join(word for pair, count in pairs for word in [pair[count < 0]] * abs(count))
