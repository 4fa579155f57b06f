"""Keeps the goals that are to come, and draws a smooth curve through them."""

from bisect import bisect_right
from collections import deque
from math import inf

import numpy as np

from kinesic.body.arrays import Floats

BEHIND = 2  # commands that are kept before the present one: slopes need them


class GoalBuffer:
    """Goals of commands by performance time, forgotten once they are past.

    Between two commands the curve is a cubic Hermite spline whose slope at a command is that from the one before to
    the one after: it passes every goal, and its speed never jumps.
    """

    def __init__(self) -> None:
        self._times: deque[float] = deque()
        self._goals: deque[Floats] = deque()
        self._leads: deque[Floats] = deque()

    @property
    def begin(self) -> float:
        """[s] of the first goals that are known; infinite if none are."""
        return self._times[0] if self._times else inf

    @property
    def end(self) -> float:
        """[s] of the last ones; minus infinity if there are none."""
        return self._times[-1] if self._times else -inf

    def __len__(self) -> int:
        return len(self._times)

    def add(self, time: float, goals: Floats, leads: Floats | None = None) -> None:
        """Adds a command, which replaces those that are not earlier.

        Args:
            time: [s].
            goals: (n,) [rad].
            leads: (n,) [rad] part of them that carries the planned speed; None: nothing.
        """
        while self._times and time <= self._times[-1]:
            self._times.pop()
            self._goals.pop()
            self._leads.pop()
        self._times.append(time)
        self._goals.append(goals)
        self._leads.append(np.zeros_like(goals) if leads is None else leads)

    def forget(self, time: float) -> None:
        """Drops what is not needed from a time [s] on."""
        while len(self._times) > BEHIND and self._times[BEHIND] <= time:
            self._times.popleft()
            self._goals.popleft()
            self._leads.popleft()

    def at(self, time: float) -> Floats:
        """Returns (n,) [rad] at a time [s]; the first or last goals outside of what is known.

        Raises:
            LookupError: nothing is known at all.
        """
        times, goals = self._times, self._goals
        if not times:
            raise LookupError("no goals are known")
        if time <= times[0]:
            return goals[0]
        if time >= times[-1]:
            return goals[-1]
        after = bisect_right(times, time)
        before = after - 1
        span = times[after] - times[before]
        u = (time - times[before]) / span
        start, end = self._slope(before) * span, self._slope(after) * span
        way = goals[after] - goals[before]
        curve: Floats = goals[before] + u * (start + u * (3 * way - 2 * start - end + u * (start + end - 2 * way)))
        return curve

    def slowed(self, time: float, scale: float) -> Floats:
        """Returns (n,) [rad] at a time [s] that passes at a scale, 0..1: what leads the speed shrinks with it.

        Raises:
            LookupError: nothing is known at all.
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
        """(n,) [rad/s] at a command."""
        low, high = max(k - 1, 0), min(k + 1, len(self._times) - 1)
        slope: Floats = (self._goals[high] - self._goals[low]) / (self._times[high] - self._times[low])
        return slope
