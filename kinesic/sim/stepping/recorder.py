"""Measures what a twin does stretch by stretch, so that no more than a stretch of its steps has to be kept."""

from collections.abc import Mapping
from math import inf

import numpy as np

from kinesic.body.arrays import Floats, Indices, seal_own
from kinesic.body.command import Measurements, Power
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES, Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.power import Spent, windings_of
from kinesic.sim.stepping.driven_motion import DrivenMotion, HingePlaces, measure_drives
from kinesic.sim.stepping.step_log import StepLog


class Recorder:
    """What was measured of a motion so far: its steps are looked at once, and what they leave is a row a command."""

    def __init__(
        self, robot: Robot, distances: CapsuleDistances, places: HingePlaces, *, commands: int, latency: float
    ) -> None:
        """Begins with nothing, and with room for all.

        Args:
            robot: as the twin has it.
            distances: of the same.
            places: of its hinges.
            commands: how many there will be, m.
            latency: [s] from a command's time until its goals reach the servos.
        """
        self._robot, self._distances, self._places, self._latency = robot, distances, places, latency
        self._wrists = [robot.arm(side).wrist for side in SIDES]
        warm, hinges = windings_of(robot.skeleton.names, robot.drives), len(robot.drives)
        self._times, self._near, self._mean, self._peak = (np.empty(commands) for _ in range(4))
        self._rows = {name: np.empty((commands, hinges)) for name in ("angles", "speeds", "torques", "duties", "goals")}
        self._hands = np.empty((len(SIDES), commands, 3))
        self._warming = {winding.name: np.empty(commands) for winding in warm}
        self._pairs: list[tuple[str, str]] = []
        self._spent: Spent | None = None  # up to the last step
        self._energy, self._volts = 0.0, inf
        self._last = np.empty((0, 0))  # (p, 1) [m] of each pair in the last posture; (0, 0) before there is one
        self._least = inf  # [m] at any command so far

    def add(self, log: StepLog) -> None:
        """Measures what a log holds; from the second time on its first step is the last one of the stretch before."""
        robot, begin = self._robot, len(self._pairs)
        done = measure_drives(log.kept(), self._places, robot.skeleton.names, robot.drives, self._spent)
        rows = slice(begin, begin + len(log.times))
        self._add_clearance(done, np.array(log.counts, dtype=np.intp) - 1, rows)
        self._times[rows] = log.times
        for name in ("angles", "speeds", "torques", "duties"):
            self._rows[name][rows] = getattr(done, name)
        self._rows["goals"][rows] = log.sent()
        self._add_power(done.power, rows)
        self._spent = done.spent

    def _add_clearance(self, done: DrivenMotion, ends: Indices, rows: slice) -> None:
        """What lies between the last posture before and the first command is bounded by both, as everywhere."""
        lowest, self._hands[:, rows] = self._distances.survey(done.angles, self._wrists)
        known = self._last.shape[1]
        found = self._distances.approach(
            done.postures,
            np.append([0] * known, ends).astype(np.intp),
            near=self._robot.least_clearance,
            least=self._least,
            lowest=np.hstack([self._last, lowest]) if known else lowest,
        )
        self._near[rows] = found.distances[known:]
        self._pairs += found.pairs[known:]
        self._last = lowest[:, -1:].copy()
        self._least = min(self._least, float(lowest.min(initial=inf)))

    def _add_power(self, power: Power, rows: slice) -> None:
        self._mean[rows], self._peak[rows] = power.mean, power.peak
        self._energy, self._volts = power.energy, min(self._volts, power.volts)
        for name, rises in power.warming.items():
            self._warming[name][rows] = rises

    def measurements(self) -> Measurements:
        """Hands over all that was measured, which is as much as there was room for; nothing more can be added."""
        return Measurements(
            times=seal_own(self._times),
            **{name: seal_own(rows) for name, rows in self._rows.items()},
            hands=dict(zip(SIDES, (seal_own(each) for each in self._hands), strict=True)),
            clearance=Clearance(seal_own(self._near), self._pairs),
            latency=self._latency,
            power=self._power(),
        )

    def _power(self) -> Power:
        warming: Mapping[str, Floats] = {name: seal_own(rises) for name, rises in self._warming.items()}
        return Power(seal_own(self._mean), seal_own(self._peak), self._energy, self._volts, warming)
