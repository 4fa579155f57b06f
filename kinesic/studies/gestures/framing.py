"""What is seen of a robot that makes a gesture: as little as all of its moving parts need."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import cos, radians, sin, tan

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.studies.gestures.silhouette import PenStroke

EDGE = 0.03  # of the least picture, on each side
FIELD = 24.0  # [deg] of view, upright
RISE = 5.0  # [deg] from which the camera looks down, where it can


@dataclass(frozen=True)
class OutlineWindow:
    """A part of the plane that outlines are drawn in, with the robot's middle in its own."""

    wide: float  # [m]
    low: float  # [m]
    tall: float  # [m]

    @classmethod
    def around(cls, lines: Iterable[PenStroke]) -> "OutlineWindow":
        """The least that shows all of some lines."""
        points = [(line.points, line.width / 2) for line in lines]
        half = max(float(np.abs(places[:, 0]).max()) + edge for places, edge in points)
        low = min(float(places[:, 1].min()) - edge for places, edge in points)
        high = max(float(places[:, 1].max()) + edge for places, edge in points)
        margin = EDGE * (high - low)
        return cls(2 * (half + margin), low - margin, high - low + 2 * margin)


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """From where a robot is looked at."""

    middle: Floats  # (3,) [m] what is looked at, in the world
    distance: float  # [m] from it
    yaw_deg: float = 0.0  # 0 is from the front, 90 shows its left side
    rise_deg: float = 0.0  # how far above the middle the camera is
    field_deg: float = FIELD  # of view, upright

    def axes(self) -> Floats:
        """(3, 3) unit vectors as columns: to the right of the picture, up in it, and towards the viewer."""
        yaw, rise = radians(self.yaw_deg), radians(self.rise_deg)
        right = np.array([-sin(yaw), cos(yaw), 0.0])
        towards = np.array([cos(rise) * cos(yaw), cos(rise) * sin(yaw), sin(rise)])
        return np.stack([right, np.cross(towards, right), towards], axis=1)

    def project(self, points: Floats) -> Floats:
        """Projects (..., 3) points to (..., 2) shares of the picture's height, right of its middle and above it."""
        seen = (points - self.middle) @ self.axes()
        depth = (self.distance - seen[..., 2:]) * 2 * tan(radians(self.field_deg) / 2)
        return np.asarray(seen[..., :2] / depth)


@dataclass(frozen=True, eq=False)
class Balls:
    """Places that must be seen, with room about them."""

    centres: Floats  # (k, 3) [m] in the world
    radii: Floats  # (k,) [m]

    @classmethod
    def of(cls, robot: Robot, postures: Sequence[Floats]) -> "Balls":
        """Collects the balls of the segments that move, in some postures (n,) [rad]; of all where none does."""
        moving = [segment.parent is not None and bool(segment.capsules) for segment in robot.skeleton.segments]
        centres, radii = [], []
        for angles in postures:
            frames = robot.skeleton.frames(angles)
            for k, segment in enumerate(robot.skeleton.segments):
                for capsule in segment.capsules if moving[k] or not any(moving) else ():
                    ends = np.stack([capsule.start, capsule.end])
                    centres.append(frames.origins[k] + ends @ frames.rotations[k].T)
                    radii += [capsule.radius] * 2
        return cls(sealed(np.concatenate(centres)), sealed(radii))

    def viewpoints(self, yaws: Sequence[float], aspect: float, *, rise: float) -> list[Viewpoint]:
        """Views of all of them from yaws [deg] with one distance, about one middle.

        Args:
            yaws: [deg] 0 is from the front.
            aspect: of pictures, width to height.
            rise: [deg] of the camera over the middle.
        """
        edges = self.radii[:, None]
        low, high = (self.centres - edges).min(axis=0), (self.centres + edges).max(axis=0)
        middle = sealed((low + high) / 2)
        half, distance = tan(radians(FIELD) / 2), 0.0
        for yaw in yaws:
            seen = (self.centres - middle) @ Viewpoint(middle, 1.0, yaw, rise).axes()
            needed = np.maximum(np.abs(seen[:, 1]) + self.radii, (np.abs(seen[:, 0]) + self.radii) / aspect) / half
            distance = max(distance, float((seen[:, 2] + (1.0 + 2 * EDGE) * needed).max()))
        return [Viewpoint(middle, distance, yaw, rise) for yaw in yaws]
