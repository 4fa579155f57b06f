"""Certified motions with optimal key times from a nonlinear program.

`certify` searches key times by linear programs, within milliseconds. The nonlinear program of `motion.optimum` finds
times that move less, within seconds, so that it serves offline only. Its times are certified like any others.
"""

from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.motion.budget import UNLIMITED_BUDGET, Budget
from kinesic.motion.condition import LEAD_IN, Conditioned
from kinesic.motion.key_time_lp import shift_cost
from kinesic.motion.keys import Bond, KeyPosture, Keys
from kinesic.motion.optimum import best_times
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.planning.certify import certify
from kinesic.planning.setup import Setup

MIN_SHIFT_COST = 0.01  # [s] weighted sum of key shifts below which a plan is not optimised


def certify_optimal(
    keys: tuple[KeyPosture, ...],
    setup: Setup,
    bonds: tuple[Bond, ...] = (),
    *,
    limit_scale: float = 1.0,
    budget: Budget = UNLIMITED_BUDGET,
    memory: PlaneMemory | None = None,
) -> Conditioned:
    """Plan a motion without overload, with minimum key shifts found by IPOPT.

    Args:
        keys: at least two, the first and the last keyed in all hinges.
        setup: limits and dynamics.
        bonds: between sync points of different behaviours.
        limit_scale: fraction of the limits with which key times are found.
        budget: for all searches of key times together.
        memory: cutting planes of earlier searches for the same block.

    Returns:
        The motion of `certify` if IPOPT finds no solution or one that moves no less once it is certified.
    """
    motion = certify(keys, setup, bonds, limit_scale=limit_scale, budget=budget, memory=memory)
    requested = Keys.of(keys, setup.limits, bonds)
    cost = shift_cost(requested, motion.planned)
    if cost < MIN_SHIFT_COST:
        return motion
    best = best_times(requested, motion, setup.limits, LEAD_IN)
    if best is None:
        return motion
    optimal = _certify_at(requested.interpolate_path_times(best.times), keys, setup, bonds, limit_scale, budget)
    return optimal if shift_cost(requested, optimal.planned) < cost else motion


def _certify_at(
    times: Floats,
    keys: tuple[KeyPosture, ...],
    setup: Setup,
    bonds: tuple[Bond, ...],
    limit_scale: float,
    budget: Budget,
) -> Conditioned:
    """Plan a motion without overload through the keys at new times.

    `certify` may shift the new times further. The result reports shifts from the requested times of the keys.

    Args:
        times: (m,) [s] new key times.
        keys: with the requested times.
        setup: limits and dynamics.
        bonds: between sync points of different behaviours.
        limit_scale: fraction of the limits with which key times are found.
        budget: for all searches of key times together.
    """
    order = np.argsort(times, kind="stable")
    moved = tuple(replace(keys[row], time=float(times[row])) for row in order)
    lead_in = max(LEAD_IN - (keys[0].time - float(times[0])), 0.0)
    motion = certify(moved, setup, bonds, limit_scale=limit_scale, lead_in=lead_in, budget=budget)
    planned = np.empty(len(keys))
    planned[order] = motion.planned
    bottlenecks = {(int(order[i]), int(order[j])): bottleneck for (i, j), bottleneck in motion.bottlenecks.items()}
    return replace(
        motion, requested_times=sealed([key.time for key in keys]), planned=sealed(planned), bottlenecks=bottlenecks
    )
