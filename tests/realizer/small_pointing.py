"""Small motions and occupancies of a pointing arm, made by hand."""

import numpy as np

from kinesic.motion.trajectory import Trajectory
from kinesic.realizer.occupancy import Occupancy

HINGE_COUNT = 22
ARM = 9  # index of a hinge of the right arm
NO_HINGES = np.zeros(HINGE_COUNT, dtype=np.bool_)
START = 50.0  # [s] clock time at which the running motion starts
TOLERANCE = np.radians(2.0)  # [rad] accepted increase of the pointing error


def motion(count: int = 100, *, angle: float = 0.0, start: float = 0.0) -> Trajectory:
    return Trajectory(np.full((count, HINGE_COUNT), angle), 0.25, start)


def use(id: str = "p", *roles: str, begin=0.2, ready=0.4, relax=0.6, end=0.8) -> Occupancy:
    return Occupancy(id, frozenset(roles or ("r_hand",)), NO_HINGES, begin, ready, relax, end)
