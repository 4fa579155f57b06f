"""What was planned and what was performed, side by side."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.measurements import Measurements
from kinesic.body.robot import Robot
from kinesic.controller.arrival import lags, paths
from kinesic.controller.reference import Reference
from kinesic.controller.tracking_delay import lateness
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors


@dataclass(frozen=True, eq=False)
class Performance:
    """One block, planned and performed in the twin."""

    reference: Reference  # of the plan, at the times of the commands
    twin: Factors  # how far the twin's servos and masses are from the robot's description
    measured: Measurements
    parse_seconds: float
    dry_run_seconds: float  # of feed-forward and of all twins that performed together

    @property
    def plan(self) -> Plan:
        """What was performed."""
        return self.reference.plan

    @property
    def twin_name(self) -> str:
        """How reports call the twin."""
        return {NOMINAL: "nominal", PESSIMISTIC: "pessimistic"}.get(self.twin, "own")

    @cached_property
    def robot(self) -> Robot:
        """The robot as the twin has it."""
        return self.twin.applied(self.plan.facts.robot)

    @cached_property
    def period(self) -> float:
        """[s] between samples."""
        times = self.measured.times
        return float(times[-1] - times[0]) / max(1, len(times) - 1)

    @cached_property
    def lags(self) -> dict[SyncTime, float | None]:
        """How much later than planned each sync point was met in the twin [s]; None: never."""
        performed = paths(self.measured.angles, self.plan.facts.robot, self.measured.hands)
        return lags(self.reference.arrivals, self.measured.times, performed)

    @cached_property
    def errors(self) -> Floats:
        """(m, n) [rad] measured minus planned, NaN where the hinge is not moving."""
        return np.where(self.reference.moving, self.measured.angles - self.reference.angles, np.nan)

    @cached_property
    def lateness(self) -> Floats:
        """(n,) [s] by which the twin's hinges follow late, by cross-correlation; NaN for those that do not move."""
        moving: Flags = np.any(self.reference.moving, axis=0)
        return lateness(self.reference.speeds, self.measured.speeds, moving, period=self.period)
