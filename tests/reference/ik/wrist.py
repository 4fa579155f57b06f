"""Wrist angles for pointing and palm, by coordinate ascent.

How well directions agree is, in each single hinge, A cos q + B sin q: its best angle is known in closed form, and
so is its best angle inside a range. Taking the hinges in turn climbs to a peak; where the stops make several peaks,
the climb begins again at each corner of the ranges.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from kinesic.ik.angles import arccosine, arctangent, cosine_sine
from kinesic.ik.arm.linkage import Link, Pivot
from kinesic.ik.scalar3 import Rotation, Vector, cross, dot, rotated, turned, within

MAX_ITERATIONS = 40  # largest number of iterations
TOLERANCE = 1e-6  # [rad] largest hinge rotation of the last iteration
AGREEMENT_TOLERANCE = 1e-4  # distance from full agreement below which no restart is needed
REST_WEIGHT = 2e-4  # weight of the rest angles; each direction has weight 1


@dataclass(frozen=True)
class HandDirection:
    """Direction of the hand with its target."""

    name: str
    own: Vector  # (3,) unit direction in the frame of the last segment
    wanted: Vector  # (3,) requested unit direction in the frame of the base


def orient(
    link: Link, frame: Rotation, directions: Sequence[HandDirection], rest: Sequence[float]
) -> tuple[float, ...]:
    """Return the angles of the hand's hinges for the requested directions.

    Args:
        link: the last link.
        frame: of the segment that its first hinge turns in, in the base.
        directions: directions; without any the hinges rest.
        rest: [rad] of these hinges.

    Returns:
        [rad] inside the ranges.
    """
    if not directions:
        return tuple(rest)
    best, height = _climbed(link, frame, directions, rest, rest)
    for start in product(*((pivot.lower, pivot.upper) for pivot in link.pivots)):
        if height > len(directions) - AGREEMENT_TOLERANCE:
            break
        result, agreement = _climbed(link, frame, directions, rest, start)
        if agreement > height:
            best, height = result, agreement
    return best


def direction_errors(frame: Rotation, directions: Sequence[HandDirection]) -> dict[str, float]:
    """Return the angle of each direction to its target [rad]."""
    agreements = {direction.name: dot(rotated(frame, direction.own), direction.wanted) for direction in directions}
    return {name: arccosine(max(-1.0, min(1.0, agreement))) for name, agreement in agreements.items()}


def _climbed(
    link: Link, frame: Rotation, directions: Sequence[HandDirection], rest: Sequence[float], start: Sequence[float]
) -> tuple[tuple[float, ...], float]:
    """Optimise one hinge angle after another until none changes."""
    angles, height = list(start), 0.0
    wanted = [within(frame, direction.wanted) for direction in directions]
    for _ in range(MAX_ITERATIONS):
        change = 0.0
        for k, pivot in enumerate(link.pivots):
            pairs = [
                (_inward(link, angles, k, look), _outward(link, angles, k, direction.own))
                for look, direction in zip(wanted, directions, strict=True)
            ]
            best, height = _best(pivot, pairs, rest[k])
            change, angles[k] = max(change, abs(best - angles[k])), best
        if change <= TOLERANCE:
            break
    return tuple(angles), height


def _inward(link: Link, angles: Sequence[float], k: int, look: Vector) -> Vector:
    """Return a direction of the base in the frame before hinge k."""
    for pivot, angle in zip(link.pivots[:k], angles, strict=False):
        look = turned(look, pivot.axis, -angle)
    return look


def _outward(link: Link, angles: Sequence[float], k: int, own: Vector) -> Vector:
    """Return a direction of the hand in the frame behind hinge k."""
    for j in range(len(link.pivots) - 1, k, -1):
        own = turned(own, link.pivots[j].axis, angles[j])
    return own


def _best(pivot: Pivot, pairs: Sequence[tuple[Vector, Vector]], rest: float) -> tuple[float, float]:
    a, b = (REST_WEIGHT * part for part in cosine_sine(rest))
    level = 0.0
    for look, own in pairs:
        along = dot(pivot.axis, look) * dot(pivot.axis, own)
        level += along
        a += dot(look, own) - along
        b += dot(look, cross(pivot.axis, own))

    def height(angle: float) -> float:
        cosine, sine = cosine_sine(angle)
        return a * cosine + b * sine

    peak = arctangent(b, a)
    if not pivot.lower <= peak <= pivot.upper:
        peak = max((pivot.lower, pivot.upper), key=height)
    return peak, level + height(peak)
