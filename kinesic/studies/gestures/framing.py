"""Framing of a robot's gesture: the smallest view of all moving parts."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, radians, sin, tan

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.report.silhouette import VIEW_MARGIN

FIELD_OF_VIEW = 24.0  # [deg] vertical field of view of the camera
CAMERA_ELEVATION = 5.0  # [deg] preferred elevation of the camera


@dataclass(frozen=True, eq=False)
class Viewpoint:
    """Camera of a robot picture: centre, distance and angles."""

    middle: Floats  # (3,) [m] centre of the view, in the world
    distance: float  # [m] from the centre
    yaw_deg: float = 0.0  # 0: from the front, 90: shows the left side
    rise_deg: float = 0.0  # elevation of the camera above the centre
    field_deg: float = FIELD_OF_VIEW  # vertical field of view

    def axes(self) -> Floats:
        """Return the camera's axes (3, 3) as columns.

        Right, up, towards the viewer.
        """
        yaw, rise = radians(self.yaw_deg), radians(self.rise_deg)
        right = np.array([-sin(yaw), cos(yaw), 0.0])
        towards = np.array([cos(rise) * cos(yaw), cos(rise) * sin(yaw), sin(rise)])
        return np.stack([right, np.cross(towards, right), towards], axis=1)

    def project(self, points: Floats) -> Floats:
        """Project points (..., 3) to picture coordinates (..., 2).

        They are relative to the picture's height, to the right of its centre and above it.
        """
        in_camera = (points - self.middle) @ self.axes()
        depth = (self.distance - in_camera[..., 2:]) * 2 * tan(radians(self.field_deg) / 2)
        return np.asarray(in_camera[..., :2] / depth)


@dataclass(frozen=True, eq=False)
class Balls:
    """Bounding balls of moving body segments that pictures must show."""

    centres: Floats  # (k, 3) [m] in the world
    radii: Floats  # (k,) [m]

    @classmethod
    def of(cls, robot: Robot, postures: Sequence[Floats]) -> "Balls":
        """Return the balls around all moving segments in postures (n,) [rad].

        If no segment moves, the balls of all segments are returned.
        """
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
        """Return a viewpoint for each yaw, with common centre and distance.

        Args:
            yaws: angles [deg]; 0 is from the front.
            aspect: width / height of the pictures.
            rise: elevation of the camera [deg].
        """
        edges = self.radii[:, None]
        low, high = (self.centres - edges).min(axis=0), (self.centres + edges).max(axis=0)
        middle = sealed((low + high) / 2)
        half, distance = tan(radians(FIELD_OF_VIEW) / 2), 0.0
        for yaw in yaws:
            in_camera = (self.centres - middle) @ Viewpoint(middle, 1.0, yaw, rise).axes()
            required = (
                np.maximum(np.abs(in_camera[:, 1]) + self.radii, (np.abs(in_camera[:, 0]) + self.radii) / aspect) / half
            )
            distance = max(distance, float((in_camera[:, 2] + (1.0 + 2 * VIEW_MARGIN) * required).max()))
        return [Viewpoint(middle, distance, yaw, rise) for yaw in yaws]
