"""Posture courses of crossing hands."""

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.motion.keys import KeyPosture
from kinesic.planning.posture_course import PostureCourse
from kinesic.sim.distances import CapsuleDistances

from ..performances import LIMITS, ROBOT

CAPSULE_DISTANCES = CapsuleDistances(ROBOT)  # self-distances of the robot
REST_ANGLES = ROBOT.skeleton.rest  # (n,) [rad] rest posture
LEFT_JOINTS = list(ROBOT.joints("l_arm"))  # hinge indices of the left arm
RIGHT_JOINTS = list(ROBOT.joints("r_arm"))  # hinge indices of the right arm
MIN_CLEARANCE = 0.014  # [m] required clearance of the tested courses
ARM_IN_FRONT = np.radians([0, 40, -15, -50, 70, 0, 0, 0])  # [rad] arm angles with the hand in front of the body
ARM_RAISED = np.radians([0, 75, -15, -50, 70, 0, 0, 0])  # [rad] arm angles with a higher hand


def key(time, left=None, right=None):
    """Return a key of given arms, or of all hinges at rest."""
    angles, keyed = REST_ANGLES.copy(), np.full(len(REST_ANGLES), left is None and right is None)
    for arm, given in ((LEFT_JOINTS, left), (RIGHT_JOINTS, right)):
        if given is not None:
            angles[arm], keyed[arm] = given, True
    return KeyPosture(time, sealed(angles), tuple(bool(one) for one in keyed))


def course(*keys):
    return PostureCourse(keys, sealed([posture.time for posture in keys]), ROBOT, LIMITS)


CROSSING_COURSE = course(  # left hand, then right hand in front of the body
    key(0.0),
    key(1.0, left=ARM_IN_FRONT, right=REST_ANGLES[RIGHT_JOINTS]),
    key(2.0, left=REST_ANGLES[LEFT_JOINTS], right=ARM_IN_FRONT),
    key(3.0),
)


def least(made):
    times = np.arange(0.0, made.motion.duration, 0.005)
    return CAPSULE_DISTANCES.clearance(made.motion.sample(times)[0]).distances.min()
