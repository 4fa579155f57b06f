"""Measures what a twin does window by window, so that no more than a window of its steps has to be kept."""

from math import inf

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, Indices, seal_own, sealed
from kinesic.body.command import Measurements, Power, TickRows
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES, Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.power import Spent
from kinesic.sim.stepping.driven_motion import DrivenMotion, HingePlaces, measure_drives
from kinesic.sim.stepping.step_log import StepLog

MOST_TICKS = np.iinfo(np.int16).max  # from zero, that two bytes hold


class Recorder:
    """Measures a motion window by window: it reads the steps of each once, and keeps one row for each command."""

    def __init__(
        self,
        robot: Robot,
        distances: CapsuleDistances,
        places: HingePlaces,
        *,
        commands: int,
        latency: float,
        ticks: Floats | None,
    ) -> None:
        """Begins with nothing.

        Args:
            robot: as the twin has it.
            distances: of the same.
            places: of its hinges.
            commands: how many there will be, m.
            latency: [s] from a command's time until its goals reach the servos.
            ticks: (n,) [rad] to which its goals are rounded; None: they are not.
        """
        self._robot, self._distances, self._places, self._latency = robot, distances, places, latency
        self._commands, self._done, self._ticks = commands, 0, ticks
        self._rows: dict[str, Floats] = {}  # (m, ...) each
        self._counts: dict[str, NDArray[np.int16] | Floats] = {}  # (m, n) ticks each
        self._pairs: list[tuple[str, str]] = []
        self._spent: Spent | None = None  # up to the last step
        self._energy, self._volts, self._warm = 0.0, inf, tuple[str, ...]()
        self._last = np.empty((0, 0))  # (p, 1) [m] of each pair in the last posture; (0, 0) before there is one
        self._least = inf  # [m] at any command so far

    def add(self, log: StepLog) -> None:
        """Measures what a log holds; from the second time on its first step is the last one of the window before.

        Raises:
            ValueError: the log holds no command, or more than there is room for.
        """
        if not log.times:
            raise ValueError("no command was written, so nothing was measured: write commands first")
        if self._done + len(log.times) > self._commands:
            count = self._done + len(log.times)
            raise ValueError(f"{count} commands were written, and the recorder has room for {self._commands}")
        robot = self._robot
        kept = log.kept()
        done, at = measure_drives(kept, self._places, robot.skeleton.names, robot.drives, self._spent), kept.ends - 1
        self._add_clearance(done, at)
        self._add(times=sealed(log.times), angles=done.angles, speeds=done.speeds)
        self._add(supplied=np.broadcast_to(kept.supplied, len(kept.spans))[at], **done.power.warming)
        self._add(mean=done.power.mean, peak=done.power.peak)
        self._add_goals(sent=log.sent(), in_force=kept.aims[kept.begins.searchsorted(at, side="right") - 1])
        self._energy, self._volts = done.power.energy, min(self._volts, done.power.volts)
        self._spent, self._warm = done.spent, tuple(done.power.warming)
        self._done += len(log.times)

    def _add_clearance(self, done: DrivenMotion, ends: Indices) -> None:
        """Adds the distances; the last posture of the window before bounds those on the way to the first command."""
        lowest, hands = self._distances.survey(done.angles, [self._robot.arm(side).wrist for side in SIDES])
        known = self._last.shape[1]
        found = self._distances.approach(
            done.postures,
            np.append([0] * known, ends).astype(np.intp),
            near=self._robot.least_clearance,
            least=self._least,
            lowest=np.hstack([self._last, lowest]) if known else lowest,
        )
        self._add(distances=found.distances[known:], **dict(zip(SIDES, hands, strict=True)))
        self._pairs += found.pairs[known:]
        self._last = lowest[:, -1:].copy()
        self._least = min(self._least, float(lowest.min(initial=inf)))

    def _add(self, **window: Floats) -> None:
        """Adds rows for the commands of a window; where that is all, they need not be copied."""
        for name, rows in window.items():
            if len(rows) == self._commands:
                self._rows[name] = rows
                continue
            if name not in self._rows:
                self._rows[name] = np.empty((self._commands, *rows.shape[1:]))
            self._rows[name][self._done : self._done + len(rows)] = rows

    def _add_goals(self, **window: Floats) -> None:
        """Adds goals for the commands of a window, in ticks; in two bytes each, as long as all fit."""
        for name, goals in window.items():
            ticks: NDArray[np.int16] | Floats = goals if self._ticks is None else np.rint(goals / self._ticks)
            if self._ticks is not None and np.abs(ticks).max(initial=0.0) <= MOST_TICKS:
                ticks = ticks.astype(np.int16)
            if name not in self._counts:
                self._counts[name] = np.empty((self._commands, goals.shape[1]), ticks.dtype)
            elif ticks.dtype == np.float64:
                self._counts[name] = self._counts[name].astype(np.float64, copy=False)
            self._counts[name][self._done : self._done + len(goals)] = ticks

    def measurements(self) -> Measurements:
        """Hands over all that was measured, once every command has been; nothing more can be added.

        Raises:
            ValueError: some commands are not there yet.
        """
        if self._done < self._commands:
            raise ValueError(f"{self._done} of {self._commands} commands were measured: record the others first")
        rows = {name: seal_own(values) for name, values in self._rows.items()}
        tick = sealed(np.ones(len(self._robot.drives)) if self._ticks is None else self._ticks)
        for counts in self._counts.values():
            counts.setflags(write=False)
        return Measurements(
            times=rows["times"],
            angles=rows["angles"],
            speeds=rows["speeds"],
            sent=TickRows(self._counts["sent"], tick),
            in_force=TickRows(self._counts["in_force"], tick),
            supplied=rows["supplied"],
            drives=self._robot.drives,
            hands={side: rows[side] for side in SIDES},
            clearance=Clearance(rows["distances"], self._pairs),
            latency=self._latency,
            power=Power(
                mean=rows["mean"],
                peak=rows["peak"],
                energy=self._energy,
                volts=self._volts,
                warming={name: rows[name] for name in self._warm},
            ),
        )
