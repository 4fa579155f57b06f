"""Keeps a motion clear of the body by detours, or names the behaviour that must go."""

from collections.abc import Mapping
from functools import partial
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance, Distances
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.budget import ENDLESS, Budget
from kinesic.motion.condition import Conditioned
from kinesic.motion.key_time_lp import KeyTimeProblem, relax_key_times
from kinesic.motion.keys import Bond, KeyPosture, Keys
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.trajectory import Trajectory, stay
from kinesic.planning.certify import certify
from kinesic.planning.detour import SCAN_RATE, ClearPostures, PostureCourse, lead_around
from kinesic.planning.postures import Postures
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import on_keys, planned_spans


class Conditioner(Protocol):
    """Makes a motion through keys one that the servos can follow."""

    def __call__(
        self,
        keys: tuple[KeyPosture, ...],
        setup: Setup,
        bonds: tuple[Bond, ...] = ...,
        /,
        *,
        ease: float = ...,
        budget: Budget = ...,
        memory: PlaneMemory | None = ...,
    ) -> Conditioned:
        """At `ease` below 1 key times leave room, so that the path is nearer to the desired one."""


LAG_RESERVE = 0.004  # [m] kept in the plan for what the servos lag behind it
LEAST_RESERVE = 0.002  # [m] of it that has to be there: less is not worth a behaviour
REPAIRS = 2  # times that a motion is conditioned again because it comes nearer than it should
SAMPLE_COST = 3.0  # budget units per sample of a motion that is conditioned and scanned again
REPAIR = 0.002  # [m] that a second detour keeps over what the first one lacked
EASIER = 0.8  # times the limits, where no detour helps a motion that strays from the desired one
TOGETHER = 2.0  # [s] within which one behaviour may be what brings segments too near at all times


def keep_clear(
    solved: Postures,
    setup: Setup,
    bonds: tuple[Bond, ...] = (),
    *,
    conditioned: Conditioner = certify,
    repairs: int = REPAIRS,
    budget: Budget = ENDLESS,
) -> tuple[Postures, Conditioned, Floats, Clearance]:
    """Conditions the postures, and leads the motion around the body where it comes too near.

    Detours are looked for in the desired motion, which costs little; only where the conditioned one comes nearer,
    detours are looked for there, too, and it is conditioned again; with more time where none helps.

    Args:
        solved: postures of a block.
        setup: robot, limits and distances.
        bonds: between sync points of different behaviours.
        conditioned: makes a motion one that the servos can follow.
        repairs: how many times at most it is conditioned again.
        budget: for the length of all motions; once it is spent, no motion is conditioned again.

    Returns:
        The postures with detours, the motion, performance times (m,) [s] and the clearance at them.
    """
    if len(solved.postures) < 2:
        rest = setup.robot.skeleton.rest
        still = Conditioned(stay(rest), np.zeros(0), np.zeros(0), {}, np.zeros(len(rest)))
        return solved, still, *scan_clearance(still.trajectory, setup.distances)
    ease, least = 1.0, setup.robot.least_clearance + LAG_RESERVE
    wanted = least
    keys = Keys.of(solved.postures, setup.limits)
    planned = keys.asked if keys.spaced else relax_key_times(KeyTimeProblem(keys, keys.gaps, 0.0))
    around = partial(lead_around, distances=setup.distances, known=ClearPostures(setup.robot, setup.distances))
    postures = around(_course(solved.postures, planned, setup), least=least).postures
    motion = conditioned(postures, setup, bonds, ease=ease)
    times, clearance = scan_clearance(motion.trajectory, setup.distances)
    for _ in range(repairs):
        lacking = least - float(clearance.distances[clearance.worst])
        if lacking <= 0.0:
            break
        budget.spend(SAMPLE_COST * len(times))
        if budget.spent:
            break
        course = _course(postures, motion.planned, setup).straying(motion.trajectory)
        changed = around(course, least=wanted).postures
        wanted += lacking + REPAIR
        if changed == postures:  # no detour helps: with more time the motion is nearer to the desired one
            ease *= EASIER
        postures = changed
        motion = conditioned(postures, setup, bonds, ease=ease)
        times, clearance = scan_clearance(motion.trajectory, setup.distances)
    return Postures(postures, solved.misses), motion, times, clearance


def _course(postures: tuple[KeyPosture, ...], planned: Floats, setup: Setup) -> PostureCourse:
    return PostureCourse(postures, planned, setup.robot, setup.limits)


def scan_clearance(trajectory: Trajectory, distances: Distances) -> tuple[Floats, Clearance]:
    """Measures the clearance of a motion at times (m,) [s]."""
    times = trajectory.start + np.append(np.arange(0.0, trajectory.duration, 1.0 / SCAN_RATE), trajectory.duration)
    return times, distances.clearance(trajectory.angles(times))


def culprits(
    frames: KeyFrames, motion: Conditioned, times: Floats, clearance: Clearance, robot: Robot
) -> dict[str, str]:
    """Finds the behaviours that bring two segments too near, and why; empty when the motion is clear.

    Of near times only the worst counts: when its behaviour is gone, the others may be clear.
    """
    if not frames.frames:
        return {}
    close = np.flatnonzero(clearance.distances < robot.least_clearance + LEAST_RESERVE)
    close = close[np.argsort(clearance.distances[close], kind="stable")]
    spans_of = planned_spans((name, planned) for name, _, _, planned in on_keys(frames, motion))
    found: dict[str, str] = {}
    while close.size:
        worst = int(close[0])
        pair, at = clearance.pairs[worst], float(times[worst] - motion.trajectory.zero)
        why = f"brings {pair[0]} within {1000 * clearance.distances[worst]:.0f} mm of {pair[1]} at {at:.2f} s"
        found.setdefault(_culprit(pair, at, spans_of, frames, robot), why)
        close = close[np.abs(times[close] - times[worst]) > TOGETHER]
    return found


def _culprit(
    pair: tuple[str, str], at: float, spans_of: Mapping[str, tuple[float, float]], frames: KeyFrames, robot: Robot
) -> str:
    """The behaviour of these parts that is nearest in time; where none is theirs, the nearest of all."""
    parts = {f"{side}_hand" for side in SIDES if set(pair) & robot.arm(side).bodies} or {"torso", "head"}
    away = {name: max(start - at, at - end, 0.0) for name, (start, end) in spans_of.items()}
    return min(away, key=lambda name: (not frames.uses.get(name, frozenset()) & parts, away[name], name))
