"""Measurement of arrival delays at sync points.

The rule is that of the reports, applied to joints: the joints of a behaviour arrive when they last enter a ball around
their planned posture. The planned motion is judged by the same rule. The delay is the difference between both times.
"""

from collections import deque

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.command import COMMAND_RATE
from kinesic.metrics.arrival import find_entry
from kinesic.motion.trajectory import Trajectory

ARRIVAL_WINDOW = 0.3  # [s] time before a sync point from which the arrival of joints is searched
HISTORY_DURATION = 1.0  # [s] duration of stored measurements
MIN_BALL_RADIUS = np.radians(0.5)  # [rad] smallest radius of the arrival region around the planned posture
BALL_RADIUS_RATIO = 0.05  # radius of the arrival region / joint travel within `ARRIVAL_WINDOW`
MIN_TRAVEL = np.radians(2.0)  # [rad] smallest travel within the window for which arrival is measured


class ArrivalMonitor:
    """Estimator of arrival delays from recently measured joint angles."""

    def __init__(self) -> None:
        """Create a monitor without measurements."""
        self._times: deque[float] = deque()
        self._angles: deque[Floats] = deque()

    def add(self, time: float, angles: Floats) -> None:
        """Add measured joint angles.

        Args:
            time: clock time [s]; the measurement is ignored unless it is later than all earlier ones.
            angles: (n,) [rad]; the measurement is ignored if one is not finite.
        """
        if (self._times and time <= self._times[-1]) or not np.isfinite(angles).all():
            return
        self._times.append(time)
        self._angles.append(angles)
        while self._times[0] < time - HISTORY_DURATION:
            self._times.popleft()
            self._angles.popleft()

    def lateness(self, time: float, hinges: Flags, motion: Trajectory) -> float | None:
        """Return the measured arrival delay [s] of joints at a sync point.

        Args:
            time: planned clock time [s] of the sync point.
            hinges: (n,) hinges that the behaviour moves.
            motion: planned motion.

        Returns:
            None if the hinges have not arrived yet; NaN if they move too little to be judged.
        """
        begin = time - ARRIVAL_WINDOW
        times = begin + np.arange(round(ARRIVAL_WINDOW * COMMAND_RATE) + 1) / COMMAND_RATE
        planned = motion.sample(times)[0][:, hinges]
        travel = float(np.linalg.norm(np.diff(planned, axis=0), axis=1).sum())
        radius = max(MIN_BALL_RADIUS, BALL_RADIUS_RATIO * travel)
        due = find_entry(times.tolist(), np.linalg.norm(planned - planned[-1], axis=1), radius, last=True)
        if travel < MIN_TRAVEL or due is None or due == times[0]:
            return float("nan")
        recent = [k for k, measured_at in enumerate(self._times) if measured_at >= begin]
        if not recent:
            return None
        measured = np.array([self._angles[k][hinges] for k in recent])
        distances = np.linalg.norm(measured - planned[-1], axis=1)
        arrival = find_entry([self._times[k] for k in recent], distances, radius, last=True)
        return None if arrival is None else arrival - due
