"""Closes fingers until their tips meet the thumb's, on whatever hand it is."""

from collections.abc import Sequence

import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side

PLAY = 0.001  # [m] that is left between two tips
LOYALTY = 0.002  # [m] of a gap that counts like a turn through the whole range away from where fingers began
THUMB = "thumb"


def meeting_angles(begun: Floats, meets: Sequence[str], robot: Robot, side: Side) -> Floats:
    """Finds the angles of the finger drives (f,) [rad] at which tips are as near to the thumb's as they come.

    Only thumb and named fingers turn, and as little as needed.

    Args:
        begun: (f,) [rad] where fingers begin.
        meets: fingers whose tips meet the thumb's; those that the hand lacks are left out.
        robot: whose hand it is.
        side: of the hand.
    """
    skeleton, tips = robot.skeleton, robot.finger_tips(side)
    wanted = [finger for finger in meets if finger in tips]
    fingers = robot.arm(side).fingers
    free = [k for k, joint in enumerate(fingers) if _finger(skeleton.names[joint]) in (THUMB, *wanted)]
    joints = [fingers[k] for k in free]
    lower, upper = skeleton.lower[joints], skeleton.upper[joints]
    if THUMB not in tips or not wanted or not joints:
        return begun
    posture, first = np.array(skeleton.rest), np.clip(begun[free], lower, upper)
    posture[list(fingers)] = begun

    def lacks(angles: Floats) -> Floats:
        posture[joints] = angles
        frames = skeleton.frames(posture)
        ends = {
            name: frames.origins[tip.segment] + frames.rotations[tip.segment] @ tip.place for name, tip in tips.items()
        }
        gaps = [
            np.linalg.norm(ends[name] - ends[THUMB]) - tips[name].radius - tips[THUMB].radius - PLAY for name in wanted
        ]
        return np.array([*gaps, *(LOYALTY * (angles - first) / (upper - lower))])

    inner = np.clip(first, lower + 1e-6, upper - 1e-6)
    found = scipy.optimize.least_squares(lacks, inner, bounds=(lower, upper), x_scale=upper - lower, max_nfev=60)
    angles = np.array(begun)
    angles[free] = np.clip(found.x, lower, upper)
    return sealed(angles)


def _finger(hinge: str) -> str:
    return hinge.split("_")[1]
