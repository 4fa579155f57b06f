"""One hand in time: its keys, and where it is between them."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from msgspec import structs

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.hands.poses import REST, between
from kinesic.expressivity.hands.rotation_spline import Turning, facing_rotations
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.turns import MERGE
from kinesic.motion.keys import PLAIN, Passage

PARALLEL = 0.99  # cosine of pointing and palm from which on they say no rotation


@dataclass(frozen=True, eq=False)
class HandKey:
    """One hand at one time."""

    time: float  # [s] block time
    hand: Hand
    passage: Passage = PLAIN


def hand_at(keys: Sequence[HandKey], time: float, rest: Reach) -> Hand:
    """The hand at a time, straight between its keys, constant outside them."""
    k = bisect_right(keys, time, key=lambda key: key.time)
    if k == 0 or k == len(keys):
        return keys[min(k, len(keys) - 1)].hand if keys else REST
    a, b = keys[k - 1], keys[k]
    return between(a.hand, b.hand, (time - a.time) / (b.time - a.time), rest)


def face_between(hand: Hand, keys: Sequence[HandKey], k: int, time: float) -> Hand:
    """A hand between the keys k - 1 and k, turned at a time [s] as a spline through them and their neighbours turns it.

    So its turning speed does not jump at the keys, which matters where what lies between them becomes keys, too. As it
    is where they do not turn it, or leave its pointing or its palm open.
    """
    about = [
        (key, reach.pointing, reach.palm)
        for j, key in enumerate(keys[max(0, k - 2) : k + 2], max(0, k - 2))
        if (reach := key.hand.reach) and reach.pointing is not None and reach.palm is not None
        if abs(reach.pointing @ reach.palm) < PARALLEL
        if j in (k - 1, k) or min(abs(key.time - other.time) for other in keys[k - 1 : k + 1]) >= MERGE
    ]
    ends = [row for row in about if row[0] in (keys[k - 1], keys[k])]
    if hand.reach is None or len(ends) < 2 or all(np.array_equal(*pair) for pair in list(zip(*ends, strict=True))[1:]):
        return hand
    near, pointing, palm = zip(*about, strict=True)
    turning = Turning.through(
        [key.time for key in near], facing_rotations(np.array(pointing), np.array(palm)), [key.passage for key in near]
    )
    along, _, facing_there = turning.at(np.array([time])).as_matrix()[0].T
    return replace(hand, reach=structs.replace(hand.reach, pointing=sealed(along), palm=sealed(facing_there)))
