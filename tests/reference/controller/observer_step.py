"""One tick of the observer as a CasADi graph."""

from functools import lru_cache

import casadi
import numpy as np

from kinesic.controller.observer import Observer
from kinesic.controller.observer_step import LOAD_ERROR_RANGE, PUSH_DECAY, RESTORING_GAINS


def advance(observer: Observer, belief, deviation, inputs):
    """Return the belief (7 + h, n) one tick later."""
    hinges, late = len(observer.lower), len(observer.arrival)
    gains = np.concatenate([observer.forecast.reshape(9, hinges), observer.gain, [observer.step, observer.full]])
    tick = compile_tick(hinges, late, observer.restoring)
    return np.array(tick(belief.T, deviation, inputs.T, gains.T, observer.arrival)).T


@lru_cache(maxsize=8)
def compile_tick(hinges: int, late: int, restoring: float = 1.0) -> casadi.Function:
    """Build one observer tick.

    Args:
        hinges: number of hinges.
        late: number of corrections under way.
        restoring: fraction of `RESTORING` that is used.

    Returns:
        From belief (n, 7 + late), deviation (n,), inputs (n, 10), gains (n, 14) and arrival (late,) to the belief of
        this tick.
    """
    names = {"belief": 7 + late, "measured": 1, "inputs": 10, "gains": 14}
    given = [casadi.MX.sym(name, hinges, columns) for name, columns in names.items()]
    arrival = casadi.MX.sym("arrival", late)
    columns = [casadi.horzsplit(symbol) for symbol in given]
    deviation, speed, push, *under_way, share, pace, correction, _ = columns[0]
    (measured,), (angles, led, lowest, highest, load, noticed, trust, lead, noticed_lead, trust_lead) = columns[1:3]
    *forecast, gain_deviation, gain_speed, gain_push, step, full = columns[3]

    answers = casadi.fabs(measured) < np.inf  # a silent servo's NaN is not
    innovation = casadi.if_else(answers, measured - deviation, 0.0)
    deviation += gain_deviation * innovation
    speed += gain_speed * innovation
    push = casadi.if_else(answers, push + gain_push * innovation, PUSH_DECAY * push)
    learned, learned_pace = (
        _between(share - trust * push, *LOAD_ERROR_RANGE),
        _between(pace - trust_lead * push, *LOAD_ERROR_RANGE),
    )
    push += (learned - share) * noticed + (learned_pace - pace) * noticed_lead  # what is learned is no longer push

    nothing = casadi.MX(0.0)
    arrived = sum((arrival[k] * goal for k, goal in enumerate(under_way)), nothing)
    acting = deviation, speed, push + arrived  # what arrives enters like a push, for this tick
    motion = [sum((forecast[3 * k + i] * acting[i] for i in range(3)), nothing) for k in range(3)]
    motion[2] -= arrived

    foreseen, before = led + learned * load + learned_pace * lead, led + correction
    asked = foreseen - sum((restoring * float(RESTORING_GAINS[k]) * motion[k] for k in range(3)), nothing)
    goals = _between(_between(asked, before - step, before + step), lowest, highest)
    position = angles + motion[0]
    newest = _between(goals, position - full, position + full) - foreseen
    belief = casadi.horzcat(*motion, newest, *under_way[:-1], learned, learned_pace, goals - led, goals)
    return casadi.Function("tick", [*given, arrival], [belief])


def _between(values: casadi.MX, lower: casadi.MX | float, upper: casadi.MX | float) -> casadi.MX:
    return casadi.fmin(casadi.fmax(values, lower), upper)
