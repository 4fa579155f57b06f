"""Motion of each segment relative to its parent, for export files."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.rotation import rotation_to_quaternion


@dataclass(frozen=True, eq=False)
class SegmentMotion:
    """Rotations and translations over time of one segment relative to its parent."""

    segment: int  # index in the skeleton
    parent: int  # index of the parent; -1: the world
    rotations: Floats  # (m, 4) quaternions x, y, z, w without sign jumps
    translations: Floats  # (m, 3) [m]


def segment_motions(robot: Robot, angles: Floats) -> Iterator[SegmentMotion]:
    """Yield the motion of each segment, in skeleton order.

    Args:
        robot: robot that moves.
        angles: (m, n) [rad].
    """
    stand = robot.skeleton.frames(angles)
    for k, (parent, _, _) in enumerate(robot.skeleton.steps):
        rotations, places = stand.rotations[:, k], stand.origins[:, k]
        if parent >= 0:
            back = stand.rotations[:, parent].transpose(0, 2, 1)
            rotations, places = back @ rotations, np.einsum("mij,mj->mi", back, places - stand.origins[:, parent])
        yield SegmentMotion(k, parent, smooth_quaternions(rotations), places)


def smooth_quaternions(rotations: Floats) -> Floats:
    """Convert rotations to quaternions without sign jumps, (m, 4)."""
    quaternions = rotation_to_quaternion(rotations)
    flips = np.where(np.einsum("mi,mi->m", quaternions[1:], quaternions[:-1]) < 0.0, -1.0, 1.0)
    quaternions[1:] *= np.cumprod(flips)[:, None]
    return quaternions
