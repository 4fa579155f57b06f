"""Buffer of future setpoints with smooth interpolation."""

from bisect import bisect_right
from collections import deque
from math import inf

import numpy as np

from kinesic.body.arrays import Floats

KEPT_COMMANDS = 2  # Past commands kept to compute the slopes of the setpoint curve


class GoalBuffer:
    """Buffer of setpoints by performance time, with smooth interpolation.

    Past setpoints are dropped. The others are interpolated by a cubic Hermite spline whose slope at a command is that
    of the chord between its neighbours: the curve passes every setpoint, and its velocity is continuous.
    """

    def __init__(self) -> None:
        self._times: deque[float] = deque()
        self._goals: deque[Floats] = deque()
        self._leads: deque[Floats] = deque()

    @property
    def begin(self) -> float:
        """Time [s] of the first setpoints.

        Infinite without any.
        """
        return self._times[0] if self._times else inf

    @property
    def end(self) -> float:
        """Time [s] of the last setpoints.

        Minus infinity without any.
        """
        return self._times[-1] if self._times else -inf

    def __len__(self) -> int:
        return len(self._times)

    def add(self, time: float, goals: Floats, leads: Floats | None = None) -> None:
        """Add a command, replacing commands at the same or later times.

        Args:
            time: [s].
            goals: (n,) [rad] setpoints.
            leads: (n,) [rad] feed-forward of the planned velocity in them; None: zero.
        """
        while self._times and time <= self._times[-1]:
            self._times.pop()
            self._goals.pop()
            self._leads.pop()
        self._times.append(time)
        self._goals.append(goals)
        self._leads.append(np.zeros_like(goals) if leads is None else leads)

    def forget(self, time: float) -> None:
        """Drop past commands not needed to interpolate from a time [s] on."""
        while len(self._times) > KEPT_COMMANDS and self._times[KEPT_COMMANDS] <= time:
            self._times.popleft()
            self._goals.popleft()
            self._leads.popleft()

    def at(self, time: float) -> Floats:
        """Return the setpoints (n,) [rad] at a time [s].

        Outside the buffered times, they are the first or the last ones.

        Raises:
            LookupError: the buffer is empty.
        """
        times, goals = self._times, self._goals
        if not times:
            raise LookupError("the buffer has no setpoints")
        if time <= times[0]:
            return goals[0]
        if time >= times[-1]:
            return goals[-1]
        after = bisect_right(times, time)
        before = after - 1
        span = times[after] - times[before]
        u = (time - times[before]) / span
        start, end = self._slope(before) * span, self._slope(after) * span
        travel = goals[after] - goals[before]
        curve: Floats = goals[before] + u * (
            start + u * (3 * travel - 2 * start - end + u * (start + end - 2 * travel))
        )
        return curve

    def at_scale(self, time: float, scale: float) -> Floats:
        """Return setpoints (n,) [rad] at a time [s] in slowed motion.

        The velocity feed-forward shrinks with the time scale, 0..1.

        Raises:
            LookupError: the buffer is empty.
        """
        goals = self.at(time)
        if scale >= 1.0:
            return goals
        times, leads = self._times, self._leads
        after = min(bisect_right(times, time), len(times) - 1)
        before = max(after - 1, 0)
        span = times[after] - times[before]
        u = min(1.0, max(0.0, (time - times[before]) / span)) if span > 0.0 else 0.0
        slower: Floats = goals - (1.0 - scale) * (leads[before] + u * (leads[after] - leads[before]))
        return slower

    def _slope(self, k: int) -> Floats:
        """Estimate the setpoints' velocity (n,) [rad/s] at a command."""
        low, high = max(k - 1, 0), min(k + 1, len(self._times) - 1)
        slope: Floats = (self._goals[high] - self._goals[low]) / (self._times[high] - self._times[low])
        return slope
