"""Where the elbow may be while shoulder and hand stay: a circle, and the swivel that tells the place on it.

The swivel is measured from the hanging elbow. "Hanging" is carried from the arm that reaches straight forward
(elbow below) to every other direction by the shortest turn: backward with the arm hanging, below with the arm
to the side, forward with the arm up. So the zero is defined and smooth wherever an arm can reach, which the
vertical plane is not.
"""

from collections.abc import Callable, Sequence
from math import sqrt
from typing import TypeVar

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.ik.angles import arctangent, cosine_sine
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain
from kinesic.ik.scalar3 import Vector, across, cross, distance, dot, minus, norm, plus, scaled, unit

Posture = TypeVar("Posture")

BACKWARD = -1.0 + 1e-9  # cosine to the forward axis at which the hanging direction is undefined


def bisect_edge(
    at: Callable[[float], Posture],
    outside: float,
    inside: float,
    found: Posture,
    *,
    fits: Callable[[Posture], bool],
    rounds: int,
) -> Posture:
    """Bisects from a swivel [rad] whose posture does not fit to one whose posture does; the last that fits."""
    for _ in range(rounds):
        middle = 0.5 * (outside + inside)
        tried = at(middle)
        if fits(tried):
            inside, found = middle, tried
        else:
            outside = middle
    return found


def hanging_direction(line: Vector) -> Vector:
    """Finds the direction of a hanging elbow, off the line from shoulder to hand.

    Args:
        line: unit, from the shoulder to the hand.

    Returns:
        Unit vector perpendicular to the line.
    """
    x, y, z = line
    if x < BACKWARD:
        return 0.0, 0.0, 1.0
    share = z / (1.0 + x)
    return unit((share * (x + 1.0), share * y, share * z - 1.0))


def swivel_of(linkage: Linkage, points: Sequence[Vector]) -> float | None:
    """Measures the swivel [rad] of shoulder, elbow and hand, three points [m]; None for a straight arm."""
    shoulder, elbow, hand = points
    line = unit(minus(hand, shoulder))
    off = across(minus(elbow, shoulder), line)
    if norm(off) < 1e-6 * linkage.farthest or line == (0.0, 0.0, 0.0):
        return None
    zero = hanging_direction(line)
    return linkage.side * arctangent(dot(off, cross(line, zero)), dot(off, zero))


def elbow_at(linkage: Linkage, shoulder: Vector, hand: Vector, swivel: float) -> Vector:
    """Places the elbow [m] on its circle, for shoulder and hand [m] and a swivel [rad].

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
    """Measures the radius [m] of the elbow's circle for shoulder and hand [m]; 0 where bones do not span it."""
    return _circle(linkage, distance(shoulder, hand))[1]


def _circle(linkage: Linkage, between: float) -> tuple[float, float]:
    """How far along the line from shoulder to hand the elbow's circle is, and its radius [m]."""
    upper, fore = linkage.links[-3].length, linkage.links[-2].length
    span = max(between, 1e-9 * linkage.farthest)
    along = (upper * upper - fore * fore + span * span) / (2.0 * span)
    along = max(-upper, min(upper, along))
    return along, sqrt(upper * upper - along * along)


def swivel(chain: Chain, angles: Floats) -> float | None:
    """Measures how far the elbow is turned about the line from shoulder to hand.

    Args:
        chain: the arm.
        angles: (k,) [rad].

    Returns:
        [rad] 0 = hanging, + = away from the body; None for a straight arm, which has no swivel.
    """
    linkage = linkage_of(mirror_chain(chain) if is_right(chain) else chain)
    return swivel_of(linkage, linkage.walk(angles.tolist(), len(linkage.links) - 1)[1][-3:])
