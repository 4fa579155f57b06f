"""Record of a plan performed in a simulated twin."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.command import COMMAND_RATE, Measurements
from kinesic.body.robot import Robot
from kinesic.metrics.arrival import compute_part_paths, measure_arrival_lags
from kinesic.metrics.clearance_forecast import LOOK_PERIOD, forecast_clearance
from kinesic.metrics.reference import Reference
from kinesic.metrics.smoothness import HandSmoothness
from kinesic.metrics.synchrony import StrokeLag, compute_median_lag, measure_lags
from kinesic.metrics.tracking_delay import estimate_tracking_delays
from kinesic.metrics.tracking_errors import TrackingErrors, measure_errors
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors

COMMANDS_PER_LOOK = round(2 * LOOK_PERIOD * COMMAND_RATE)  # commands between clearance predictions


@dataclass(frozen=True, eq=False)
class MeasuredMotion:
    """Measured motion as a function of performance time."""

    times: Floats  # (m,) [s] increasing
    angles: Floats  # (m, n) [rad]
    velocities: Floats  # (m, n) [rad/s]

    @property
    def duration(self) -> float:
        """Duration of the measurements [s]."""
        return float(self.times[-1])

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Interpolate angles, velocities and accelerations, each (k, n), at (k,) times."""
        rows = (self.angles, self.velocities, np.gradient(self.velocities, self.times, axis=0))
        angles, speeds, accelerations = (
            np.stack([np.interp(times, self.times, column) for column in row.T], axis=1) for row in rows
        )
        return angles, speeds, accelerations


@dataclass(frozen=True, eq=False)
class DryRun:
    """Record of a plan performed in one twin."""

    reference: Reference  # planned motion at the command times
    twin: Factors  # deviations of the twin's servos and masses from the robot's description
    measured: Measurements
    dry_run_seconds: float  # [s] time to compute the feed-forward and all twins of the same run
    min_pace: float = 1.0  # smallest time scale, in seconds of performance per second
    servo_estimate: Factors = NOMINAL_FACTORS  # estimate used by the feed-forward
    restoring: float = 1.0  # largest fraction of the observer's restoring gains that these servos tolerate

    @cached_property
    def clearance_forecast(self) -> Floats:
        """Predicted clearance including tracking errors, every 100 ms, (k,) [m]."""
        planned = self.plan.trajectory.angles(self.reference.times[::COMMANDS_PER_LOOK])
        return forecast_clearance(
            planned, self.measured.angles[::COMMANDS_PER_LOOK], self.plan.setup.distances, every=1
        )

    @property
    def performed(self) -> float:
        """Completed fraction of the plan, below 1 after a stop."""
        end = float(self.plan.command_times[-1])
        return float(self.reference.times[-1]) / end

    @property
    def duration(self) -> float:
        """Duration of the plan [s], shortened by a stop."""
        return min(self.plan.duration, float(self.measured.times[-1]))

    @property
    def plan(self) -> Plan:
        """Plan that the twin performs in this run."""
        return self.reference.plan

    @property
    def twin_name(self) -> str:
        """Name of the twin in reports."""
        return {NOMINAL_FACTORS: "nominal", PESSIMISTIC_FACTORS: "pessimistic"}.get(self.twin, "own")

    @cached_property
    def robot(self) -> Robot:
        """Robot with the servos and masses of the twin."""
        return self.twin.applied(self.plan.setup.robot)

    @cached_property
    def period(self) -> float:
        """Sampling period of the measured motion [s]."""
        times = self.measured.times
        return float(times[-1] - times[0]) / max(1, len(times) - 1)

    @cached_property
    def lags(self) -> dict[SyncTime, float | None]:
        """Largest arrival delay at each sync point [s], None if never reached."""
        performed = compute_part_paths(self.measured.angles, self.plan.setup.robot, self.measured.hands)
        return measure_arrival_lags(self.reference.arrivals, self.measured.times, performed)

    @cached_property
    def stroke_lags(self) -> tuple[StrokeLag, ...]:
        """Delays between words and their strokes in the twin."""
        return measure_lags(self.plan, self.measured.times, self.measured.hands)

    @property
    def median_stroke_lag(self) -> float | None:
        """Median absolute lag of strokes to words [s], None without strokes."""
        return compute_median_lag(self.stroke_lags)

    @cached_property
    def hand_smoothness(self) -> Mapping[str, HandSmoothness]:
        """Smoothness of each hand's path, by side."""
        planned = self.reference.hands
        return {
            side: HandSmoothness.of(planned[side], performed, period=self.period)
            for side, performed in self.measured.hands.items()
        }

    @property
    def errors(self) -> Floats:
        """Measured minus planned angles, (m, n) [rad], NaN while a hinge rests.

        The array is computed at every access.
        """
        return np.where(self.reference.moving, self.measured.angles - self.reference.angles, np.nan)

    @cached_property
    def tracking(self) -> TrackingErrors:
        """Tracking errors of the moving hinges."""
        measured, moving = self.measured.angles, self.reference.moving
        errors, filled = np.empty(np.count_nonzero(moving)), 0
        for rows, (angles, _, _) in self.reference.motions():
            window_errors = (measured[rows] - angles)[moving[rows]]
            errors[filled : filled + len(window_errors)] = window_errors
            filled += len(window_errors)
        return measure_errors(errors, moving)

    @cached_property
    def tracking_delays(self) -> Floats:
        """Tracking delay per hinge, (n,) [s], NaN without motion."""
        moving: Flags = np.any(self.reference.moving, axis=0)
        return estimate_tracking_delays(
            self.reference.velocities_of, self.measured.velocities, moving, period=self.period
        )
