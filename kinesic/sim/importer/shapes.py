"""Capsules of a segment: the model's own primitive shapes where it has some, else its bone with a human's girth."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot_schema import CapsuleTable
from kinesic.body.skeleton import Capsule

UPPER, FORE, HAND, HEAD = (
    0.15,
    0.14,
    0.12,
    0.17,
)  # radius: of the upper arm's, the forearm's, again its, the arm's length
HAND_LENGTH = 0.45  # of the forearm
BETWEEN = 0.035  # [m] air between the trunk and a hanging arm
LEAST_GIRTH = 0.01  # [m]
DIGITS = 6


def bone(start: Floats, end: Floats, radius: float, *, spared: float = 0.0) -> CapsuleTable:
    """A capsule along a bone that keeps a share of it free at its start."""
    begin = start + spared * (end - start)
    return CapsuleTable(_triple(begin), _triple(end), round(max(radius, LEAST_GIRTH), DIGITS))


def own(shapes: Sequence[Capsule], origin: Floats) -> list[CapsuleTable]:
    """The model's shapes in the frame of a segment."""
    return [CapsuleTable(_triple(s.start - origin), _triple(s.end - origin), round(s.radius, DIGITS)) for s in shapes]


def trunk(waist: Floats, shoulders: Floats, half_width: float, arm_radius: float) -> list[CapsuleTable]:
    """Chest and belly between the shoulders and the waist.

    Args:
        waist: (3,) [m] in the segment.
        shoulders: (3,) [m] the point between both, in the segment.
        half_width: [m] from the midline to a shoulder.
        arm_radius: [m] of an upper arm.
    """
    reach = max(half_width - arm_radius - BETWEEN, LEAST_GIRTH)
    radius = 0.62 * reach
    side = np.array([0.0, reach - radius, 0.0])
    chest = shoulders - np.array([0.0, 0.0, 0.8 * radius])
    belly = waist + np.array([0.0, 0.0, radius])
    if belly[2] > chest[2] - 0.5 * radius:
        return [bone(chest - side, chest + side, radius)]
    return [bone(chest - side, chest + side, radius), bone(belly, (belly + chest) / 2, 0.9 * radius)]


def _triple(point: Floats) -> tuple[float, float, float]:
    x, y, z = (round(float(value), DIGITS) + 0.0 for value in point)
    return x, y, z
