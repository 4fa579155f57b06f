"""Benchmark of liveliness during a story: stillness, frozen holds and gaze.

The story is performed with all default options, as through the public entry point.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.body.arrays import Flags, Floats
from kinesic.body.config import CONFIGS
from kinesic.body.robot import SIDES
from kinesic.expressivity.style.style import Style
from kinesic.planning.plan import Plan
from kinesic.planning.secondary.drift import MIN_HOLD_TIME
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

STORY_STYLES = ("neutral", "calm", "joyful")  # styles in which the story is planned
STORY_SEED = 0  # random seed of the story
SAMPLE_STEP = 0.02  # [s] interval between samples of the story's motion
STILL_TRUNK_SPEED = np.radians(0.1)  # [rad/s] speed below which the trunk counts as still
STILL_HEAD_SPEED = np.radians(0.5)  # [rad/s] speed below which the head counts as still
STILL_SPEED = np.radians(0.5)  # [rad/s] speed below which a joint counts as still
ASIDE_ANGLE = np.radians(7.0)  # [rad] angle from the listener beyond which the head looks aside
FROZEN_MOTION = 0.002  # [m] extent of the wrist's motion below which a hold counts as frozen
MAX_HOLD_CHANGE = 0.06  # [rad] largest joint change between the keys of a hold, as the trunk may turn
MIN_HOLD_OFFSET = 0.05  # [rad] smallest offset of a held arm from rest
MAX_STROKE_SHIFT = 0.05  # [s] shift beyond which a stroke misses its word


@dataclass(frozen=True)
class StoryMeasures:
    """Liveliness during the spoken part of a story."""

    still_trunk: float  # fraction of the time with a still trunk
    still_head: float  # fraction of the time with a still head
    longest_trunk: float  # [s] longest stillness of the trunk
    longest_all: float  # [s] longest stillness of all joints
    holds: tuple[float, ...]  # [m] extent of the wrist's motion in each hold
    aside: float  # fraction of the time with the head turned away from the listener
    missed: tuple[str, ...]  # strokes dropped or not at their word


def story_metrics(part: str) -> list[Metric]:
    """Measure the liveliness of the supplied story in three styles.

    Args:
        part: prefix of the metric names.
    """
    return [
        metric for style in STORY_STYLES for metric in _metrics(f"{part}.story.{style}", measure_styled_story(style))
    ]


@cache
def measure_styled_story(style: str) -> StoryMeasures:
    """Plan the supplied story in a style and measure its liveliness.

    The result is cached.
    """
    setup = replace(set_up(idle=1.0, variation=1.0, seed=STORY_SEED), style=Style.load(style))
    return measure_story(plan((CONFIGS / "bml" / "story.bml").read_text(encoding="utf-8"), setup))


def measure_story(planned: Plan) -> StoryMeasures:
    """Measure the liveliness of a planned motion during its speech."""
    robot, motion = planned.setup.robot, planned.trajectory
    spoken = [timed.times for timed in planned.timeline.timed if timed.behaviour.id in planned.utterances]
    times = motion.zero + np.arange(spoken[0]["start"], spoken[-1]["end"], SAMPLE_STEP)
    angles, velocities, _ = motion.sample(times)
    torso, neck = list(robot.joints("torso")), list(robot.joints("neck"))
    trunk, head = _is_slower(velocities[:, torso], STILL_TRUNK_SPEED), _is_slower(velocities[:, neck], STILL_HEAD_SPEED)
    ahead = robot.skeleton.frames(angles).rotations[:, robot.skeleton.segment(robot.chains["neck"][-1]), 0, 0]
    return StoryMeasures(
        still_trunk=float(trunk.mean()),
        still_head=float(head.mean()),
        longest_trunk=longest_run(trunk) * SAMPLE_STEP,
        longest_all=longest_run(_is_slower(velocities, STILL_SPEED)) * SAMPLE_STEP,
        holds=_measure_holds(planned),
        aside=float(np.mean(np.arccos(np.clip(ahead, -1.0, 1.0)) > ASIDE_ANGLE)),
        missed=_missed_strokes(planned),
    )


def longest_run(flags: Flags) -> int:
    """Return the length of the longest run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return int(max((edges[1::2] - edges[::2]).tolist(), default=0))


def _is_slower(velocities: Floats, limit: float) -> Flags:
    return np.asarray(np.abs(velocities).max(axis=1) < limit)


def _measure_holds(planned: Plan) -> tuple[float, ...]:
    """Return the wrist's range of motion [m] during every gesture hold."""
    motions, robot = [], planned.setup.robot
    for arm in (robot.arm(side) for side in SIDES):
        joints, rest = list(arm.joints), robot.skeleton.rest[list(arm.joints)]
        keys = [
            (time, posture.angles[joints])
            for posture, time in zip(planned.postures.postures, planned.motion.planned.tolist(), strict=True)
            if posture.keyed[joints[0]]
        ]
        for (begin, one), (end, other) in pairwise(keys):
            if (
                end - begin > MIN_HOLD_TIME
                and np.abs(one - other).max() < MAX_HOLD_CHANGE
                and np.abs(one - rest).max() > MIN_HOLD_OFFSET
            ):
                angles = planned.trajectory.sample(planned.trajectory.zero + np.arange(begin, end, SAMPLE_STEP))[0]
                wrist = robot.skeleton.frames(angles).origins[:, arm.wrist]
                motions.append(float(np.ptp(wrist, axis=0).max()))
    return tuple(motions)


def _missed_strokes(planned: Plan) -> tuple[str, ...]:
    dropped = [id for id, outcome in planned.keyframes.outcomes.items() if outcome.kind == "dropped"]
    late = [
        s.behaviour for s in planned.syncs if s.sync == "stroke" and abs(s.planned - s.requested) > MAX_STROKE_SHIFT
    ]
    return (*dropped, *late)


def _metrics(part: str, story: StoryMeasures) -> Sequence[Metric]:
    frozen, holds = sum(moved < FROZEN_MOTION for moved in story.holds), len(story.holds)
    return (
        Metric(f"{part}.still_trunk", story.still_trunk, "", 0.1, "lower", f"{story.longest_trunk:.1f} s in one piece"),
        Metric(f"{part}.still_head", story.still_head, "", 0.1, "lower"),
        Metric(f"{part}.still_all", story.longest_all, "s", 0.1, "lower", "longest"),
        Metric(f"{part}.frozen_holds", float(frozen), "holds", 0.0, "lower", f"of {holds} holds"),
        Metric(f"{part}.aside", story.aside, "", None, "lower", "fraction of the time with the head off the listener"),
        Metric(f"{part}.missed", float(len(story.missed)), "strokes", 0.0, "lower", ", ".join(story.missed)),
    )
