"""Addition of secondary motion to a certified motion within limits and clearance."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from zlib import crc32

import numpy as np

from kinesic.bml.block import Head, Pointing
from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.dynamics import Clearance
from kinesic.body.robot import SIDES, Robot
from kinesic.body.utterance import Utterance
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.hands.phases import ARM_PARTS
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.expressivity.style.standing import UNPOSED_STANDING
from kinesic.motion.condition import Conditioned
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.certify import find_overloaded_times
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.impact_limits import find_excess_times
from kinesic.planning.secondary.arcs import make_head_arcs
from kinesic.planning.secondary.arm_times import ArmCourse, find_arm_courses
from kinesic.planning.secondary.breath import make_breaths
from kinesic.planning.secondary.changes import Changes, reduce_amounts
from kinesic.planning.secondary.drift import make_drifts
from kinesic.planning.secondary.free_arm import swing_free_arms
from kinesic.planning.secondary.homeward import vary_returns
from kinesic.planning.secondary.offset_bumps import MotionChange, OffsetBump
from kinesic.planning.secondary.rest_changes import make_rest_changes
from kinesic.planning.secondary.succession import delay_hinges
from kinesic.planning.secondary.talking import make_speech_motion
from kinesic.planning.setup import MAX_BODY_WEIGHT, Setup

MAX_CLEARANCE_LOSS = 1e-6  # [m] tolerated loss of clearance where the clearance is already too small
REST_STREAM = 5  # index of the random number stream for changes of the rest posture


def add_secondary_motion(
    motion: Conditioned,
    times: Floats,
    clearance: Clearance,
    frames: KeyFrames,
    utterances: Mapping[str, Utterance],
    setup: Setup,
) -> tuple[Conditioned, Floats, Clearance]:
    """Add idle motion, speech motion and follow-through to a certified motion.

    No sync point moves, and leading hinges are at their keys at every stroke. Changes that violate a limit or the
    clearance are reduced, then left out: those of the arms first.

    Args:
        motion: certified and clear.
        times: (m,) [s] performance time.
        clearance: of the motion, at these times.
        frames: of the block.
        utterances: by speech id.
        setup: robot, limits and amount of idle motion.

    Returns:
        The motion, and times (k,) [s] with its clearance.
    """
    changes = _collect_offsets(motion, frames, utterances, setup)
    if not changes:
        return motion, times, clearance
    original, spans = motion.trajectory, _ChangeSpans(Changes(motion.trajectory, changes), setup.robot)
    amounts = spans.changes.within_limits(np.ones(len(changes)), np.ones(len(changes), dtype=np.bool_), setup.limits)
    summed = spans.changes.added(amounts)
    times, changed_clearance = scan_clearance(summed, setup.distances)
    checked = np.ones(len(times), dtype=np.bool_)
    violating = _find_violations(original, summed, times, (changed_clearance, clearance), checked, setup)
    while np.any(met := (amounts > 0.0) & spans.find_active_offsets(times, violating)):
        reduced = met & spans.moves_arm if np.any(met & spans.moves_arm) else met
        amounts = spans.changes.within_limits(reduce_amounts(amounts, reduced), reduced, setup.limits)
        summed = spans.changes.added(amounts)
        checked = spans.find_active_times(times, reduced)
        changed_clearance = _measure_again(changed_clearance, checked, summed.sample(times[checked])[0], setup)
        violating = np.where(
            checked,
            _find_violations(original, summed, times, (changed_clearance, clearance), checked, setup),
            violating,
        )
    return replace(motion, trajectory=summed), times, changed_clearance


@dataclass(frozen=True, eq=False)
class _ChangeSpans:
    """Hinges that secondary motion offsets move, and their time spans."""

    changes: Changes
    robot: Robot

    @cached_property
    def moves_arm(self) -> Flags:
        """Whether each offset moves an arm, (c,)."""
        joints = [joint for side in SIDES for joint in self.robot.arm(side).joints]
        return np.asarray(self.changes.moved[:, joints].any(axis=1))

    def find_sample_ranges(self, times: Floats) -> Indices:
        """Return the index range of the times within each offset, (c, 2).

        The columns are the first index, and one past the last.
        """
        begins, ends = np.array([(change.begin, change.end) for change in self.changes.offsets]).T
        return np.stack([times.searchsorted(begins, side="right"), times.searchsorted(ends)], axis=1)

    def find_active_offsets(self, times: Floats, violating: Flags) -> Flags:
        """Flag the offsets (c,) that are active at any flagged time.

        Args:
            times: (m,) [s].
            violating: (m,) whether limits are violated at each time.
        """
        first, last = self.find_sample_ranges(times).T
        before = np.append(0, np.cumsum(violating))
        return np.asarray(before[np.maximum(first, last)] > before[first])

    def find_active_times(self, times: Floats, offsets: Flags) -> Flags:
        """Flag the times (m,) at which any chosen offset is active."""
        changed_clearance: Flags = np.zeros(len(times), dtype=np.bool_)
        for first, last in self.find_sample_ranges(times)[offsets].tolist():
            changed_clearance[first:last] = True
        return changed_clearance


def _measure_again(before: Clearance, changed: Flags, angles: Floats, setup: Setup) -> Clearance:
    """Recompute the clearance at times with changed motion.

    Args:
        before: clearance before.
        changed: (m,) whether a time changed.
        angles: (k, n) [rad] at the changed times.
        setup: with the distances.
    """
    now = setup.distances.clearance(angles)
    distances, pairs = np.array(before.distances), list(before.pairs)
    distances[changed] = now.distances
    for k, pair in zip(np.flatnonzero(changed).tolist(), now.pairs, strict=True):
        pairs[k] = pair
    return Clearance(sealed(distances), pairs)


def _collect_offsets(
    motion: Conditioned, frames: KeyFrames, utterances: Mapping[str, Utterance], setup: Setup
) -> tuple[MotionChange, ...]:
    """Collect the secondary motion offsets of a block, except during pointing."""
    timeline, trajectory = frames.timeline, motion.trajectory
    zero, courses = trajectory.zero, tuple(find_arm_courses(frames, motion, setup.robot))
    changed_clearance: tuple[MotionChange, ...] = (
        *delay_hinges(courses, trajectory, setup.robot),
        *vary_returns(courses, trajectory, setup.variation, timeline.block.id, setup.robot),
        *_swing_free_arms(trajectory, courses, frames, setup),
        *_idle_offsets(trajectory, frames, utterances, setup),
    )
    aiming = [
        (zero + timed.times["start"], zero + timed.times["end"])
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Pointing)
    ]
    return tuple(
        change
        for change in changed_clearance
        if not any(begin < change.end and change.begin < end for begin, end in aiming)
    )


def _swing_free_arms(
    motion: Trajectory, courses: Sequence[ArmCourse], frames: KeyFrames, setup: Setup
) -> Iterator[OffsetBump]:
    """Yield offsets of resting arms that no other hand touches."""
    idling = setup.idling
    touched = {
        other: [motion.zero + frame.time for frame in frames.frames if frame.hands[side].touch in ARM_PARTS]
        for side, other in zip(SIDES, reversed(SIDES), strict=True)
    }
    seed = (idling.seed, frames.timeline.block.id)
    amount = idling.amount * min(setup.style.whole_body, MAX_BODY_WEIGHT)
    yield from swing_free_arms(courses, motion, amount, setup.robot, seed=seed, touched=touched)


def _idle_offsets(
    motion: Trajectory, frames: KeyFrames, utterances: Mapping[str, Utterance], setup: Setup
) -> Iterator[OffsetBump]:
    idling, robot, zero, timeline = setup.idling, setup.robot, motion.zero, frames.timeline
    chance = np.random.default_rng((idling.seed, crc32(timeline.block.id.encode())))
    part, prosody = idling.amount * min(setup.style.whole_body, MAX_BODY_WEIGHT), setup.style_prosody
    if idling.amount == 0.0:
        nods_alone = make_speech_motion(timeline, utterances, 0.0, robot, chance, prosody=prosody)
        yield from (change.later(zero) for change in nods_alone)
        return
    whole = max(zero + timeline.start, motion.start), max(zero + timeline.end, motion.end)
    yield from make_breaths(whole, idling.amount, robot, chance)
    touching = {
        side: [
            zero + frame.time
            for frame in frames.frames
            if frame.hands[side].touch is not None or frame.hands[side].aim is not None
        ]
        for side in SIDES
    }
    changing = np.random.default_rng((idling.seed, crc32(timeline.block.id.encode()), REST_STREAM))
    bearing = BlockContext(timeline.block, setup.context).bearing
    standing = bearing.standing if bearing.posture > 0.0 else UNPOSED_STANDING
    yield from make_rest_changes(motion, whole, setup, standing, changing)
    yield from make_drifts(motion, idling.amount, robot, chance, touching)
    speech_motion = make_speech_motion(timeline, utterances, part, robot, chance, prosody=prosody)
    yield from (change.later(zero) for change in speech_motion)
    nods = [
        (zero + min(timed.times.values()), zero + max(timed.times.values()))
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Head)
    ]
    yield from make_head_arcs(motion, nods, part, robot, chance)


def _find_violations(
    original: Trajectory,
    summed: Trajectory,
    times: Floats,
    clearances: tuple[Clearance, Clearance],
    checked: Flags,
    setup: Setup,
) -> Flags:
    """Flag the times (m,) with too little clearance, overload or hard contacts.

    Times that violate without the changes do not count. Drives and contacts are checked at the `checked` times.
    """
    now, before = clearances
    distances = before.distances[np.minimum(np.arange(len(times)), len(before.distances) - 1)]
    least = np.minimum(setup.robot.min_clearance + LAG_RESERVE, distances - MAX_CLEARANCE_LOSS)
    return (
        (now.distances < least)
        | np.isin(times, find_overloaded_times(original, summed, times[checked], setup))
        | np.isin(times, find_excess_times(original, summed, times[checked], setup))
    )
