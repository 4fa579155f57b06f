"""Swivel angle: rotation of the elbow about the shoulder-hand line.

The swivel is measured from the hanging elbow. "Hanging" is carried from the arm that reaches straight forward
(elbow below) to every other direction by the shortest turn: backward with the arm hanging, below with the arm
to the side, forward with the arm up. So the zero is defined and smooth wherever an arm can reach, which the
vertical plane is not.
"""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.ik.angles import arctangent
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import MIRROR_SIGNS, is_right, mirror_chain
from kinesic.ik.scalar3 import Vector, across, cross, dot, minus, norm, unit

FORWARD_AXIS = sealed([1.0, 0.0, 0.0])  # forward axis of the arm's base
UPWARD_AXIS = sealed([0.0, 0.0, 1.0])  # upward axis of the arm's base
BACKWARD_COSINE = -1.0 + 1e-9  # cosine between arm line and forward axis below which the hanging direction is set to up


def hanging_direction(line: Vector) -> Vector:
    """Return the direction in which a relaxed elbow hangs.

    Args:
        line: unit, from the shoulder to the hand.

    Returns:
        Unit vector perpendicular to the line.
    """
    x, y, z = line
    if x < BACKWARD_COSINE:
        return 0.0, 0.0, 1.0
    share = z / (1.0 + x)
    return unit((share * (x + 1.0), share * y, share * z - 1.0))


def swivel_of(linkage: Linkage, points: Sequence[Vector]) -> float | None:
    """Compute the swivel angle [rad] from joint positions, None if undefined."""
    shoulder, elbow, hand = points
    line = unit(minus(hand, shoulder))
    off = across(minus(elbow, shoulder), line)
    if norm(off) < 1e-6 * linkage.farthest or line == (0.0, 0.0, 0.0):
        return None
    zero = hanging_direction(line)
    return linkage.side * arctangent(dot(off, cross(line, zero)), dot(off, zero))


def measure_swivels(chain: Chain, elbows: Floats, hands: Floats) -> Floats:
    """Compute the swivel angles (m,) [rad] of many elbows and hands.

    The result is NaN or arbitrary for a straight arm, which has no swivel.

    Args:
        chain: the arm.
        elbows: (m, 3) from the shoulder.
        hands: (m, 3) from the shoulder, not zero.
    """
    if is_right(chain):
        elbows, hands = elbows * MIRROR_SIGNS, hands * MIRROR_SIGNS
    lines = hands / np.linalg.norm(hands, axis=1, keepdims=True)
    offsets = elbows - lines * np.sum(elbows * lines, axis=1, keepdims=True)
    is_backward = lines[:, 0] < BACKWARD_COSINE
    shares = lines[:, 2] / np.where(is_backward, 1.0, 1.0 + lines[:, 0])
    zeros = shares[:, None] * (lines + FORWARD_AXIS) - UPWARD_AXIS
    zeros[is_backward] = UPWARD_AXIS
    asides = np.cross(lines, zeros)
    swivels: Floats = np.arctan2(np.sum(offsets * asides, axis=1), np.sum(offsets * zeros, axis=1))
    return swivels


def swivel(chain: Chain, angles: Floats) -> float | None:
    """Compute the swivel angle [rad] of an arm posture, None if straight.

    Args:
        chain: the arm.
        angles: (k,) [rad].

    Returns:
        [rad] 0 = hanging, + = away from the body; None for a straight arm, which has no swivel.
    """
    linkage = linkage_of(mirror_chain(chain) if is_right(chain) else chain)
    return swivel_of(linkage, linkage.walk(angles.tolist(), len(linkage.links) - 1)[1][-3:])
