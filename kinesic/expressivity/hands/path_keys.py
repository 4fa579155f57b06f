"""What lies on the path of a hand from one stroke key to the next, as keys of their own."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.expressivity.hands.keys import HandKey, face_between
from kinesic.expressivity.hands.poses import between
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.turns import MERGE

SAMPLING = 0.01  # [arm lengths] that a path may be off the straight way between two of its samples
STEP = 0.2  # [arm lengths] from sample to sample at most: between them hinges turn evenly, and the hand leaves its path
SURGE = 0.5  # by how much longer full power makes the hand speed up along a path


def along(keys: Sequence[HandKey], k: int, path: HandPath | None, *, unit: float, power: float) -> list[HandKey]:
    """Keys on a path, without those that it joins; none where the hand rests, or goes straight.

    They are as many as the curve needs, but no nearer to one another in time than keys may be.

    Args:
        keys: of the whole stroke.
        k: the key that the path leads to, from the one before.
        path: in the world; None: straight.
        unit: the arm length [m].
        power: of the gesture.
    """
    a, b = keys[k - 1], keys[k]
    start, end = a.hand.reach, b.hand.reach
    if path is None or start is None or end is None:
        return []
    shares = path.samples(start.position, end.position, SAMPLING * unit, STEP * unit)
    times = a.time + (b.time - a.time) * _when(shares, path.swings(start.position, end.position), power)
    positions = path.at(start.position, end.position, shares)
    found: list[HandKey] = []
    for share, time, position in zip(shares, map(float, times), positions, strict=True):
        if min(time - (found[-1].time if found else a.time), b.time - time) >= MERGE:
            hand = face_between(between(a.hand, b.hand, float(share), start), keys, k, time)
            found.append(HandKey(time, _moved(hand, position)))
    return found


def _when(shares: Floats, swings: int, power: float) -> Floats:
    """(m,) shares of the time at which (m,) shares of a path are reached.

    The hand speeds up in half a swing and slows down in the last half, later and more suddenly without power.
    Greta's t^2 is fastest at the very end, where servos would have to stop it at once.
    """
    ramp = min(0.5, 0.5 * (1.0 + SURGE * power) / swings)
    time = np.linspace(0.0, 1.0, 501)
    speed = np.interp(time, [0.0, ramp, 1.0 - ramp, 1.0], [0.0, 1.0, 1.0, 0.0])
    along = np.concatenate([[0.0], np.cumsum(speed[1:] + speed[:-1])])
    return np.interp(shares, along / along[-1], time)


def _moved(hand: Hand, position: Floats) -> Hand:
    """The same hand elsewhere, on its path."""
    reach = hand.reach
    moved = None if reach is None else structs.replace(reach, position=sealed(position))
    return replace(hand, reach=moved, passing=True)
