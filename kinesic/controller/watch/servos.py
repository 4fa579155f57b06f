"""Watches the clearance of real servos: the same look ahead as the twin's, at positions that were read on the wire.

It runs beside the supervisor, in the planner's process, so that no cycle of the wires waits for it, and asks for a
pace. Each angle is compared with the plan at the performance time at which its servo took it; a position that is old,
missing or seen before is not weighed.
"""

from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Iterable

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command
from kinesic.body.dynamics import Distances
from kinesic.controller.watch.clearance import LOOK, ClearanceWatch, coming_times, look_ahead
from kinesic.hardware.supervisor.channel import Status

CYCLES_KEPT = 100  # cycles whose time is remembered: a second, longer than any position is believed
WAIT = 0.9 * LOOK  # [s] since the last look: cycles do not come quite evenly
HELD = 3.0  # [s] for which postures that were written are kept: as long as positions are believed, and to spare
TRIMMED = 100  # commands that are dropped together
FRESH = 2 * LOOK  # [s] until a position is too old to say where the servo strays


class WrittenPostures:
    """The postures of commands that were written of late, as a function of performance time."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._angles: list[Floats] = []

    def add(self, command: Command) -> None:
        """Adds a command, which replaces those that are not earlier."""
        first = bisect_left(self._times, command.time)
        old = bisect_left(self._times, command.time - HELD)
        self._times[first:], self._angles[first:] = [command.time], [command.angles]
        if old > TRIMMED:
            del self._times[:old], self._angles[:old]

    def __call__(self, times: Floats) -> Floats:
        """(k, n) [rad] at times (k,) [s]; the first or last outside of what is known."""
        known, angles = np.array(self._times), np.array(self._angles)
        columns = [np.interp(times, known, column) for column in angles.T]
        return np.stack(columns, axis=1)


class ServoWatch:
    """What the servos of one robot stray from what they were told, and the pace that this leaves."""

    def __init__(self, reference: Callable[[Floats], Floats], distances: Distances, *, least: float) -> None:
        """Has seen nothing.

        Args:
            reference: planned postures (k, n) [rad] at performance times (k,) [s], also beyond the end.
            distances: of the robot.
            least: [m] clearance that the robot asks for.
        """
        self._reference, self._distances, self._least = reference, distances, least
        self._clocks: deque[float] = deque(maxlen=CYCLES_KEPT)  # [s] of cycles
        self._times: deque[float] = deque(maxlen=CYCLES_KEPT)  # [s] of the performance, likewise
        self._strayed = self._taken = np.zeros(0)  # (n,) [rad], and when [s]; none yet
        self._looked = -np.inf  # [s] of the clock
        self.watch = ClearanceWatch()

    def see(self, statuses: Iterable[Status]) -> bool:
        """Sees new cycles, and returns whether it has looked ahead anew: its pace is then to be asked for."""
        news = False
        for status in statuses:
            if status.stage.runs and np.isfinite(status.time):
                self._note(status)
                if status.clock - self._looked >= WAIT:
                    self._looked, news = status.clock, True
                    self._look(status)
            elif self._times:
                self._forget()
                news = True
        return news

    @property
    def pace(self) -> float:
        """Seconds of the performance per second that the clearance leaves."""
        return self.watch.pace

    @property
    def over(self) -> bool:
        """Whether waiting was in vain, so that the servos are to stop."""
        return self.watch.over

    def _note(self, status: Status) -> None:
        """Compares what is new with the plan."""
        if not len(self._taken):
            self._strayed, self._taken = np.full(len(status.angles), np.nan), np.full(len(status.angles), -np.inf)
        self._clocks.append(status.clock)
        self._times.append(status.time)
        fresh = np.isfinite(status.angles) & (status.taken > self._taken)  # never so for NaN
        if fresh.any():
            taken = status.taken[fresh]
            moments, places = np.unique(self._time_of(taken), return_inverse=True)
            planned = self._reference(moments)[places, np.flatnonzero(fresh)]
            self._strayed = self._strayed.copy()
            self._strayed[fresh] = status.angles[fresh] - planned
            self._taken = np.where(fresh, status.taken, self._taken)

    def _time_of(self, clocks: Floats) -> Floats:
        """(k,) [s] of the performance, at other times [s] of the clock."""
        return np.interp(clocks, self._clocks, self._times)

    def _look(self, status: Status) -> None:
        strayed = np.where(status.clock - self._taken <= FRESH, self._strayed, np.nan)
        coming = self._reference(coming_times(status.time, np.inf))
        self.watch = look_ahead(self.watch, coming, sealed(strayed), self._distances, least=self._least)

    def _forget(self) -> None:
        """Begins anew: servos that stood, or moved to somewhere else, tell nothing of what comes."""
        self._clocks.clear()
        self._times.clear()
        self._strayed = self._taken = np.zeros(0)
        self._looked, self.watch = -np.inf, ClearanceWatch()
