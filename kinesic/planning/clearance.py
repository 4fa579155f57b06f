"""Collision avoidance of motions by detours and dropped behaviours."""

from collections.abc import Mapping
from functools import partial
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance, Distances
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.budget import UNLIMITED_BUDGET, Budget
from kinesic.motion.condition import Conditioned
from kinesic.motion.key_time_lp import KeyTimeProblem, solve_key_times
from kinesic.motion.keys import Bond, KeyPosture, Keys
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.trajectory import Trajectory, stay
from kinesic.planning.certify import certify
from kinesic.planning.detour import ClearPostures, add_detours
from kinesic.planning.posture_course import SCAN_RATE, PostureCourse
from kinesic.planning.postures import Postures
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import find_planned_spans, list_keyed_syncs


class Conditioner(Protocol):
    """Function that fits a motion through keys to the servo limits."""

    def __call__(
        self,
        keys: tuple[KeyPosture, ...],
        setup: Setup,
        bonds: tuple[Bond, ...] = ...,
        /,
        *,
        limit_scale: float = ...,
        budget: Budget = ...,
        memory: PlaneMemory | None = ...,
    ) -> Conditioned:
        """Return a motion through the keys within the servo limits.

        `limit_scale` below 1 gives it more time, so that it is nearer to the desired path.
        """


LAG_RESERVE = 0.004  # [m] extra clearance in plans for the tracking lag of the servos
MIN_LAG_RESERVE = 0.002  # [m] smallest remaining `LAG_RESERVE`; with less, a behaviour is dropped
MAX_REPAIRS = 2  # largest number of replanning rounds for a motion with too little clearance
MAX_SLOWED_REPAIRS = 6  # largest number of replanning rounds if contacts with people are limited, which slows hinges
SAMPLE_COST = 3.0  # [knot intervals] work charged to the budget per clearance sample of a replanned motion
REPAIR_MARGIN = 0.002  # [m] margin by which a repair raises the required clearance beyond the missing clearance
LIMIT_REDUCTION_FACTOR = 0.8  # factor on the limits used for key times, applied when no detour helps
COLLISION_SPAN = 2.0  # [s] collisions up to this time from the worst one are attributed to the same behaviour


def keep_clear(
    solved: Postures,
    setup: Setup,
    bonds: tuple[Bond, ...] = (),
    *,
    conditioned: Conditioner = certify,
    repairs: int | None = None,
    budget: Budget = UNLIMITED_BUDGET,
) -> tuple[Postures, Conditioned, Floats, Clearance]:
    """Plan a motion through postures with detours around the body.

    Detours are first searched in the desired motion, which is cheap. If the conditioned motion comes nearer, detours
    are searched there and it is conditioned again, with more time if no detour helps. It may still be too close.

    Args:
        solved: postures of a block.
        setup: robot, limits and distances.
        bonds: between sync points of different behaviours.
        conditioned: turns keys into a motion within the limits.
        repairs: largest number of repeated conditionings; None: `MAX_REPAIRS`, or more under a policy.
        budget: for all motions; once it is spent, no motion is conditioned again.

    Returns:
        The postures with detours, the motion, performance times (m,) [s] and the clearance at them.
    """
    if len(solved.postures) < 2:
        rest = setup.robot.skeleton.rest
        still = Conditioned(stay(rest), np.zeros(0), np.zeros(0), {}, np.zeros(len(rest)))
        return solved, still, *scan_clearance(still.trajectory, setup.distances)
    limit_scale, min_clearance = 1.0, setup.robot.min_clearance + LAG_RESERVE
    required = min_clearance
    keys = Keys.of(solved.postures, setup.limits)
    planned = keys.requested_times if keys.is_spaced else solve_key_times(KeyTimeProblem(keys, keys.gaps, 0.0))
    add_detours_to = partial(add_detours, distances=setup.distances, cache=ClearPostures(setup.robot, setup.distances))
    postures = add_detours_to(_course(solved.postures, planned, setup), min_clearance=min_clearance).postures
    motion = conditioned(postures, setup, bonds, limit_scale=limit_scale)
    times, clearance = scan_clearance(motion.trajectory, setup.distances)
    if repairs is None:
        repairs = MAX_REPAIRS if setup.policy is None else MAX_SLOWED_REPAIRS
    for _ in range(repairs):
        deficit = min_clearance - float(clearance.distances[clearance.worst])
        if deficit <= 0.0:
            break
        budget.spend(SAMPLE_COST * len(times))
        if budget.spent:
            break
        course = _course(postures, motion.planned, setup).with_deviation(motion.trajectory)
        changed = add_detours_to(course, min_clearance=required).postures
        required += deficit + REPAIR_MARGIN
        if changed == postures:  # without helpful detours, more time brings the motion nearer to the desired one
            limit_scale *= LIMIT_REDUCTION_FACTOR
        postures = changed
        motion = conditioned(postures, setup, bonds, limit_scale=limit_scale)
        times, clearance = scan_clearance(motion.trajectory, setup.distances)
    return Postures(postures, solved.misses), motion, times, clearance


def _course(postures: tuple[KeyPosture, ...], planned: Floats, setup: Setup) -> PostureCourse:
    return PostureCourse(postures, planned, setup.robot, setup.limits)


def scan_clearance(trajectory: Trajectory, distances: Distances) -> tuple[Floats, Clearance]:
    """Sample the self-clearance of a trajectory at 100 Hz.

    Returns performance times (m,) [s], the end included, and the clearance at them.
    """
    times = trajectory.start + np.append(np.arange(0.0, trajectory.duration, 1.0 / SCAN_RATE), trajectory.duration)
    return times, distances.clearance(trajectory.angles(times))


def find_colliding_behaviours(
    frames: KeyFrames, motion: Conditioned, times: Floats, clearance: Clearance, robot: Robot
) -> dict[str, str]:
    """Find the behaviours to drop because of collisions, with reasons.

    Within `COLLISION_SPAN` only the closest sample counts, as the others may be clear without its behaviour. The result
    is empty for a clear motion.
    """
    if not frames.frames:
        return {}
    close = np.flatnonzero(clearance.distances < robot.min_clearance + MIN_LAG_RESERVE)
    close = close[np.argsort(clearance.distances[close], kind="stable")]
    spans_of = find_planned_spans((name, planned) for name, _, _, planned in list_keyed_syncs(frames, motion))
    reasons: dict[str, str] = {}
    while close.size:
        worst = int(close[0])
        pair, time = clearance.pairs[worst], float(times[worst] - motion.trajectory.zero)
        why = f"brings {pair[0]} within {1000 * clearance.distances[worst]:.0f} mm of {pair[1]} at {time:.2f} s"
        reasons.setdefault(_find_responsible_behaviour(pair, time, spans_of, frames, robot), why)
        close = close[np.abs(times[close] - times[worst]) > COLLISION_SPAN]
    return reasons


def _find_responsible_behaviour(
    pair: tuple[str, str], time: float, spans_of: Mapping[str, tuple[float, float]], frames: KeyFrames, robot: Robot
) -> str:
    """Return the behaviour nearest in time that moves the colliding body parts.

    If none moves these parts, the nearest behaviour of all is returned.
    """
    parts = {f"{side}_hand" for side in robot.sides if set(pair) & robot.arm(side).bodies} or {"torso", "head"}
    away = {name: max(start - time, time - end, 0.0) for name, (start, end) in spans_of.items()}
    return min(away, key=lambda name: (not frames.uses.get(name, frozenset()) & parts, away[name], name))
