"""Forward kinematics of a whole motion at once: `Skeleton.frames`, laid out so that postures are contiguous."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, Indices
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Skeleton
from kinesic.kernels import Kernel, find_kernel

KERNEL: Kernel = find_kernel("kinesic.sim._kernel")  # which implementation runs

if KERNEL == "compiled":
    from kinesic.sim import _kernel


@dataclass(frozen=True, eq=False)
class MotionFrames:
    """Where every segment is, in the world, in each posture of a motion."""

    rotations: Floats  # (s, 3, 3, m)
    origins: Floats  # (s, 3, m) [m]

    def points(self, segment: int, point: Floats) -> Floats:
        """(3, m) [m] in the world of a point (3,) [m] on a segment."""
        points: Floats = self.origins[segment] + point @ self.rotations[segment]
        return points

    def axes(self, segments: list[int], starts: Floats, ends: Floats) -> tuple[Floats, Floats]:
        """(c, 3, m) [m] starts and ends in the world of lines (c, 3) [m] that are fixed to segments."""
        origins, rotations = self.origins[segments], self.rotations[segments]
        here, there = (origins + (side[:, None, None, :] @ rotations)[:, :, 0, :] for side in (starts, ends))
        return here, there

    def at(self, postures: Indices) -> "MotionFrames":
        """Takes some of the postures."""
        return MotionFrames(self.rotations[..., postures], self.origins[..., postures])


def body_frames(robot: Robot, angles: Floats) -> MotionFrames:
    """Solves the forward kinematics (m, n) [rad] of all segments but the fingers."""
    fingers = robot.finger_segments
    others = set(range(len(robot.skeleton.segments))) - fingers
    return motion_frames(robot.skeleton, angles, only=others if fingers else None)


def motion_frames(
    skeleton: Skeleton, angles: Floats, *, only: Collection[int] | None = None, known: MotionFrames | None = None
) -> MotionFrames:
    """Solves the forward kinematics, one hinge at a time over all postures.

    Args:
        skeleton: the robot.
        angles: (m, n) [rad] in joint order.
        only: segments to solve, none without its parent unless that is known; None: all.
        known: the frames of other segments in the same postures.

    Returns:
        Rotation and origin of each segment in the world; of those that are neither asked for nor known, anything.
    """
    count, turns = len(angles), skeleton.turns(angles)
    rotations = np.empty((len(skeleton.segments), 3, 3, count)) if known is None else known.rotations.copy()
    origins = np.empty((len(skeleton.segments), 3, count)) if known is None else known.origins.copy()
    if KERNEL == "compiled":
        chosen = np.array([only is None or k in only for k in range(len(skeleton.segments))])
        turned = np.ascontiguousarray(turns.T)
        compiled_frames(skeleton).solve(chosen, np.sin(turned), np.cos(turned), rotations, origins)
        return MotionFrames(rotations, origins)
    for k, (parent, origin, hinges) in enumerate(skeleton.steps):
        if only is not None and k not in only:
            continue
        if parent < 0:
            rotation = np.repeat(np.eye(3)[:, :, None], count, axis=2)
            origins[k] = origin[:, None]
        else:
            rotation = rotations[parent]
            origins[k] = origins[parent] + origin @ rotation
        for joint, aside in hinges:
            turned = _turned(rotation, skeleton.axes[joint], turns[:, joint])
            if aside is not None:
                origins[k] += aside @ (rotation - turned)
            rotation = turned
        rotations[k] = rotation
    return MotionFrames(rotations, origins)


@lru_cache(maxsize=16)
def compiled_frames(skeleton: Skeleton) -> "_kernel.MotionFrames":
    """Makes what the kernel knows of a skeleton, once."""
    frames = _kernel.MotionFrames()
    for parent, origin, hinges in skeleton.steps:
        joints = [joint for joint, _ in hinges]
        aside = np.array([np.zeros(3) if at is None else at for _, at in hinges])
        frames.add_link(parent, np.ascontiguousarray(origin), joints, skeleton.axes[joints], aside)
    return frames


def _turned(rotations: Floats, axis: Floats, angles: Floats) -> Floats:
    """R (I + sin K + (1 - cos) K^2) with the axis' cross product matrix K: Rodrigues' formula."""
    sin, cos = np.sin(angles), np.cos(angles)
    x, y, z = axis.tolist()
    if [x, y, z].count(0.0) == 2:  # of the columns, two turn in their plane
        j, k = (1, 2) if x else (2, 0) if y else (0, 1)
        sin *= x + y + z
        turned = rotations.copy()
        turned[:, j] = cos * rotations[:, j] + sin * rotations[:, k]
        turned[:, k] = cos * rotations[:, k] - sin * rotations[:, j]
        return turned
    crossed = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])  # K transposed, as it acts from the left on the columns
    once = crossed @ rotations
    skewed: Floats = rotations + sin * once + (1 - cos) * (crossed @ once)
    return skewed
