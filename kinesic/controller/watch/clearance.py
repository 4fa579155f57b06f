"""Clearance watch: choose a time scale from tracking errors and clearance.

A tracking error is expected to recur in both directions, as late arms overshoot: recent errors are added to and
subtracted from the coming postures, whose clearance is measured. With ample clearance, time runs as planned. Otherwise
it runs slower, which reduces errors, as servos lag in proportion to their velocity. After a while of creeping, the
remaining error is the sag of a soft servo, which keeps its sign. The performance ends if creeping does not help, or at
once if the measured posture is too close.
"""

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.robot import Robot
from kinesic.metrics.clearance_forecast import ERROR_MEMORY, LOOK_PERIOD, LOOKS_PER_ERROR

LOOKAHEAD_TIME = 0.3  # [s] duration of planned motion that is checked ahead; slowing down takes as long
SLOWING_FRACTION = 0.9  # fraction of the required clearance below which the motion is slowed down
CREEP_FRACTION = 0.4  # fraction of the required clearance below which the motion nearly stops
RESERVE_FRACTION = 0.3  # fraction of the required clearance below which the robot stops at once
CREEP_PACE = 0.02  # lowest time scale near a collision; slow enough for tracking errors to decay
SETTLING_TIME = 0.3  # [s] creeping time after which servos no longer oscillate
MAX_CREEP_TIME = 2.0  # [s] creeping time before the performance ends, longer than `ERROR_MEMORY`
_LOOKAHEAD_LOOKS = round(LOOKAHEAD_TIME / LOOK_PERIOD)  # number of clearance check periods within the lookahead time
_MEMORY_LOOKS = round(ERROR_MEMORY / LOOK_PERIOD)  # number of past clearance checks whose tracking errors are kept


@dataclass(frozen=True)
class ClearanceWatch:
    """State of the clearance watch: recent tracking errors and time scale."""

    recent_errors: tuple[Floats, ...] = ()  # (n,) [rad] measured minus planned at the last checks, the latest last
    reversible_errors: tuple[Floats, ...] = ()  # (n,) [rad] errors that may change sign; 0 without oscillation
    forecast_clearance: float = inf  # [m] smallest clearance within the lookahead time
    pace: float = 1.0  # time scale of the performance
    creep_time: float = 0.0  # [s] duration of creeping without a pause
    is_too_near: bool = False  # whether the measured clearance is below the reserve

    @property
    def over(self) -> bool:
        """Whether the performance must be stopped for lack of clearance.

        The reserve is used up, or creeping did not help.
        """
        return self.is_too_near or self.creep_time >= MAX_CREEP_TIME


def look_ahead(
    watch: ClearanceWatch, coming: Floats, tracking_error: Floats, distances: Distances, *, min_clearance: float
) -> ClearanceWatch:
    """Update the clearance watch from the postures expected next.

    Args:
        watch: before.
        coming: (k, n) [rad] planned postures of the next `LOOKAHEAD_TIME` seconds, the present one first.
        tracking_error: (n,) [rad] measured minus planned now; NaN for a servo that did not answer.
        distances: of the robot.
        min_clearance: [m] required clearance of the robot.
    """
    error = sealed(np.nan_to_num(tracking_error))
    recent = (*watch.recent_errors, error)[-1 - _MEMORY_LOOKS :]
    reversible_error = sealed(np.where(watch.creep_time < SETTLING_TIME, error, 0.0))
    reversible = (*watch.reversible_errors, reversible_error)[-1 - _MEMORY_LOOKS :]
    errors = np.concatenate([np.array(recent[::-LOOKS_PER_ERROR]), -np.array(reversible[::-LOOKS_PER_ERROR])])
    disturbed = (coming[:, None] + errors).reshape(-1, len(tracking_error))
    clearances = distances.clearance(disturbed).distances
    forecast_clearance, present = float(clearances.min()), float(clearances[0])
    pace = choose_pace(forecast_clearance, min_clearance)
    creep_time = watch.creep_time + LOOK_PERIOD if pace <= CREEP_PACE else 0.0
    is_too_near = present < RESERVE_FRACTION * min_clearance
    return replace(
        watch,
        recent_errors=recent,
        reversible_errors=reversible,
        forecast_clearance=forecast_clearance,
        pace=pace,
        creep_time=creep_time,
        is_too_near=is_too_near,
    )


def choose_pace(forecast_clearance: float, min_clearance: float) -> float:
    """Return the time scale for a forecast clearance.

    Args:
        forecast_clearance: [m] smallest clearance within the lookahead time.
        min_clearance: [m] required clearance of the robot; 0 if its skin may touch itself.

    Returns:
        `CREEP_PACE` to 1.
    """
    if min_clearance == 0.0:
        return 1.0 if forecast_clearance >= 0.0 else CREEP_PACE
    fraction = (forecast_clearance / min_clearance - CREEP_FRACTION) / (SLOWING_FRACTION - CREEP_FRACTION)
    return min(1.0, max(CREEP_PACE, fraction))


def lookahead_times(time: float, end: float) -> Floats:
    """Return the performance times [s] of the postures to check next.

    They start now and do not exceed the end of the motion.
    """
    return sealed(np.minimum(time + LOOK_PERIOD * np.arange(_LOOKAHEAD_LOOKS + 1), end))


def needs_slowing(clearances: Floats, robot: Robot) -> bool:
    """Return whether any predicted clearance (k,) [m] requires a slower motion."""
    return bool(clearances.min() < SLOWING_FRACTION * robot.min_clearance)
