"""What was planned and what was performed, side by side."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import PPoly

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
    duties: Floats  # (m, n) that the reference needs at each command
    parse_seconds: float
    dry_run_seconds: float  # of twin and checks

    @cached_property
    def reference(self) -> tuple[Floats, Floats, Floats]:
        """Planned angles, speeds and accelerations (m, n) at the measured times."""
        return self.plan.trajectory.sample(self.measured.times)

    @cached_property
    def ratios(self) -> dict[str, Floats]:
        """Peak ratio (n,) of position, speed and acceleration to their limits, at 1 kHz on the plan."""
        limits, curves = self.plan.facts.limits, self.plan.trajectory.curves
        middle, half = (limits.upper + limits.lower) / 2, (limits.upper - limits.lower) / 2
        peaks = np.array([_peaks(curve, at) for curve, at in zip(curves, middle, strict=True)])
        return {
            "position": peaks[:, 0] / half,
            "speed": peaks[:, 1] / limits.speed,
            "acceleration": peaks[:, 2] / limits.acceleration,
        }

    @cached_property
    def lags(self) -> dict[SyncTime, float | None]:
        """How much later than planned each sync point was met in the twin [s]; None: never."""
        robot = self.plan.facts.robot
        planned = paths(self.reference[0], robot)
        performed = paths(self.measured.angles, robot, self.measured.hands)
        return lags(self.plan, self.measured.times, planned, performed)

    @cached_property
    def errors(self) -> Floats:
        """(m, n) [rad] measured minus planned, NaN where the hinge is not moving."""
        angles, speeds, _ = self.reference
        moving = np.abs(speeds) > MOVING * self.plan.facts.limits.speed
        return np.where(moving, self.measured.angles - angles, np.nan)


def _peaks(curve: PPoly, middle: float) -> tuple[float, float, float]:
    """Largest distance from the middle of its range, speed and acceleration of a hinge, at 1 kHz while it moves."""
    pieces = np.flatnonzero(np.any(curve.c[:-1] != 0.0, axis=0))
    spans = [
        np.arange(np.ceil(a), np.floor(b) + 1) for a, b in CHECK_RATE * np.stack([curve.x[:-1], curve.x[1:]], 1)[pieces]
    ]
    times = np.concatenate([curve.x[:1], *spans]) / CHECK_RATE
    angles, speeds, accelerations = (curve(times, nu=order) for order in range(3))
    return float(np.abs(angles - middle).max()), float(np.abs(speeds).max()), float(np.abs(accelerations).max())
