"""Offsets of one hinge of a still robot."""

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import stay
from kinesic.planning.secondary.offset_bumps import OffsetBump

ROBOT = Robot.load()
REST = ROBOT.skeleton.rest
TILT = ROBOT.skeleton.names.index("vl5_tilt")
STILL = stay(REST, 5.0)


def swell(begin, peak, end, *, degrees=1.0, hinge=TILT):
    away = np.zeros(len(REST))
    away[hinge] = np.radians(degrees)
    return OffsetBump(begin, peak, end, sealed(away))
