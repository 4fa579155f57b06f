"""Trunk rotations that follow the hands of a gesture.

A linear model turns the displacement of the hands from rest into a rotation: the trunk turns where the hands go and
brings the shoulder of the more forward hand to the front. Its torsion was fitted to the clips of one captured actor and
explains 44 % of the torsion of another one, who was left out; the lean is a rule, as captured leans do not agree.
"""

from collections.abc import Mapping
from math import radians

import numpy as np

from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.hands.phases import ARM_PARTS
from kinesic.expressivity.hands.poses import Poses
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import UPRIGHT_TURN, scale_turn, turn_angles

TORSION_PER_FORWARD = radians(8.0)  # [rad] trunk torsion per arm length by which one hand is ahead of the other
TORSION_PER_LEFT = radians(13.0)  # [rad] trunk torsion per arm length to the left, summed over the hands
TILT_PER_FORWARD = radians(7.0)  # [rad] trunk lean per arm length that the hands move forward on average
ROLL_PER_TORSION = 0.1  # trunk roll / trunk torsion in captured gestures
MAX_FOLLOWING_ANGLE = radians(6.0)  # [rad] largest trunk rotation about each axis at style weight 1
TOUCH_FRACTION = 0.3  # fraction of the trunk rotation while a hand touches head or trunk
HEAD_TO_TRUNK_TORSION = 1.3  # head torsion / trunk torsion, both in the world
HEAD_ROLL_PER_TORSION = 0.4  # head roll / trunk torsion, both to the same side
HEAD_NOD_GAIN = 0.4  # relative increase of a nod while the trunk follows the hands


def follow_hands(poses: Poses, key: int, rest: Mapping[Side, Reach], robot: Robot) -> Turn:
    """Return the trunk rotation that follows the hands at a key.

    Args:
        poses: of the gesture, with the weight of the rotation.
        key: index of the stroke key.
        rest: hands at rest.
        robot: with the arms.
    """
    weight = poses.body.along
    reaches = {side: row[key].reach for side, row in poses.hands.items()}
    moved = {
        side: (reach.position - rest[side].position) / robot.arm_length
        for side, reach in reaches.items()
        if reach is not None
    }
    if not moved or weight == 0.0 or poses.body.towards > 0.0:  # a pointing trunk turns to its target
        return UPRIGHT_TURN
    forward = {side: float(displacement[0]) for side, displacement in moved.items()}
    left = sum(float(displacement[1]) for displacement in moved.values())
    ahead = forward.get("r", 0.0) - forward.get("l", 0.0)
    torsion = TORSION_PER_FORWARD * ahead + TORSION_PER_LEFT * left
    turn = Turn(torsion, TILT_PER_FORWARD * float(np.mean([*forward.values()])), ROLL_PER_TORSION * torsion)
    touched = {row[poses.stroke].touch for row in poses.hands.values()} - {None}
    if touched:
        turn = scale_turn(turn, 0.0 if touched & ARM_PARTS else TOUCH_FRACTION)
    return Turn(*(weight * min(max(angle, -MAX_FOLLOWING_ANGLE), MAX_FOLLOWING_ANGLE) for angle in turn_angles(turn)))


def turn_head_along(trunk: Turn) -> Turn:
    """Return the head rotation for a trunk that follows the hands."""
    return Turn(torsion=HEAD_TO_TRUNK_TORSION * trunk.torsion, roll=-HEAD_ROLL_PER_TORSION * trunk.torsion)
