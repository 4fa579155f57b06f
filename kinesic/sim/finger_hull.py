"""A ball about all that the fingers of a hand can reach."""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side
from kinesic.body.skeleton import Capsule


def finger_hull(robot: Robot, side: Side) -> Capsule:
    """Finds a ball, fixed to the hand's segment, that holds its fingers however they are bent.

    Args:
        robot: with fingers on that side.
        side: of the hand.
    """
    hand = robot.skeleton.segments[robot.arm(side).wrist].name
    roots: list[Floats] = []
    lengths: list[float] = []
    for name in robot.fingers(side):
        part = robot.skeleton.segments[robot.skeleton.segment(name)]
        ends = [
            np.linalg.norm(end) + capsule.radius for capsule in part.capsules for end in (capsule.start, capsule.end)
        ]
        length = float(max(ends, default=0.0))
        while part.parent is not None and part.parent != hand:
            length += float(np.linalg.norm(part.origin_in_parent))
            part = robot.skeleton.segments[robot.skeleton.segment(part.parent)]
        roots.append(part.origin_in_parent)
        lengths.append(length)
    centre = np.mean(roots, axis=0)
    radius = max(float(np.linalg.norm(root - centre)) + length for root, length in zip(roots, lengths, strict=True))
    return Capsule(sealed(centre), sealed(centre), radius)
