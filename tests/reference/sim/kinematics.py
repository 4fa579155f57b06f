"""Forward kinematics of a whole motion by Rodrigues' formula."""

import numpy as np

from kinesic.body.skeleton import Skeleton
from kinesic.sim.kinematics import MotionFrames


def compute_motion_frames(skeleton: Skeleton, angles, *, only=None) -> MotionFrames:
    """Return segment frames in postures (m, n) [rad]."""
    count, turns = len(angles), skeleton.with_couplings(angles)
    rotations = np.empty((len(skeleton.segments), 3, 3, count))
    origins = np.empty((len(skeleton.segments), 3, count))
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


def _turned(rotations, axis, angles):
    """Rotate frames about an axis by Rodrigues' formula."""
    sin, cos = np.sin(angles), np.cos(angles)
    x, y, z = axis.tolist()
    if [x, y, z].count(0.0) == 2:  # two columns rotate in their plane
        j, k = (1, 2) if x else (2, 0) if y else (0, 1)
        sin *= x + y + z
        turned = rotations.copy()
        turned[:, j] = cos * rotations[:, j] + sin * rotations[:, k]
        turned[:, k] = cos * rotations[:, k] - sin * rotations[:, j]
        return turned
    crossed = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])  # K transposed, as it acts from the left on the columns
    once = crossed @ rotations
    return rotations + sin * once + (1 - cos) * (crossed @ once)
