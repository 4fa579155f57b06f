"""Posture courses of crossing hands."""

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.motion.keys import KeyPosture
from kinesic.planning.posture_course import PostureCourse
from kinesic.sim.distances import CapsuleDistances

from ..performances import LIMITS, ROBOT

DISTANCES = CapsuleDistances(ROBOT)


REST = ROBOT.skeleton.rest


LEFT, RIGHT = (list(ROBOT.joints(f"{side}_arm")) for side in ("l", "r"))


MIN_CLEARANCE = 0.014


IN_FRONT = np.radians([0, 40, -15, -50, 70, 0, 0, 0])


HIGHER = np.radians([0, 75, -15, -50, 70, 0, 0, 0])


def key(time, left=None, right=None):
    """Return a key of the given arms, or of all hinges at rest."""
    angles, keyed = REST.copy(), np.full(len(REST), left is None and right is None)
    for arm, given in ((LEFT, left), (RIGHT, right)):
        if given is not None:
            angles[arm], keyed[arm] = given, True
    return KeyPosture(time, sealed(angles), tuple(bool(one) for one in keyed))


def course(*keys):
    return PostureCourse(keys, sealed([posture.time for posture in keys]), ROBOT, LIMITS)


CROSSING = course(
    key(0.0),
    key(1.0, left=IN_FRONT, right=REST[RIGHT]),
    key(2.0, left=REST[LEFT], right=IN_FRONT),
    key(3.0),
)


def least(made):
    times = np.arange(0.0, made.motion.duration, 0.005)
    return DISTANCES.clearance(made.motion.sample(times)[0]).distances.min()
