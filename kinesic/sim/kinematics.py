"""Forward kinematics of a whole motion at once: `Skeleton.frames` for many postures."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class MotionFrames:
    """Where every segment is, in the world, in each posture of a motion."""

    rotations: Floats  # (s, m, 3, 3)
    origins: Floats  # (s, m, 3) [m]

    def points(self, segment: int, point: Floats) -> Floats:
        """(m, 3) [m] in the world of a point (3,) [m] on a segment."""
        points: Floats = self.origins[segment] + self.rotations[segment] @ point
        return points


def motion_frames(skeleton: Skeleton, angles: Floats) -> MotionFrames:
    """Forward kinematics, one hinge at a time over all postures.

    Args:
        skeleton: the robot.
        angles: (m, n) [rad] in joint order.

    Returns:
        Rotation and origin of each segment in the world.
    """
    count = len(angles)
    rotations = np.empty((len(skeleton.segments), count, 3, 3))
    origins = np.empty((len(skeleton.segments), count, 3))
    for k, segment in enumerate(skeleton.segments):
        if segment.parent is None:
            rotation = np.broadcast_to(np.eye(3), (count, 3, 3))
            origins[k] = segment.origin_in_parent
        else:
            parent = skeleton.segment(segment.parent)
            rotation = rotations[parent]
            origins[k] = origins[parent] + rotation @ segment.origin_in_parent
        for joint in skeleton.joints_of((segment.name,)):
            rotation = _turned(rotation, skeleton.hinges[joint].axis, angles[:, joint])
        rotations[k] = rotation
    return MotionFrames(rotations, origins)


def _turned(rotations: Floats, axis: Floats, angles: Floats) -> Floats:
    """R (I + sin K + (1 - cos) K^2) with the axis' cross product matrix K: Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    once = (rotations.reshape(-1, 3) @ cross).reshape(rotations.shape)
    twice = (once.reshape(-1, 3) @ cross).reshape(rotations.shape)
    turned: Floats = rotations + np.sin(angles)[:, None, None] * once + (1 - np.cos(angles))[:, None, None] * twice
    return turned
