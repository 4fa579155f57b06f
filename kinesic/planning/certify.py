"""Certification of motions: duty limits tightened until no drive is overloaded.

The duty limit of `condition` treats each hinge alone, with its worst load. Loads by other hinges are known only from
the motion: if inverse dynamics finds a drive above full duty, its limit is tightened.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from kinesic.body.arrays import Floats, Indices, find_distinct_rows
from kinesic.body.limits import Limits
from kinesic.motion.budget import UNLIMITED_BUDGET, Budget
from kinesic.motion.condition import LEAD_IN, Conditioned, condition
from kinesic.motion.keys import Bond, KeyPosture
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.impact_limits import slow_hinges
from kinesic.planning.setup import Setup

MAX_DUTY = 0.995  # largest duty at the knots, as a fraction of full PWM; slightly higher between them
LOW_DUTY = 0.5  # duty at a knot below which full duty cannot occur within two knots, because jerk is limited
TIGHTENING_FACTOR = 0.93  # factor on an overloaded servo's duty limit, in addition to 1 / its peak duty
MAX_TIGHTENINGS = 6  # largest number of replanning rounds with lower duty limits
MAX_SLOWED_ROUNDS = 12  # largest number of replanning rounds under a policy of contacts with people
KNOTS_PER_WINDOW = 4096  # largest number of knots whose torques are computed together, which bounds the memory
STATE_TOLERANCE = 1e-5  # [rad, rad/s, rad/s^2] grid to which states are rounded, to evaluate equal states once


def certify(
    keys: tuple[KeyPosture, ...],
    setup: Setup,
    bonds: tuple[Bond, ...] = (),
    *,
    limit_scale: float = 1.0,
    lead_in: float = LEAD_IN,
    budget: Budget = UNLIMITED_BUDGET,
    memory: PlaneMemory | None = None,
) -> Conditioned:
    """Plan a motion through keys without overloading any servo.

    After `MAX_TIGHTENINGS` attempts the last motion is returned, even if it still overloads a servo.

    Args:
        keys: at least two, the first and the last keyed in all hinges.
        setup: limits and dynamics.
        bonds: between sync points of different behaviours.
        limit_scale: fraction of the limits with which key times are found.
        lead_in: [s] by which the first key may come earlier.
        budget: for all searches of key times together.
        memory: cutting planes of earlier searches for the same block.
    """
    search = partial(
        condition,
        keys,
        bonds=bonds,
        limit_scale=limit_scale,
        lead_in=lead_in,
        budget=budget,
        memory=memory or PlaneMemory(),
    )
    return keep_duties(search, setup)


def keep_duties(search: Callable[[Limits], Conditioned], setup: Setup) -> Conditioned:
    """Replan a motion with tighter limits until no servo is overloaded.

    Under a policy of contacts with people, hinges are slowed, too. After `MAX_TIGHTENINGS` attempts, or
    `MAX_SLOWED_ROUNDS` under a policy, the last motion is returned, even if it still violates a limit.

    Args:
        search: plans the motion within given limits.
        setup: limits and dynamics.
    """
    motion = search(setup.limits)
    factors, limits = np.ones(len(setup.limits.duty)), setup.limits
    overloads = 0
    for attempt in range(MAX_TIGHTENINGS if setup.policy is None else MAX_SLOWED_ROUNDS):
        peaks = compute_peak_duties(motion.trajectory, setup)
        is_overloaded = peaks > MAX_DUTY
        slowed = slow_hinges(motion.trajectory, limits.speed, setup, attempt)
        if not is_overloaded.any() and slowed is None:
            break
        if is_overloaded.any():
            factors[is_overloaded] *= TIGHTENING_FACTOR / peaks[is_overloaded]
            if overloads >= MAX_TIGHTENINGS // 2:  # any hinge may cause the overload
                factors *= TIGHTENING_FACTOR
            overloads += 1
        if slowed is not None:
            limits = replace(limits, speed=slowed)
        motion = search(limits.scaled(factors))
    return motion


def compute_peak_duties(trajectory: Trajectory, setup: Setup) -> Floats:
    """Compute each servo's peak duty (n,) during a motion.

    Duties are fractions of full PWM, sampled at the knots. Repeated states are evaluated once.
    """
    times = trajectory.start + np.arange(0.0, trajectory.duration, KNOT_INTERVAL)
    windows = (
        _duties_at(trajectory, times[k : k + KNOTS_PER_WINDOW], setup)[0]
        for k in range(0, len(times), KNOTS_PER_WINDOW)
    )
    return np.asarray(np.max([duty.max(axis=0) for duty in windows], axis=0))


def find_overloaded_times(motion: Trajectory, changed: Trajectory, times: Floats, setup: Setup) -> Floats:
    """Return times [s] at which a changed motion newly overloads a servo.

    A drive counts if its duty exceeds `MAX_DUTY` and its duty without the change. Jerk is limited, so that a time
    between two others is skipped if all drives have little duty at both.
    """
    now = _duty_at_each(changed, times[::2], setup)
    is_low, count = now.max(axis=1) <= LOW_DUTY, len(times) // 2
    intervals = np.append(times[2::2], np.inf)[:count] - times[::2][:count]
    checked_between = times[1::2][
        ~(is_low[:count] & np.append(is_low[1:], False)[:count] & (intervals < 2.5 * KNOT_INTERVAL))
    ]
    checked_times = np.append(times[::2], checked_between)
    now = np.vstack([now, _duty_at_each(changed, checked_between, setup)])
    is_overloaded = np.any(now > MAX_DUTY, axis=1)
    if not is_overloaded.any():
        return np.zeros(0)
    before = _duty_at_each(motion, checked_times[is_overloaded], setup)
    return np.asarray(checked_times[is_overloaded][np.any(now[is_overloaded] > np.maximum(MAX_DUTY, before), axis=1)])


def _duty_at_each(trajectory: Trajectory, times: Floats, setup: Setup) -> Floats:
    """Compute the servo duties (m, n) at times (m,) [s]."""
    duties_of_states, rows = _duties_at(trajectory, times, setup)
    return np.asarray(duties_of_states[rows])


def _duties_at(trajectory: Trajectory, times: Floats, setup: Setup) -> tuple[Floats, Indices]:
    """Compute servo duties, evaluating repeated motion states only once.

    Returns:
        (k, n) duties, and (m,) the index of the state at each time.
    """
    states = trajectory.sample(times)
    chosen, rows = find_distinct_rows(np.hstack(states), STATE_TOLERANCE)
    angles, speeds, accelerations = (state[chosen] for state in states)
    torques = setup.dynamics.torques(angles, speeds, accelerations)
    return np.abs(torques / setup.robot.drives.stall + speeds * setup.limits.viscous), rows
