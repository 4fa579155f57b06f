"""Clearance watch of real servos, using positions read from the bus.

It runs in the planner's process, so that no bus cycle waits for it, and requests a time scale from the supervisor. Each
angle is compared with the plan at the performance time of its measurement. Old, missing and repeated readings are
ignored.
"""

from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Iterable

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command
from kinesic.body.dynamics import Distances
from kinesic.controller.watch.clearance import ClearanceWatch, look_ahead, lookahead_times
from kinesic.hardware.supervisor.channel import Status
from kinesic.metrics.clearance_forecast import LOOK_PERIOD

MAX_STORED_CYCLES = 100  # number of bus cycles with stored times: 1 s, longer than `MAX_READING_AGE`
MIN_LOOK_INTERVAL = 0.9 * LOOK_PERIOD  # [s] shortest time between clearance checks; tolerates bus jitter
POSTURE_MEMORY = 3.0  # [s] duration of stored commanded postures, longer than `MAX_READING_AGE`
TRIM_COUNT = 100  # number of outdated commands above which all outdated commands are deleted
MAX_READING_AGE = 2 * LOOK_PERIOD  # [s] age above which a position reading is ignored


class WrittenPostures:
    """Interpolator of recently commanded postures over performance time."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._angles: list[Floats] = []

    def add(self, command: Command) -> None:
        """Add a command, replacing stored commands with the same or later times."""
        first = bisect_left(self._times, command.time)
        old = bisect_left(self._times, command.time - POSTURE_MEMORY)
        self._times[first:], self._angles[first:] = [command.time], [command.angles]
        if old > TRIM_COUNT:
            del self._times[:old], self._angles[:old]

    def __call__(self, times: Floats) -> Floats:
        """Interpolate commanded postures (k, n) [rad] at times (k,) [s].

        Outside the stored times, the first or last posture is held.
        """
        stored_times, angles = np.array(self._times), np.array(self._angles)
        columns = [np.interp(times, stored_times, column) for column in angles.T]
        return np.stack(columns, axis=1)


class ServoWatch:
    """Clearance watch of one robot's servos."""

    def __init__(self, reference: Callable[[Floats], Floats], distances: Distances, *, min_clearance: float) -> None:
        """Create the watch, before any servo status has arrived.

        Args:
            reference: returns planned postures (k, n) [rad] at performance times (k,) [s], also beyond the end.
            distances: of the robot.
            min_clearance: [m] required clearance of the robot.
        """
        self._reference, self._distances, self._min_clearance = reference, distances, min_clearance
        self._clocks: deque[float] = deque(maxlen=MAX_STORED_CYCLES)  # [s] clock of each cycle
        self._times: deque[float] = deque(maxlen=MAX_STORED_CYCLES)  # [s] performance time of each cycle
        self._errors = self._taken = np.zeros(0)  # (n,) [rad] error and [s] measurement time; empty at first
        self._looked = -np.inf  # [s] clock of the last evaluation
        self.watch = ClearanceWatch()

    def ingest(self, statuses: Iterable[Status]) -> bool:
        """Ingest new servo statuses and return whether `pace` was updated."""
        is_updated = False
        for status in statuses:
            if status.stage.runs and np.isfinite(status.time):
                self._note(status)
                if status.clock - self._looked >= MIN_LOOK_INTERVAL:
                    self._looked, is_updated = status.clock, True
                    self._look(status)
            elif self._times:
                self._forget()
                is_updated = True
        return is_updated

    @property
    def pace(self) -> float:
        """Allowed time scale in [0, 1]."""
        return self.watch.pace

    @property
    def over(self) -> bool:
        """Whether the servos must stop."""
        return self.watch.over

    def _note(self, status: Status) -> None:
        """Update the tracking errors from the position readings of a servo status."""
        if not len(self._taken):
            self._errors, self._taken = np.full(len(status.angles), np.nan), np.full(len(status.angles), -np.inf)
        self._clocks.append(status.clock)
        self._times.append(status.time)
        fresh = np.isfinite(status.angles) & (status.taken > self._taken)  # False for NaN
        if fresh.any():
            taken = status.taken[fresh]
            moments, places = np.unique(self._time_of(taken), return_inverse=True)
            planned = self._reference(moments)[places, np.flatnonzero(fresh)]
            self._errors[fresh] = status.angles[fresh] - planned
            self._taken = np.where(fresh, status.taken, self._taken)

    def _time_of(self, clocks: Floats) -> Floats:
        """Convert clock times [s] to performance times, (k,) [s]."""
        return np.interp(clocks, self._clocks, self._times)

    def _look(self, status: Status) -> None:
        tracking_error = np.where(status.clock - self._taken <= MAX_READING_AGE, self._errors, np.nan)
        coming = self._reference(lookahead_times(status.time, np.inf))
        self.watch = look_ahead(
            self.watch, coming, sealed(tracking_error), self._distances, min_clearance=self._min_clearance
        )

    def _forget(self) -> None:
        """Discard all tracking errors once the servos stop performing.

        They say nothing about the coming motion.
        """
        self._clocks.clear()
        self._times.clear()
        self._errors = self._taken = np.zeros(0)
        self._looked, self.watch = -np.inf, ClearanceWatch()
