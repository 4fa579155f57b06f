"""How much of a body lives while it tells a story: what stands still, what is frozen, and how long nobody is looked at.

The story is told as the front door tells it, with everything on that is on by default.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.body.arrays import Flags, Floats
from kinesic.body.config import CONFIGS
from kinesic.body.robot import SIDES
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.style.style import Style
from kinesic.planning.plan import Plan
from kinesic.planning.secondary.drift import LEAST_HOLD

STYLES = ("neutral", "calm", "joyful")
SEED = 0
STEP = 0.02  # [s]
STILL_TRUNK, STILL_HEAD, STILL = np.radians([0.1, 0.5, 0.5])  # [rad/s] of trunk, head and all hinges: less is nothing
ASIDE = np.radians(7.0)  # that the head is off the listener
FROZEN = 0.002  # [m] that a hand moves in a hold: less is nothing
SAME, AWAY = 0.06, 0.05  # [rad] of an arm from key to key in a hold, under which the trunk may turn, and away from rest
MOVED = 0.05  # [s] by which a stroke misses its word


@dataclass(frozen=True)
class StoryMeasures:
    """What an animator would count, through the time that somebody speaks."""

    still_trunk: float  # share of the time
    still_head: float
    longest_trunk: float  # [s] that it stands still at once
    longest_all: float  # [s] that nothing moves
    holds: tuple[float, ...]  # [m] that hands move in each hold of their arm
    aside: float  # share of the time that the head is off the listener
    missed: tuple[str, ...]  # strokes that are dropped, or not at their word


def story_figures(part: str) -> list[Figure]:
    """Measures the story that comes with kinesic in three styles.

    Args:
        part: what the names of the figures begin with.
    """
    return [figure for style in STYLES for figure in _figures(f"{part}.story.{style}", story_measures(style))]


@cache
def story_measures(style: str) -> StoryMeasures:
    """Plans the story in a style, once in a process."""
    known = replace(set_up(idle=1.0, variation=1.0, seed=SEED), style=Style.load(style))
    return measure_story(plan((CONFIGS / "bml" / "story.bml").read_text(encoding="utf-8"), known))


def measure_story(planned: Plan) -> StoryMeasures:
    """Measures a plan through all that is said in it."""
    robot, motion = planned.setup.robot, planned.trajectory
    spoken = [timed.times for timed in planned.timeline.timed if timed.behaviour.id in planned.utterances]
    times = motion.zero + np.arange(spoken[0]["start"], spoken[-1]["end"], STEP)
    angles, speeds, _ = motion.sample(times)
    torso, neck = list(robot.joints("torso")), list(robot.joints("neck"))
    trunk, head = _slower(speeds[:, torso], STILL_TRUNK), _slower(speeds[:, neck], STILL_HEAD)
    ahead = robot.skeleton.frames(angles).rotations[:, robot.skeleton.segment(robot.chains["neck"][-1]), 0, 0]
    return StoryMeasures(
        still_trunk=float(trunk.mean()),
        still_head=float(head.mean()),
        longest_trunk=longest(trunk) * STEP,
        longest_all=longest(_slower(speeds, STILL)) * STEP,
        holds=_holds(planned),
        aside=float(np.mean(np.arccos(np.clip(ahead, -1.0, 1.0)) > ASIDE)),
        missed=_missed(planned),
    )


def longest(flags: Flags) -> int:
    """Counts the longest run of true ones."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return int(max((edges[1::2] - edges[::2]).tolist(), default=0))


def _slower(speeds: Floats, least: float) -> Flags:
    return np.asarray(np.abs(speeds).max(axis=1) < least)


def _holds(planned: Plan) -> tuple[float, ...]:
    """[m] that a wrist moves, in every hold of its arm away from rest."""
    found, robot = [], planned.setup.robot
    for arm in (robot.arm(side) for side in SIDES):
        joints, rest = list(arm.joints), robot.skeleton.rest[list(arm.joints)]
        keys = [
            (time, posture.angles[joints])
            for posture, time in zip(planned.postures.postures, planned.motion.planned.tolist(), strict=True)
            if posture.keyed[joints[0]]
        ]
        for (begin, one), (end, other) in pairwise(keys):
            if end - begin > LEAST_HOLD and np.abs(one - other).max() < SAME and np.abs(one - rest).max() > AWAY:
                angles = planned.trajectory.sample(planned.trajectory.zero + np.arange(begin, end, STEP))[0]
                wrist = robot.skeleton.frames(angles).origins[:, arm.wrist]
                found.append(float(np.ptp(wrist, axis=0).max()))
    return tuple(found)


def _missed(planned: Plan) -> tuple[str, ...]:
    dropped = [id for id, outcome in planned.keyframes.outcomes.items() if outcome.kind == "dropped"]
    late = [s.behaviour for s in planned.syncs if s.sync == "stroke" and abs(s.planned - s.asked) > MOVED]
    return (*dropped, *late)


def _figures(part: str, story: StoryMeasures) -> Sequence[Figure]:
    frozen, holds = sum(moved < FROZEN for moved in story.holds), len(story.holds)
    return (
        Figure(f"{part}.still_trunk", story.still_trunk, "", 0.1, "lower", f"{story.longest_trunk:.1f} s at once"),
        Figure(f"{part}.still_head", story.still_head, "", 0.1, "lower"),
        Figure(f"{part}.still_all", story.longest_all, "s", 0.1, "lower", "at once"),
        Figure(f"{part}.frozen_holds", float(frozen), "holds", 0.0, "lower", f"of {holds}"),
        Figure(f"{part}.aside", story.aside, "", None, "lower", "of the time, head off the listener"),
        Figure(f"{part}.missed", float(len(story.missed)), "strokes", 0.0, "lower", ", ".join(story.missed)),
    )
