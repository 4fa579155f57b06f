"""Interpolation between two hand poses."""

from math import acos, pi, sin, sqrt

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.expressivity.keyframes import Hand


def angle_between(a: Floats | None, b: Floats | None) -> float:
    """Return the angle between two directions (3,) [rad].

    It is 0 if one of them is missing.
    """
    return 0.0 if a is None or b is None else acos(min(max(float(a @ b), -1.0), 1.0))


def interpolate_hands(a: Hand, b: Hand, fraction: float, rest: Reach) -> Hand:
    """Interpolate between two hand poses.

    Args:
        a: pose at fraction 0.
        b: pose at fraction 1.
        fraction: 0..1.
        rest: pose of the hanging hand.

    Returns:
        The rest pose if both are at rest. A property that only one pose sets applies to its half of the interval.
    """
    if a.reach is None and b.reach is None:
        return Hand()
    if fraction <= 0 or fraction >= 1:
        return a if fraction <= 0 else b
    start, end, nearest = a.reach or rest, b.reach or rest, a if fraction < 0.5 else b
    reach = nearest.reach or rest
    return Hand(
        Reach(
            position=start.position + fraction * (end.position - start.position),
            pointing=_interpolate_direction(start.pointing, end.pointing, fraction, reach.pointing),
            palm=_interpolate_direction(start.palm, end.palm, fraction, reach.palm),
        ),
        nearest.aim,
        a.touch if a.touch == b.touch else None,
        a.openness + fraction * (b.openness - a.openness),
        a.effort + fraction * (b.effort - a.effort),
        lift=a.lift + fraction * (b.lift - a.lift),
        shape=nearest.shape,
        tip=a.tip if a.tip == b.tip else None,
    )


def _interpolate_direction(
    a: Floats | None, b: Floats | None, fraction: float, nearest: Floats | None
) -> Floats | None:
    """Interpolate between two unit directions (3,) on their great circle.

    `nearest` is returned if one is missing (None), or if they are equal or opposite.
    """
    if a is None or b is None:
        return nearest
    angle = angle_between(a, b)
    if angle < 1e-9 or angle > pi - 1e-6:
        return nearest
    mixed = (sin((1 - fraction) * angle) * a + sin(fraction * angle) * b) / sin(angle)
    return np.asarray(mixed / sqrt(mixed @ mixed))
