"""Finger angles at which fingertips meet the tip of the thumb."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.least_squares import minimise_squares
from kinesic.body.robot import Robot, Side

TIP_GAP = 0.001  # [m] gap left between two meeting fingertips
DEVIATION_COST = 0.002  # [m] fingertip gap that costs as much as rotating a joint through the joint's whole range
MAX_EVALUATIONS = 60  # largest number of postures that are evaluated for one hand
THUMB_NAME = "thumb"  # name of the finger that other fingertips meet


def meeting_angles(initial: Floats, meets: Sequence[str], robot: Robot, side: Side) -> Floats:
    """Find finger angles that bring fingertips closest to the thumb tip.

    Only the thumb and the named fingers turn, and as little as needed.

    Args:
        initial: angles (f,) [rad].
        meets: fingers whose tips meet the thumb's tip; those that the hand lacks are ignored.
        robot: that has the hand.
        side: of the hand.
    """
    skeleton, tips = robot.skeleton, robot.finger_tips(side)
    meeting_fingers = [finger for finger in meets if finger in tips]
    fingers = robot.arm(side).fingers
    free = [k for k, joint in enumerate(fingers) if _finger(skeleton.names[joint]) in (THUMB_NAME, *meeting_fingers)]
    joints = [fingers[k] for k in free]
    lower, upper = skeleton.lower[joints], skeleton.upper[joints]
    if THUMB_NAME not in tips or not meeting_fingers or not joints:
        return initial
    posture, start = np.array(skeleton.rest), np.clip(initial[free], lower, upper)
    posture[list(fingers)] = initial

    def residuals(angles: Floats) -> Floats:
        posture[joints] = angles
        frames = skeleton.frames(posture)
        ends = {
            name: frames.origins[tip.segment] + frames.rotations[tip.segment] @ tip.place for name, tip in tips.items()
        }
        gaps = [
            np.linalg.norm(ends[name] - ends[THUMB_NAME]) - tips[name].radius - tips[THUMB_NAME].radius - TIP_GAP
            for name in meeting_fingers
        ]
        return np.array([*gaps, *(DEVIATION_COST * (angles - start) / (upper - lower))])

    solution = minimise_squares(residuals, start, bounds=(lower, upper), max_evaluations=MAX_EVALUATIONS)
    angles = np.array(initial)
    angles[free] = solution.values
    return sealed(angles)


def _finger(joint_name: str) -> str:
    return joint_name.split("_")[1]
