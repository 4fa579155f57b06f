"""Turns the drawn head as the robot's neck and trunk turn its own."""

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.body.rotation import about
from kinesic.face.render.camera import PIVOT, head_rotation

NECK = "neck"
HEAD_ENDS, SHOULDERS_BEGIN = -0.09, -0.19  # [m] up from the eyes: the neck lies between
NO_TURN = 1e-6  # [rad]


def turns(robot: Robot, angles: Floats) -> Floats:
    """Gives how a robot's head is turned, as `Camera.turn` has it.

    Args:
        robot: whose head it is; one without a neck holds it still.
        angles: (..., n) [rad] in joint order.

    Returns:
        (..., 3) [rad] to its left, up, and over to its right, away from upright in the world.
    """
    if not robot.joints(NECK):
        return np.zeros((*np.shape(angles)[:-1], 3))
    head = robot.skeleton.segment(robot.chains[NECK][-1])
    stands = robot.skeleton.frames(angles).rotations[..., head, :, :]
    left = np.arctan2(stands[..., 1, 0], stands[..., 0, 0])
    up = np.arcsin(np.clip(stands[..., 2, 0], -1.0, 1.0))
    over = np.arctan2(stands[..., 2, 1], stands[..., 2, 2])
    return np.stack([left, up, over], axis=-1)


def steady_shoulders(rest: Floats, positions: Floats, turn: tuple[float, float, float]) -> Floats:
    """Leaves the shoulders where they are while the head turns, and bends the neck between.

    Args:
        rest: (v, 3) [m] the head at rest.
        positions: (v, 3) [m] in the frame of the head, which a camera turns as a whole.
        turn: of the head, as `Camera.turn` has it.
    """
    angle = float(
        np.linalg.norm(spun := scipy.spatial.transform.Rotation.from_matrix(head_rotation(*turn)).as_rotvec())
    )
    if angle < NO_TURN:
        return positions
    share = np.clip((HEAD_ENDS - rest[:, 2]) / (HEAD_ENDS - SHOULDERS_BEGIN), 0.0, 1.0)
    moved = share > 0.0
    back = about(spun / angle, -angle * (share * share * (3.0 - 2.0 * share))[moved])
    found, pivot = positions.copy(), np.array(PIVOT)
    found[moved] = pivot + np.einsum("vij,vj->vi", back, positions[moved] - pivot)
    return found
