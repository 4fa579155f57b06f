"""Works out what the face shows while a plan is performed: `Command.face`."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from kinesic.bml.block import Face, Gaze, Speech, TimedBehaviour, Timeline
from kinesic.bml.timing.constraints import point_of, ties
from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.face.eyes import Eyes, Habits, gesture_looks, headings, looks
from kinesic.expressivity.face.tracks import Channels, face_at_ticks, face_track
from kinesic.planning.plan import Plan

Shift = Mapping[tuple[str, str], float]  # behaviour and sync point -> [s] later than asked


def commands_with_face(plan: Plan, times: Floats) -> Iterator[Command]:
    """Yields the reference with its face, for sinks that draw: one command at each of (m,) performance times [s]."""
    angles, speeds, accelerations = (sealed(values) for values in plan.trajectory.sample(times))
    for row in zip(times.tolist(), angles, speeds, accelerations, angles, faces(plan, times), strict=True):
        yield Command(*row)


def asks_face(plan: Plan) -> bool:
    """Tells whether anything but habit moves the face: an expression, speech, or a gaze."""
    performed = (timed.behaviour for timed in plan.keyframes.timeline.timed)
    kinds = [behaviour.action for behaviour in performed if plan.keyframes.outcomes[behaviour.id].kind != "dropped"]
    return any(isinstance(action, Face | Gaze | Speech) for action in kinds)


def faces(plan: Plan, times: Floats) -> tuple[Mapping[str, float], ...]:
    """Works out `Command.face` at each of (m,) performance times [s]."""
    return tuple(face_at_ticks(shown_units(plan, times), len(times)))


def shown_units(plan: Plan, times: Floats) -> Channels:
    """Works out the action units of a performance: expressions, visemes, gaze, blinks.

    Sync points that planning moved take what is tied to them along; eyes look where the head is going, or at what a
    gesture shows, and hold on to it whatever the head does.

    Args:
        plan: of the performance.
        times: (m,) [s] performance time, increasing.
    """
    timeline = _planned(plan)
    context = BlockContext(timeline.block, plan.setup.context)
    bodies = plan.keyframes.bodies
    looked = (*looks(timeline, context), *gesture_looks(timeline, bodies))
    idling = plan.setup.idling
    eyes = Eyes(Habits(idling.seed) if idling.amount else None, looked, heads(plan, times))
    block_times = times - plan.trajectory.zero
    return face_track(timeline, plan.utterances, block_times, styles=context.styles, eyes=eyes, bodies=bodies)


def heads(plan: Plan, times: Floats) -> Floats:
    """Computes (m, 2) [rad] left and up, where the head points in the world at (m,) performance times [s]."""
    robot = plan.setup.robot
    if not robot.joints("neck"):
        return np.zeros((len(times), 2))
    angles, _, _ = plan.trajectory.sample(times)
    head = robot.skeleton.segment(robot.chains["neck"][-1])
    return headings(robot.body_frames(angles).rotations[:, head, :, 0])


def _planned(plan: Plan) -> Timeline:
    shifts = {(sync.behaviour, sync.sync): sync.planned - sync.asked for sync in plan.syncs}
    timeline, outcomes = plan.keyframes.timeline, plan.keyframes.outcomes
    own: dict[tuple[str, str], float] = {}
    for tie in ties(timeline.block):
        one, other = (point_of(ref) for ref in (tie.left, tie.right))
        left, right = (one.behaviour, one.sync), (other.behaviour, other.sync)
        own |= {here: shifts[there] for here, there in ((left, right), (right, left)) if there in shifts}
    kept = (timed for timed in timeline.timed if outcomes[timed.behaviour.id].kind != "dropped")
    return replace(
        timeline,
        timed=tuple(_later(timed, own if isinstance(timed.behaviour.action, Face) else shifts) for timed in kept),
    )


def _later(timed: TimedBehaviour, shifts: Shift) -> TimedBehaviour:
    """A behaviour with its sync points moved, none of them before an earlier one."""
    moved = [time + shifts.get((timed.behaviour.id, sync), 0.0) for sync, time in timed.times.items()]
    return replace(timed, times=dict(zip(timed.times, np.maximum.accumulate(moved).tolist(), strict=True)))
