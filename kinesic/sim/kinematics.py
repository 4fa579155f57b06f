"""Forward kinematics of a whole motion at once: `Skeleton.frames`, laid out so that postures are contiguous."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class MotionFrames:
    """Where every segment is, in the world, in each posture of a motion."""

    rotations: Floats  # (s, 3, 3, m)
    origins: Floats  # (s, 3, m) [m]

    def points(self, segment: int, point: Floats) -> Floats:
        """(3, m) [m] in the world of a point (3,) [m] on a segment."""
        points: Floats = self.origins[segment] + point @ self.rotations[segment]
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
    rotations = np.empty((len(skeleton.segments), 3, 3, count))
    origins = np.empty((len(skeleton.segments), 3, count))
    for k, segment in enumerate(skeleton.segments):
        if segment.parent is None:
            rotation = np.repeat(np.eye(3)[:, :, None], count, axis=2)
            origins[k] = segment.origin_in_parent[:, None]
        else:
            parent = skeleton.segment(segment.parent)
            rotation = rotations[parent]
            origins[k] = origins[parent] + segment.origin_in_parent @ rotation
        for joint in skeleton.joints_of((segment.name,)):
            rotation = _turned(rotation, skeleton.hinges[joint].axis, angles[:, joint])
        rotations[k] = rotation
    return MotionFrames(rotations, origins)


def _turned(rotations: Floats, axis: Floats, angles: Floats) -> Floats:
    """R (I + sin K + (1 - cos) K^2) with the axis' cross product matrix K: Rodrigues' formula."""
    x, y, z = axis
    crossed = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])  # K transposed, as it acts from the left on the columns
    once = crossed @ rotations
    turned: Floats = rotations + np.sin(angles) * once + (1 - np.cos(angles)) * (crossed @ once)
    return turned
