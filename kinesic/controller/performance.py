"""What was planned and what was performed, side by side."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.measurements import Measurements
from kinesic.controller.arrival import lags, paths
from kinesic.controller.plan import Plan
from kinesic.controller.syncs import SyncTime

CHECK_RATE = 1000  # [Hz] at which limits are judged
MOVING = 0.05  # share of its speed limit above which a hinge counts as moving


@dataclass(frozen=True, eq=False)
class Performance:
    """One block, planned and performed in the twin."""

    plan: Plan
    measured: Measurements
    torques: Floats  # (m, n) [Nm] that the reference needs
    parse_seconds: float
    dry_run_seconds: float  # of twin and checks

    @cached_property
    def reference(self) -> tuple[Floats, Floats, Floats]:
        """Planned angles, speeds and accelerations (m, n) at the measured times."""
        return self.plan.trajectory.sample(self.measured.times)

    @cached_property
    def ratios(self) -> dict[str, Floats]:
        """Peak ratio (n,) of position, speed and acceleration to their limits, at 1 kHz on the plan."""
        trajectory, limits = self.plan.trajectory, self.plan.facts.limits
        times = np.arange(0.0, trajectory.duration + 1 / CHECK_RATE, 1 / CHECK_RATE)
        angles, speeds, accelerations = trajectory.sample(times)
        middle, half = (limits.upper + limits.lower) / 2, (limits.upper - limits.lower) / 2
        return {
            "position": (np.abs(angles - middle) / half).max(axis=0),
            "speed": (np.abs(speeds) / limits.speed).max(axis=0),
            "acceleration": (np.abs(accelerations) / limits.acceleration).max(axis=0),
        }

    @cached_property
    def lags(self) -> dict[SyncTime, float | None]:
        """How much later than planned each sync point was met in the twin [s]; None: never."""
        robot = self.plan.facts.robot
        planned = paths(self.reference[0], robot)
        performed = {**paths(self.measured.angles, robot)}
        return lags(self.plan, self.measured.times, planned, performed)

    @cached_property
    def errors(self) -> Floats:
        """(m, n) [rad] measured minus planned, NaN where the hinge is not moving."""
        angles, speeds, _ = self.reference
        moving = np.abs(speeds) > MOVING * self.plan.facts.limits.speed
        return np.where(moving, self.measured.angles - angles, np.nan)

    @cached_property
    def duty(self) -> Floats:
        """(m, n) duty that the reference needs: torque / stall + speed / no-load."""
        drives = self.plan.facts.robot.drives
        stall = np.array([drive.stall for drive in drives])
        no_load = np.array([drive.no_load for drive in drives])
        duty: Floats = self.torques / stall + self.reference[1] / no_load
        return duty
