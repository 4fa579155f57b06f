"""One control period of the observer as a CasADi graph."""

from functools import lru_cache

import casadi
import numpy as np

from kinesic.controller.observer import Observer
from kinesic.controller.observer_step import DISTURBANCE_DECAY, LOAD_ERROR_RANGE, RESTORING_GAINS


def advance(observer: Observer, estimate, deviation, inputs):
    """Return the observer estimate (7 + h, n) after one control period."""
    hinges, late = len(observer.lower), len(observer.arrival)
    gains = np.concatenate([observer.forecast.reshape(9, hinges), observer.gain, [observer.step, observer.full]])
    tick = compile_tick(hinges, late, observer.restoring)
    return np.array(tick(estimate.T, deviation, inputs.T, gains.T, observer.arrival)).T


@lru_cache(maxsize=8)
def compile_tick(hinges: int, late: int, restoring: float = 1.0) -> casadi.Function:
    """Build the CasADi function of one observer step.

    Args:
        hinges: number of hinges.
        late: number of pending corrections.
        restoring: fraction of `RESTORING_GAINS` that is used.

    Returns:
        From estimate (n, 7 + late), deviation (n,), inputs (n, 10), gains (n, 14) and arrival (late,) to the
        estimate of this tick.
    """
    names = {"estimate": 7 + late, "measured": 1, "inputs": 10, "gains": 14}
    given = [casadi.MX.sym(name, hinges, columns) for name, columns in names.items()]
    arrival = casadi.MX.sym("arrival", late)
    columns = [casadi.horzsplit(symbol) for symbol in given]
    deviation, velocity, disturbance, *pending, load_factor, velocity_factor, correction, _ = columns[0]
    (measured,) = columns[1]
    angles, setpoint, lowest, highest, load, detected_load, load_trust, *offsets = columns[2]
    velocity_offset, detected_velocity_offset, velocity_offset_trust = offsets
    *forecast, gain_deviation, gain_velocity, gain_disturbance, step, full = columns[3]

    is_measured = casadi.fabs(measured) < np.inf  # false for the NaN of a silent servo
    innovation = casadi.if_else(is_measured, measured - deviation, 0.0)
    deviation += gain_deviation * innovation
    velocity += gain_velocity * innovation
    disturbance = casadi.if_else(
        is_measured, disturbance + gain_disturbance * innovation, DISTURBANCE_DECAY * disturbance
    )
    heavier = _between(load_factor - load_trust * disturbance, *LOAD_ERROR_RANGE)
    faster = _between(velocity_factor - velocity_offset_trust * disturbance, *LOAD_ERROR_RANGE)
    disturbance += (heavier - load_factor) * detected_load + (faster - velocity_factor) * detected_velocity_offset

    nothing = casadi.MX(0.0)
    arrived = sum((arrival[k] * goal for k, goal in enumerate(pending)), nothing)
    acting = deviation, velocity, disturbance + arrived  # arriving corrections act like a disturbance during this tick
    motion = [sum((forecast[3 * k + i] * acting[i] for i in range(3)), nothing) for k in range(3)]
    motion[2] -= arrived

    expected, before = setpoint + heavier * load + faster * velocity_offset, setpoint + correction
    requested = expected - sum((restoring * float(RESTORING_GAINS[k]) * motion[k] for k in range(3)), nothing)
    goals = _between(_between(requested, before - step, before + step), lowest, highest)
    position = angles + motion[0]
    newest = _between(goals, position - full, position + full) - expected
    estimate = casadi.horzcat(*motion, newest, *pending[:-1], heavier, faster, goals - setpoint, goals)
    return casadi.Function("tick", [*given, arrival], [estimate])


def _between(values: casadi.MX, lower: casadi.MX | float, upper: casadi.MX | float) -> casadi.MX:
    return casadi.fmin(casadi.fmax(values, lower), upper)
