"""Record of a plan performed on servos."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
from kinesic.metrics.arrival import compute_part_paths, measure_arrival_lags
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.reference import MOVING_FRACTION
from kinesic.metrics.servo_log import interpolate_angles, select_usable
from kinesic.planning.syncs import SyncTime

FULL_TIME_SCALE = 0.999  # time scale from which time counts as running at full speed
RAMP_TIME = DEFAULT_SETTINGS.slow + 0.05  # [s] ramp of the time scale at start and stop, plus a few bus cycles
Ending = Literal["performed", "ended", "stopped", "failed"]


@dataclass(frozen=True, eq=False)
class ServoRun:
    """Record of a plan performed on servos, with all servo statuses."""

    performance: DryRun  # earlier dry run of the same plan in the twin
    history: tuple[Status, ...]  # statuses while the performance time ran
    notes: tuple[Note, ...]
    ending: Ending
    why: str = ""  # reason of a failure

    @cached_property
    def _rows(self) -> tuple[Status, ...]:
        """Servo statuses with finite readings of all servos and increasing time."""
        return select_usable(self.history)

    @cached_property
    def clocks(self) -> Floats:
        """Clock time of each usable servo status since the first, (k,) [s]."""
        return sealed([status.clock - self._rows[0].clock for status in self._rows])

    @cached_property
    def times(self) -> Floats:
        """Performance time of each usable servo status, (k,) [s]."""
        return sealed([status.time for status in self._rows])

    @cached_property
    def angles(self) -> Floats:
        """Measured angles, (k, n) [rad], each taken at its time in `taken`."""
        return self._table("angles")

    @cached_property
    def taken(self) -> Floats:
        """Measurement time of each angle, (k, n) [s], since the first status."""
        return sealed(self._table("taken") - (self._rows[0].clock if self._rows else 0.0))

    @cached_property
    def interpolated_angles(self) -> Floats:
        """Measured angles interpolated to the times `clocks`, (k, n) [rad]."""
        if not self._rows:
            return self.angles
        return interpolate_angles(self.clocks, self.taken, self.angles)

    @cached_property
    def setpoints(self) -> Floats:
        """Sent setpoints, (k, n) [rad]."""
        return self._table("setpoints")

    def _table(self, name: Literal["angles", "setpoints", "taken"]) -> Floats:
        joints = len(self.performance.plan.setup.robot.skeleton.hinges)
        return sealed(np.reshape([getattr(status, name) for status in self._rows], (len(self._rows), joints)))

    @cached_property
    def errors(self) -> Floats:
        """Measured minus planned angles, (k, n) [rad], NaN where excluded.

        Excluded are repeated readings, hinges at rest, and cycles with slowed time, in which the planned velocities do
        not hold.
        """
        if not self._rows:
            return self.angles
        trajectory = self.performance.plan.trajectory
        planned = np.empty((2, *self.angles.shape))
        for k, taken in enumerate(self.taken.T):
            sample = trajectory.sample(np.interp(taken, self.clocks, self.times))
            planned[:, :, k] = sample[0][:, k], sample[1][:, k]
        moving: Flags = np.abs(planned[1]) > MOVING_FRACTION * self.performance.plan.setup.limits.speed
        is_full_speed = np.array([[status.scale > FULL_TIME_SCALE] for status in self._rows], dtype=np.bool_).reshape(
            -1, 1
        )
        is_new: Flags = np.diff(self.taken, axis=0, prepend=-np.inf) > 0.0
        return np.where(moving & is_full_speed & is_new, self.angles - planned[0], np.nan)

    @cached_property
    def performed(self) -> float:
        """Completed fraction of the plan, from all statuses, usable or not."""
        end = self.performance.reference.times[-1]
        reached = max((status.time for status in self.history if np.isfinite(status.time)), default=0.0)
        return float(reached / end) if end > 0.0 else 0.0

    @cached_property
    def full_speed_fraction(self) -> float:
        """Fraction of usable statuses in which performance time ran at full speed.

        The first and last `RAMP_TIME` are excluded, unless the run is too short to have statuses between them.
        """
        if not self._rows:
            return 0.0
        is_full = np.array([status.scale > FULL_TIME_SCALE for status in self._rows], dtype=np.bool_)
        is_between = (self.clocks > RAMP_TIME) & (self.clocks < self.clocks[-1] - RAMP_TIME)
        return float(np.mean(is_full[is_between] if is_between.any() else is_full))

    @cached_property
    def lags(self) -> dict[SyncTime, float | None]:
        """Largest arrival delay at each sync point [s], None if never reached."""
        arrivals = self.performance.reference.arrivals
        if len(self.times) < 2:
            return dict.fromkeys(arrivals)
        return measure_arrival_lags(
            arrivals, self.times, compute_part_paths(self.interpolated_angles, self.performance.plan.setup.robot)
        )
