"""Offsets of one hinge of a still robot."""

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import stay
from kinesic.planning.secondary.offset_bumps import OffsetBump

DEFAULT_ROBOT = Robot.load()
REST_ANGLES = DEFAULT_ROBOT.skeleton.rest  # (n,) [rad] rest posture
TILT_HINGE = DEFAULT_ROBOT.skeleton.names.index("vl5_tilt")  # index of the hinge that tilts the trunk
STILL_MOTION = stay(REST_ANGLES, 5.0)  # motion of 5 s at rest


def swell(begin, peak, end, *, degrees=1.0, hinge=TILT_HINGE):
    away = np.zeros(len(REST_ANGLES))
    away[hinge] = np.radians(degrees)
    return OffsetBump(begin, peak, end, sealed(away))
