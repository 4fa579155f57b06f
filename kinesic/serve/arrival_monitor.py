"""Measures by sensors when the body arrives where a sync point has it.

By the rule of reports, on hinges: a behaviour's hinges arrive when they first enter a ball about their planned posture.
The plan is judged by the same rule, and the sync point counts as met by as much later as the body entered the ball.
"""

from collections import deque

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.command import RATE
from kinesic.controller.arrival import entry
from kinesic.motion.trajectory import Trajectory

WINDOW = 0.3  # [s] before a sync point in which the ball is entered
KEPT = 1.0  # [s] of what was measured
LEAST_BALL = np.radians(0.5)  # [rad]
SHARE = 0.05  # of the way in the window
LEAST_WAY = np.radians(2.0)  # [rad] in the window, below which nothing is measured


class ArrivalMonitor:
    """Measures how late a body arrives, by its last angles."""

    def __init__(self) -> None:
        """Begins without measurements."""
        self._times: deque[float] = deque()
        self._angles: deque[Floats] = deque()

    def add(self, time: float, angles: Floats) -> None:
        """Adds a measurement.

        Args:
            time: [s] of the clock, later than those before; else it is passed over, as are those without a number.
            angles: (n,) [rad].
        """
        if (self._times and time <= self._times[-1]) or not np.isfinite(angles).all():
            return
        self._times.append(time)
        self._angles.append(angles)
        while self._times[0] < time - KEPT:
            self._times.popleft()
            self._angles.popleft()

    def lateness(self, time: float, hinges: Flags, motion: Trajectory) -> float | None:
        """Finds by how much later [s] than planned some hinges arrive where they are to be at a time [s] of the clock.

        Returns:
            None while they have not arrived; NaN where they hardly move, so that nothing can be said.
        """
        begin = time - WINDOW
        instants = begin + np.arange(round(WINDOW * RATE) + 1) / RATE
        planned = motion.sample(instants)[0][:, hinges]
        way = float(np.linalg.norm(np.diff(planned, axis=0), axis=1).sum())
        radius = max(LEAST_BALL, SHARE * way)
        due = entry(instants.tolist(), np.linalg.norm(planned - planned[-1], axis=1), radius, last=True)
        if way < LEAST_WAY or due is None or due == instants[0]:
            return float("nan")
        lately = [k for k, at in enumerate(self._times) if at >= begin]
        if not lately:
            return None
        seen = np.array([self._angles[k][hinges] for k in lately])
        distances = np.linalg.norm(seen - planned[-1], axis=1)
        came = entry([self._times[k] for k in lately], distances, radius, last=True)
        return None if came is None else came - due
