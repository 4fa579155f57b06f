"""Forward kinematics of many postures at once.

Arrays are laid out so that postures are contiguous, unlike those of `Skeleton.frames`.
"""

from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic._kernel import sim as kernel
from kinesic.body.arrays import Floats, Indices
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class MotionFrames:
    """Rotation and origin of each segment in all postures of a motion.

    They are in the world's frame.
    """

    rotations: Floats  # (s, 3, 3, m)
    origins: Floats  # (s, 3, m) [m]

    def axes(self, segments: list[int], starts: Floats, ends: Floats) -> tuple[Floats, Floats]:
        """Transform the end points of line segments into the world.

        Args:
            segments: Index of the segment to which each line is fixed.
            starts: (c, 3) [m] in these segments.
            ends: (c, 3) [m] in these segments.

        Returns:
            Starts and ends, each (c, 3, m) [m].
        """
        origins, rotations = self.origins[segments], self.rotations[segments]
        first, last = (origins + (side[:, None, None, :] @ rotations)[:, :, 0, :] for side in (starts, ends))
        return first, last

    def at(self, postures: Indices) -> "MotionFrames":
        """Return the segment frames in selected postures."""
        return MotionFrames(self.rotations[..., postures], self.origins[..., postures])


def body_frames(robot: Robot, angles: Floats) -> MotionFrames:
    """Compute the coordinate frames of all segments except fingers.

    Args:
        robot: Description.
        angles: (m, n) [rad].
    """
    fingers = robot.finger_segments
    others = set(range(len(robot.skeleton.segments))) - fingers
    return compute_motion_frames(robot.skeleton, angles, only=others if fingers else None)


def compute_motion_frames(
    skeleton: Skeleton, angles: Floats, *, only: Collection[int] | None = None, given: MotionFrames | None = None
) -> MotionFrames:
    """Compute the forward kinematics of all postures, one hinge at a time.

    Args:
        skeleton: Skeleton of the robot.
        angles: (m, n) [rad] in joint order.
        only: Segments to compute, each with its parent unless the parent's frame is given; None: all.
        given: Frames of other segments in the same postures.

    Returns:
        Rotation and origin of each segment in the world. Segments that are neither computed nor given have arbitrary
        values.
    """
    count, turns = len(angles), skeleton.with_couplings(angles)
    rotations = np.empty((len(skeleton.segments), 3, 3, count)) if given is None else given.rotations.copy()
    origins = np.empty((len(skeleton.segments), 3, count)) if given is None else given.origins.copy()
    chosen = np.array([only is None or k in only for k in range(len(skeleton.segments))])
    turned_angles = np.ascontiguousarray(turns.T)
    compile_frames(skeleton).solve(chosen, np.sin(turned_angles), np.cos(turned_angles), rotations, origins)
    return MotionFrames(rotations, origins)


@lru_cache(maxsize=16)
def compile_frames(skeleton: Skeleton) -> kernel.MotionFrames:
    """Pack a skeleton for the kernel, once per skeleton."""
    frames = kernel.MotionFrames()
    for parent, origin, hinges in skeleton.steps:
        joints = [joint for joint, _ in hinges]
        offsets = np.array([np.zeros(3) if at is None else at for _, at in hinges])
        frames.add_link(parent, np.ascontiguousarray(origin), joints, skeleton.axes[joints], offsets)
    return frames
