"""Fit of servo parameters so that the twin reproduces a log.

Angles do not determine all parameters. All torques in the equation of motion can be scaled together without any effect
on angles, so masses are taken from the description. Gain, stall torque and no-load speed only appear as stall x gain
and stall / no-load speed; they can be told apart only where the duty saturates. Without saturation the gain is also
taken from the description. A parameter is fitted only if the log determines it for any value of the others.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import count, pairwise

import msgspec
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.least_squares import minimise_squares
from kinesic.body.robot import Robot
from kinesic.sim.fitting.identifiability import (
    DATASHEET_DEVIATION,
    Identifiability,
    find_assumed_gains,
    find_identifiable,
)
from kinesic.sim.fitting.parameters import (
    DEFAULT_PARAMETERS,
    ServoParameter,
    Unknown,
    list_unknowns,
    to_factors,
    value_bounds,
)
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import Factors
from kinesic.sim.twin import Twin

REPLAY_STEP = 0.002  # [s] longest physics step, half the twin's, so that step errors do not bias the fit
STEP_ROUNDING_TOLERANCE = 1e-9  # [steps] remainder of an interval that does not count as a further step
DIFFERENCE_STEP = 0.01  # step of finite differences, in units of the fitted variables
MAX_EVALUATIONS = 15  # largest number of error evaluations by the optimiser, besides those for Jacobians
ERROR_CACHE_SIZE = 64  # number of cached error vectors, as Jacobians and steps evaluate values repeatedly
FIT_TOLERANCE = 1e-3  # relative change of values and errors at which a fit ends


@dataclass(frozen=True)
class Estimate:
    """Estimated value of one parameter with its standard deviation."""

    unknown: Unknown
    value: float  # factor, or latency [s]
    deviation: float  # standard deviation in the unit of `value`, also for a parameter that is not identified
    why: str = ""  # reason that the parameter is not identified and keeps the data sheet's value


@dataclass(frozen=True)
class Fit:
    """Result of a servo fit: parameter factors, estimates and remaining errors."""

    factors: Factors
    estimates: tuple[Estimate, ...]
    error_before: float  # [rad] RMS of twin angle minus log angle, with data sheet servos
    error_after: float  # [rad] RMS with the fitted factors


def fit_factors(
    log: Log,
    robot: Robot,
    *,
    free: tuple[ServoParameter, ...] = DEFAULT_PARAMETERS,
    progress: Callable[[int], None] = lambda count: None,
) -> Fit:
    """Fit servo factors so that a simulated robot reproduces a log.

    Args:
        log: Setpoints and angles of the whole robot.
        robot: Description with data sheet parameters.
        free: Parameters that may differ from the data sheets.
        progress: Callback with the number of replays, called after each replay; the total is unknown.

    Returns:
        Factors and estimates; the same log gives the same result.

    Raises:
        ValueError: both stall and mass are free.
    """
    parameters = list_unknowns(robot, free)
    noise = robot.drives.tick / 2  # [rad] of a rounded angle; rounding errors of successive angles are correlated

    replays = count(1)

    @lru_cache(maxsize=ERROR_CACHE_SIZE)
    def cached_errors(*values: float) -> Floats:
        result = replay_log(log, robot, to_factors(parameters, np.array(values)))
        progress(next(replays))
        return sealed(((result - log.angles) / noise).ravel())

    def errors(values: Floats) -> Floats:
        return cached_errors(*values.tolist())

    sheet = np.zeros(len(parameters))
    initial_errors = errors(sheet)
    assumed = (
        find_assumed_gains(parameters, _compute_jacobian(errors, sheet, range(len(parameters))))
        if "gain" in free
        else {}
    )
    values = _minimise(errors, parameters, [k for k in range(len(parameters)) if k not in assumed])
    scatter = max(1.0, _compute_rms(errors(values)))
    result = find_identifiable(
        parameters, _compute_jacobian(errors, values, range(len(parameters))), assumed=assumed, scatter=scatter
    )
    values = np.where(result.is_identified, values, 0.0)
    spacing = np.tile(noise, len(log.times))
    return Fit(
        to_factors(parameters, values),
        tuple(_estimate(parameters[k], values[k], result, k) for k in range(len(parameters))),
        _compute_rms(initial_errors * spacing),
        _compute_rms(errors(values) * spacing),
    )


def _minimise(errors: Callable[[Floats], Floats], parameters: Sequence[Unknown], chosen: list[int]) -> Floats:
    """Minimise the replay errors and the deviations from the data sheets.

    Args:
        errors: Values (u,) -> errors (r,) in units of the noise.
        parameters: Unknowns of the fit.
        chosen: Indices of the unknowns that are optimised.

    Returns:
        (u,) values, zero for unknowns that are not optimised.
    """
    if not chosen:
        return np.zeros(len(parameters))

    def full_vector(free_values: Floats) -> Floats:
        values = np.zeros(len(parameters))
        values[chosen] = free_values
        return values

    solved = minimise_squares(
        lambda free_values: np.concatenate([errors(full_vector(free_values)), free_values / DATASHEET_DEVIATION]),
        np.zeros(len(chosen)),
        jacobian=lambda free_values: np.concatenate(
            [_compute_jacobian(errors, full_vector(free_values), chosen), np.eye(len(chosen)) / DATASHEET_DEVIATION]
        ),
        bounds=value_bounds([parameters[k] for k in chosen]),
        max_evaluations=MAX_EVALUATIONS,
        tolerance=FIT_TOLERANCE,
    )
    return full_vector(solved.values)


def _compute_jacobian(errors: Callable[[Floats], Floats], values: Floats, chosen: Sequence[int]) -> Floats:
    """Compute the Jacobian (r, c) of the errors by finite differences.

    Args:
        errors: Values (u,) -> errors (r,).
        values: (u,) point of the derivative.
        chosen: (c,) indices of the values to differentiate by.
    """
    base_errors = errors(values)
    slopes = np.empty((len(base_errors), len(chosen)))
    for column, k in enumerate(chosen):
        shifted = values.copy()
        shifted[k] += DIFFERENCE_STEP
        slopes[:, column] = (errors(shifted) - base_errors) / DIFFERENCE_STEP
    return slopes


def _estimate(unknown: Unknown, value: float, result: Identifiability, k: int) -> Estimate:
    deviation = unknown.scale(value) * float(result.deviations[k])
    return Estimate(unknown, unknown.to_physical(value), deviation, result.reasons.get(k, ""))


def _compute_rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def replay_log(log: Log, robot: Robot, factors: Factors) -> Floats:
    """Replay a log's setpoints in a twin and return its angles.

    Setpoints that arrive within a physics step are averaged over the step by time. If steps were split at the arrivals,
    angles would be discontinuous functions of the latency, and no fit could converge.

    Args:
        log: Log that begins at rest.
        robot: Description with data sheet parameters.
        factors: Deviations of the twin from the description.

    Returns:
        (m, n) [rad] angles at the times of the log.
    """
    spans = np.diff(log.times)
    counts = np.ceil(spans / REPLAY_STEP - STEP_ROUNDING_TOLERANCE).astype(int)
    step_times = [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(pairwise(log.times), counts, strict=True)]
    steps = np.append(np.concatenate(step_times), log.times[-1])
    goals = np.diff(_integrate_setpoints(log, steps - factors.latency), axis=0) / np.diff(steps)[:, None]
    without_latency = msgspec.structs.replace(factors, latency=0.0)
    twin = Twin(robot, factors=without_latency, start=log.angles[0], rounds=False, step=REPLAY_STEP)
    return twin.replay(steps, goals, {0, *np.cumsum(counts).tolist()})


def _integrate_setpoints(log: Log, times: Floats) -> Floats:
    """Integrate the log's piecewise-constant setpoints up to given times.

    Before the first command the initial angles are in force.

    Args:
        log: Log with setpoints.
        times: (k,) [s] ends of the integrals.

    Returns:
        (k, n) [rad s].
    """
    last = np.searchsorted(log.times, times, side="right") - 1
    in_force = np.where((last < 0)[:, None], log.angles[0], log.setpoints[last])
    previous_sums = np.cumsum(log.setpoints[:-1] * np.diff(log.times)[:, None], axis=0)
    complete = np.concatenate([np.zeros((1, log.setpoints.shape[1])), previous_sums])[np.maximum(last, 0)]
    sums: Floats = complete + in_force * (times - log.times[np.maximum(last, 0)])[:, None]
    return sums
