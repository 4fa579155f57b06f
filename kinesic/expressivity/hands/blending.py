"""Blends two poses of a hand."""

from math import acos, pi, sin, sqrt

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.keyframes import Hand


def angle_between(a: Floats | None, b: Floats | None) -> float:
    """Measures the angle between two directions (3,) [rad]; 0 where one is missing."""
    return 0.0 if a is None or b is None else acos(min(max(float(a @ b), -1.0), 1.0))


def between(a: Hand, b: Hand, share: float, rest: Reach) -> Hand:
    """Interpolates between two hands at a share of the way.

    Args:
        a: at share 0.
        b: at share 1.
        share: 0..1.
        rest: where the hand hangs.

    Returns:
        At rest if both are. What only one of the two asks for holds on its half of the way.
    """
    if a.reach is None and b.reach is None:
        return Hand()
    if share <= 0 or share >= 1:
        return a if share <= 0 else b
    start, end, nearest = a.reach or rest, b.reach or rest, a if share < 0.5 else b
    reach = nearest.reach or rest
    return Hand(
        Reach(
            position=sealed(start.position + share * (end.position - start.position)),
            pointing=_turn_between(start.pointing, end.pointing, share, reach.pointing),
            palm=_turn_between(start.palm, end.palm, share, reach.palm),
        ),
        nearest.aim,
        a.touch if a.touch == b.touch else None,
        a.openness + share * (b.openness - a.openness),
        a.effort + share * (b.effort - a.effort),
        lift=a.lift + share * (b.lift - a.lift),
        shape=nearest.shape,
        tip=a.tip if a.tip == b.tip else None,
    )


def _turn_between(a: Floats | None, b: Floats | None, share: float, nearest: Floats | None) -> Floats | None:
    """Turns on the great circle; the nearest where one is missing or they are opposite."""
    if a is None or b is None:
        return nearest
    angle = angle_between(a, b)
    if angle < 1e-9 or angle > pi - 1e-6:
        return nearest
    mixed = (sin((1 - share) * angle) * a + sin(share * angle) * b) / sin(angle)
    return sealed(mixed / sqrt(mixed @ mixed))
