"""Circle of possible elbow positions, and a bisection along this circle."""

from collections.abc import Callable
from math import sqrt
from typing import TypeVar

from kinesic.ik.angles import cosine_sine
from kinesic.ik.arm.linkage import Linkage
from kinesic.ik.arm.swivel import hanging_direction
from kinesic.ik.scalar3 import Vector, cross, distance, minus, norm, plus, scaled, unit

Posture = TypeVar("Posture")


def bisect_edge(
    at: Callable[[float], Posture],
    outside: float,
    inside: float,
    found: Posture,
    *,
    fits: Callable[[Posture], bool],
    rounds: int,
) -> Posture:
    """Bisect the boundary [rad] between a rejected and an accepted swivel."""
    for _ in range(rounds):
        middle = 0.5 * (outside + inside)
        tried = at(middle)
        if fits(tried):
            inside, found = middle, tried
        else:
            outside = middle
    return found


def elbow_at(linkage: Linkage, shoulder: Vector, hand: Vector, swivel: float) -> Vector:
    """Return the elbow position [m] for a swivel [rad].

    Where the bones cannot span the distance, the elbow lies on the line.
    """
    between = minus(hand, shoulder)
    line = unit(between) if norm(between) > 0.0 else (1.0, 0.0, 0.0)
    along, radius = _circle(linkage, norm(between))
    zero = hanging_direction(line)
    cosine, sine = cosine_sine(swivel)
    off = plus(scaled(zero, cosine), scaled(cross(line, zero), linkage.side * sine))
    return plus(shoulder, plus(scaled(line, along), scaled(off, radius)))


def elbow_radius(linkage: Linkage, shoulder: Vector, hand: Vector) -> float:
    """Return the radius [m] of the circle of possible elbow positions."""
    return _circle(linkage, distance(shoulder, hand))[1]


def _circle(linkage: Linkage, between: float) -> tuple[float, float]:
    """Return centre distance and radius [m] of the circle of elbow positions."""
    upper, fore = linkage.links[-3].length, linkage.links[-2].length
    span = max(between, 1e-9 * linkage.farthest)
    along = (upper * upper - fore * fore + span * span) / (2.0 * span)
    along = max(-upper, min(upper, along))
    return along, sqrt(upper * upper - along * along)
