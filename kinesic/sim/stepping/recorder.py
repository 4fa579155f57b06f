"""Twin recorder that works window by window to bound its memory."""

from math import inf

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, Indices, seal_in_place, sealed
from kinesic.body.command import Measurements, Power, SetpointRows
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES, Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.power import Spent
from kinesic.sim.stepping.driven_motion import DrivenMotion, HingePlaces, measure_drives
from kinesic.sim.stepping.step_log import StepLog

MAX_INT16_TICKS = np.iinfo(np.int16).max  # largest setpoint in ticks that two bytes can hold


class Recorder:
    """Recorder of a motion's measurements, one row per command.

    Steps are measured in windows and read once.
    """

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
        """Create a recorder without measurements.

        Args:
            robot: Description with the twin's factors applied.
            distances: Self-distance of the robot.
            places: Indices of the hinges.
            commands: Total number of commands, m.
            latency: [s] from a command's time until its setpoints reach the servos.
            ticks: (n,) [rad] to which setpoints are rounded; None: no rounding.
        """
        self._robot, self._distances, self._places, self._latency = robot, distances, places, latency
        self._commands, self._measured_count, self._ticks = commands, 0, ticks
        self._rows: dict[str, Floats] = {}  # quantity -> (m, ...) one row per command
        self._counts: dict[str, NDArray[np.int16] | Floats] = {}  # quantity -> (m, n) setpoints [ticks]
        self._pairs: list[tuple[str, str]] = []
        self._spent: Spent | None = None  # at the last step of the previous window
        self._energy, self._volts, self._winding_names = 0.0, inf, tuple[str, ...]()
        self._last = np.empty((0, 0))  # (p, 1) [m] pair distances in the last posture; (0, 0) before the first window
        self._minimum = inf  # [m] smallest distance at the commands of previous windows

    def add(self, log: StepLog) -> None:
        """Measure the physics steps of a log as the next time window.

        From the second window on, the first step of the log is the last one of the previous window.

        Raises:
            ValueError: the log contains no command, or more than the recorder has capacity for.
        """
        if not log.times:
            raise ValueError("no command was written, so nothing was measured: write commands first")
        if self._measured_count + len(log.times) > self._commands:
            count = self._measured_count + len(log.times)
            raise ValueError(f"{count} commands were written, but the recorder has room for {self._commands}")
        robot = self._robot
        log_steps = log.steps()
        motion = measure_drives(log_steps, self._places, robot.skeleton.names, robot.drives, self._spent)
        command_steps = log_steps.ends - 1
        self._add_clearance(motion, command_steps)
        self._add(times=sealed(log.times), angles=motion.angles, velocities=motion.velocities)
        self._add(
            supplied=np.broadcast_to(log_steps.supplied, len(log_steps.spans))[command_steps], **motion.power.warming
        )
        self._add(mean=motion.power.mean, peak=motion.power.peak)
        self._add_goals(
            sent=log.sent(), in_force=log_steps.aims[log_steps.begins.searchsorted(command_steps, side="right") - 1]
        )
        self._energy, self._volts = motion.power.energy, min(self._volts, motion.power.volts)
        self._spent, self._winding_names = motion.spent, tuple(motion.power.warming)
        self._measured_count += len(log.times)

    def _add_clearance(self, motion: DrivenMotion, ends: Indices) -> None:
        """Measure and store the self-distances in one time window.

        The last posture of the previous window bounds the distances before the first command.
        """
        lowest, hands = self._distances.survey(motion.angles, [self._robot.arm(side).wrist for side in SIDES])
        previous_postures = self._last.shape[1]
        approach = self._distances.approach(
            motion.postures,
            np.append([0] * previous_postures, ends).astype(np.intp),
            near=self._robot.min_clearance,
            minimum_elsewhere=self._minimum,
            end_distances=np.hstack([self._last, lowest]) if previous_postures else lowest,
        )
        self._add(distances=approach.distances[previous_postures:], **dict(zip(SIDES, hands, strict=True)))
        self._pairs += approach.pairs[previous_postures:]
        self._last = lowest[:, -1:].copy()
        self._minimum = min(self._minimum, float(lowest.min(initial=inf)))

    def _add(self, **window: Floats) -> None:
        """Store the measurements at the command times of one window.

        Rows for all commands at once are stored without a copy.
        """
        for name, rows in window.items():
            if len(rows) == self._commands:
                self._rows[name] = rows
                continue
            if name not in self._rows:
                self._rows[name] = np.empty((self._commands, *rows.shape[1:]))
            self._rows[name][self._measured_count : self._measured_count + len(rows)] = rows

    def _add_goals(self, **window: Floats) -> None:
        """Store the setpoints of one time window in servo ticks.

        Ticks are int16 as long as all values fit. Without rounding the setpoints are stored in radians.
        """
        for name, goals in window.items():
            ticks: NDArray[np.int16] | Floats = goals if self._ticks is None else np.rint(goals / self._ticks)
            if self._ticks is not None and np.abs(ticks).max(initial=0.0) <= MAX_INT16_TICKS:
                ticks = ticks.astype(np.int16)
            if name not in self._counts:
                self._counts[name] = np.empty((self._commands, goals.shape[1]), ticks.dtype)
            elif ticks.dtype == np.float64:
                self._counts[name] = self._counts[name].astype(np.float64, copy=False)
            self._counts[name][self._measured_count : self._measured_count + len(goals)] = ticks

    def measurements(self) -> Measurements:
        """Return all measurements, once every command is measured.

        Nothing can be added afterwards.

        Raises:
            ValueError: commands are missing.
        """
        if self._measured_count < self._commands:
            raise ValueError(
                f"{self._measured_count} of {self._commands} commands were measured: record the others first"
            )
        rows = {name: seal_in_place(values) for name, values in self._rows.items()}
        tick = sealed(np.ones(len(self._robot.drives)) if self._ticks is None else self._ticks)
        for counts in self._counts.values():
            counts.setflags(write=False)
        return Measurements(
            times=rows["times"],
            angles=rows["angles"],
            velocities=rows["velocities"],
            sent=SetpointRows(self._counts["sent"], tick),
            in_force=SetpointRows(self._counts["in_force"], tick),
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
                warming={name: rows[name] for name in self._winding_names},
            ),
        )
