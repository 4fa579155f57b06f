"""Lays secondary motion, and what is late, on a certified motion, as far as limits, torques and clearance allow it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from zlib import crc32

import numpy as np

from kinesic.bml.block import Head, Pointing, Timeline
from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES, Robot
from kinesic.body.utterance import Utterance
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.condition import Conditioned
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.certify import overloaded_times
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.secondary.arcs import arcs
from kinesic.planning.secondary.arm_times import arm_courses
from kinesic.planning.secondary.breath import breaths
from kinesic.planning.secondary.changes import Changes, lessened
from kinesic.planning.secondary.drift import drifts
from kinesic.planning.secondary.homeward import ways_home
from kinesic.planning.secondary.succession import later_hinges
from kinesic.planning.secondary.swells import MotionChange, Swell
from kinesic.planning.secondary.talking import talking
from kinesic.planning.setup import Setup

NEARER = 1e-6  # [m] by which clearance may shrink where it is scarce
LIVELIEST = 1.5  # times a style's share of the body


def add_secondary_motion(
    motion: Conditioned,
    times: Floats,
    clearance: Clearance,
    frames: KeyFrames,
    utterances: Mapping[str, Utterance],
    setup: Setup,
) -> tuple[Conditioned, Floats, Clearance]:
    """Lets the body breathe, stray from poses that it holds, and move its head as it speaks; wrists follow shoulders.

    No sync point comes at another time, and what leads is at its key at every stroke. What brings a hinge beyond a
    limit, or a segment too near to another one, becomes less, and is left out where that is not enough: first what arms
    do, then the rest.

    Args:
        motion: certified and clear.
        times: (m,) [s] performance time.
        clearance: of the motion, at these times.
        frames: of the block.
        utterances: of its speeches, by their ids.
        setup: robot, limits, and how lively it is.

    Returns:
        The motion, and times (k,) [s] with its clearance.
    """
    changes = _changes(motion, frames, utterances, setup)
    if not changes:
        return motion, times, clearance
    alone, every = motion.trajectory, _Every(Changes(motion.trajectory, changes), setup.robot)
    amounts = every.of.within_limits(np.ones(len(changes)), np.ones(len(changes), dtype=np.bool_), setup.limits)
    laid = every.of.added(amounts)
    times, found = scan_clearance(laid, setup.distances)
    chosen = np.ones(len(times), dtype=np.bool_)
    bad = _hindered(alone, laid, times, (found, clearance), chosen, setup)
    while np.any(met := (amounts > 0.0) & every.met(times, bad)):
        less = met & every.of_arms if np.any(met & every.of_arms) else met
        amounts = every.of.within_limits(lessened(amounts, less), less, setup.limits)
        laid = every.of.added(amounts)
        chosen = every.touched(times, less)
        found = _measure_again(found, chosen, laid.sample(times[chosen])[0], setup)
        bad = np.where(chosen, _hindered(alone, laid, times, (found, clearance), chosen, setup), bad)
    return replace(motion, trajectory=laid), times, found


@dataclass(frozen=True, eq=False)
class _Every:
    """The changes of a motion, by the joints that they move and the times at which they do."""

    of: Changes
    robot: Robot

    @cached_property
    def of_arms(self) -> Flags:
        """(c,) which of them move an arm."""
        joints = [joint for side in SIDES for joint in self.robot.arm(side).joints]
        return np.asarray(self.of.moved[:, joints].any(axis=1))

    def under_way(self, times: Floats) -> Indices:
        """(c, 2) at which of times (m,) [s], in order, each begins to be under way, and at which it no longer is."""
        begins, ends = np.array([(change.begin, change.end) for change in self.of.every]).T
        return np.stack([times.searchsorted(begins, side="right"), times.searchsorted(ends)], axis=1)

    def met(self, times: Floats, bad: Flags) -> Flags:
        """(c,) which of them are under way when they must not: (m,) at (m,) times [s]."""
        first, last = self.under_way(times).T
        before = np.append(0, np.cumsum(bad))
        return np.asarray(before[np.maximum(first, last)] > before[first])

    def touched(self, times: Floats, chosen: Flags) -> Flags:
        """(m,) at which times (m,) [s] any of some changes (c,) is under way."""
        found: Flags = np.zeros(len(times), dtype=np.bool_)
        for first, last in self.under_way(times)[chosen].tolist():
            found[first:last] = True
        return found


def _measure_again(found: Clearance, changed: Flags, angles: Floats, setup: Setup) -> Clearance:
    """The clearance where it changed at some times, with angles (k, n) [rad] at them."""
    now = setup.distances.clearance(angles)
    distances, pairs = np.array(found.distances), list(found.pairs)
    distances[changed] = now.distances
    for k, pair in zip(np.flatnonzero(changed).tolist(), now.pairs, strict=True):
        pairs[k] = pair
    return Clearance(sealed(distances), pairs)


def _changes(
    motion: Conditioned, frames: KeyFrames, utterances: Mapping[str, Utterance], setup: Setup
) -> tuple[MotionChange, ...]:
    """Makes the changes that a block leaves room for; none while an arm points at something."""
    timeline, trajectory = frames.timeline, motion.trajectory
    zero, courses = trajectory.zero, tuple(arm_courses(frames, motion, setup.robot))
    found: tuple[MotionChange, ...] = (
        *later_hinges(courses, trajectory, setup.robot),
        *ways_home(courses, trajectory, setup.variation, timeline.block.id, setup.robot),
        *_swells(trajectory, timeline, utterances, setup),
    )
    aiming = [
        (zero + timed.times["start"], zero + timed.times["end"])
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Pointing)
    ]
    return tuple(each for each in found if not any(begin < each.end and each.begin < end for begin, end in aiming))


def _swells(
    motion: Trajectory, timeline: Timeline, utterances: Mapping[str, Utterance], setup: Setup
) -> Iterator[Swell]:
    idling, robot, zero = setup.idling, setup.robot, motion.zero
    if idling.amount == 0.0:
        return
    chance = np.random.default_rng((idling.seed, crc32(timeline.block.id.encode())))
    part = idling.amount * min(setup.style.whole_body, LIVELIEST)
    whole = max(zero + timeline.start, motion.start), max(zero + timeline.end, motion.end)
    yield from breaths(whole, idling.amount, robot, chance)
    yield from drifts(motion, idling.amount, robot, chance)
    yield from (each.later(zero) for each in talking(timeline, utterances, part, robot, chance))
    nods = [
        (zero + min(timed.times.values()), zero + max(timed.times.values()))
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Head)
    ]
    yield from arcs(motion, nods, part, robot, chance)


def _hindered(
    alone: Trajectory,
    laid: Trajectory,
    times: Floats,
    clearances: tuple[Clearance, Clearance],
    chosen: Flags,
    setup: Setup,
) -> Flags:
    """Finds at which times (m,) a motion with changes is too near to itself or overloads a drive, and alone is not.

    Drives are looked at where that is `chosen`.
    """
    now, before = clearances
    distances = before.distances[np.minimum(np.arange(len(times)), len(before.distances) - 1)]
    least = np.minimum(setup.robot.least_clearance + LAG_RESERVE, distances - NEARER)
    return (now.distances < least) | np.isin(times, overloaded_times(alone, laid, times[chosen], setup))
