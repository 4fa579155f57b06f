"""Transfer of the robot's head rotation to the drawn head."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.rotation import rotation_about, rotation_to_vector
from kinesic.face.render.camera import HEAD_CENTRE, compute_head_rotation

NECK_CHAIN = "neck"
NECK_TOP = -0.09  # [m] height of the upper end of the bending neck, relative to the eyes
NECK_BOTTOM = -0.19  # [m] height of the lower end of the bending neck, relative to the eyes
MIN_TURN = 1e-6  # [rad] smaller head rotations are ignored


def compute_head_turns(robot: Robot, angles: Floats) -> Floats:
    """Return the head rotation of a robot in the form of `Camera.turn`.

    Args:
        robot: robot; one without a neck holds its head still.
        angles: (..., n) [rad] in joint order.

    Returns:
        (..., 3) [rad] to its left, up, and over to its right, relative to upright in the world.
    """
    if not robot.joints(NECK_CHAIN):
        return np.zeros((*np.shape(angles)[:-1], 3))
    head = robot.skeleton.segment(robot.chains[NECK_CHAIN][-1])
    stands = robot.skeleton.frames(angles).rotations[..., head, :, :]
    left = np.arctan2(stands[..., 1, 0], stands[..., 0, 0])
    up = np.arcsin(np.clip(stands[..., 2, 0], -1.0, 1.0))
    over = np.arctan2(stands[..., 2, 1], stands[..., 2, 2])
    return np.stack([left, up, over], axis=-1)


def keep_shoulders_still(rest: Floats, positions: Floats, turn: tuple[float, float, float]) -> Floats:
    """Keep the shoulders in place while the head turns, bending the neck.

    Args:
        rest: (v, 3) [m] positions at rest.
        positions: (v, 3) [m] in the frame of the head, which a camera turns as a whole.
        turn: head rotation as in `Camera.turn`.
    """
    spun = rotation_to_vector(compute_head_rotation(*turn))
    angle = float(np.linalg.norm(spun))
    if angle < MIN_TURN:
        return positions
    weight = np.clip((NECK_TOP - rest[:, 2]) / (NECK_TOP - NECK_BOTTOM), 0.0, 1.0)
    moved = weight > 0.0
    back = rotation_about(spun / angle, -angle * (weight * weight * (3.0 - 2.0 * weight))[moved])
    bent, pivot = positions.copy(), np.array(HEAD_CENTRE)
    bent[moved] = pivot + np.einsum("vij,vj->vi", back, positions[moved] - pivot)
    return bent
