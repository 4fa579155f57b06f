"""Kinematic chains from the robot's root to a segment."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Skeleton
from kinesic.ik.scalar3 import IDENTITY_ROTATION, Vector, after, cross, minus, plus, rotated, vector


@dataclass(frozen=True)
class ChainLink:
    """One segment of a kinematic chain, with offset and hinges."""

    offset: Vector  # [m] centre of the segment in the frame of its parent
    hinges: tuple[tuple[int, Vector, Vector], ...]  # index in the robot's joint order, unit axis, point on it [m]


@dataclass(frozen=True)
class Strand:
    """Kinematic chain from the root to a segment.

    Its last hinges are left out if they do not move the segment's centre, unless the chain is whole.
    """

    segments: tuple[ChainLink, ...]

    @property
    def joints(self) -> tuple[int, ...]:
        """Joint indices of the chain's hinges."""
        return tuple(joint for segment in self.segments for joint, _, _ in segment.hinges)

    def end(self, angles: Sequence[float]) -> tuple[Vector, Floats]:
        """Compute the position [m] and Jacobian of the chain's last segment.

        Args:
            angles: (n,) [rad] of the whole robot.

        Returns:
            The end's centre [m] in the world, and (h, 3) [m/rad] its motion with each hinge of `joints`.
        """
        rotation, centre = IDENTITY_ROTATION, (0.0, 0.0, 0.0)
        axes: list[tuple[Vector, Vector]] = []
        for segment in self.segments:
            centre = plus(centre, rotated(rotation, segment.offset))
            for joint, axis, at in segment.hinges:
                pole = plus(centre, rotated(rotation, at))
                axes.append((rotated(rotation, axis), pole))
                rotation = after(rotation, axis, angles[joint])
                centre = minus(pole, rotated(rotation, at))
        return centre, np.array([cross(axis, minus(centre, pole)) for axis, pole in axes])


@lru_cache(maxsize=32)
def strand_to(skeleton: Skeleton, name: str, *, whole: bool = False) -> Strand:
    """Return the kinematic chain from the robot's root to a segment."""
    segments: list[ChainLink] = []
    at: str | None = name
    while at is not None:
        part = skeleton.segments[skeleton.segment(at)]
        moving = whole or at != name
        joints = [joint for joint in skeleton.joints_of((at,)) if moving or skeleton.hinges[joint].at.any()]
        hinges = tuple(
            (joint, vector(skeleton.hinges[joint].axis), vector(skeleton.hinges[joint].at)) for joint in joints
        )
        segments.append(ChainLink(vector(part.origin_in_parent), hinges))
        at = part.parent
    return Strand(tuple(reversed(segments)))
