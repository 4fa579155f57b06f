"""Face poses of a planned performance over time."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from kinesic.bml.block import Face, Gaze, Speech, TimedBehaviour, Timeline
from kinesic.bml.timing.constraints import find_equalities, get_point
from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.face.eyes import Eyes, Habits, block_gazes, direction_angles, gesture_gazes
from kinesic.expressivity.face.tracks import Channels, face_at_ticks, face_track
from kinesic.expressivity.style.standing import FRONTAL_GAZE
from kinesic.planning.plan import Plan

Shift = Mapping[tuple[str, str], float]  # (behaviour, sync point) -> delay [s] after the requested time


def commands_with_face(plan: Plan, times: Floats) -> Iterator[Command]:
    """Yield the planned commands with their face poses.

    The setpoints are the reference angles, for sinks that draw.

    Args:
        plan: of the performance.
        times: (m,) [s] performance time of the commands.
    """
    angles, speeds, accelerations = (sealed(values) for values in plan.trajectory.sample(times))
    for row in zip(times.tolist(), angles, speeds, accelerations, angles, compute_faces(plan, times), strict=True):
        yield Command(*row)


def needs_face(plan: Plan) -> bool:
    """Return whether an expression, speech, gaze or affect moves the face."""
    performed = (timed.behaviour for timed in plan.keyframes.timeline.timed)
    kinds = [behaviour.action for behaviour in performed if plan.keyframes.outcomes[behaviour.id].kind != "dropped"]
    bearing = BlockContext(plan.timeline.block, plan.setup.context).bearing
    shows_affect = bearing.posture > 0.0 and bool(bearing.standing.face)
    return shows_affect or any(isinstance(action, Face | Gaze | Speech) for action in kinds)


def compute_faces(plan: Plan, times: Floats) -> tuple[Mapping[str, float], ...]:
    """Compute face poses (`Command.face`) at performance times (m,) [s]."""
    return tuple(face_at_ticks(compute_action_units(plan, times), len(times)))


def compute_action_units(plan: Plan, times: Floats) -> Channels:
    """Compute the action units of a performance: expressions, visemes, gaze, blinks.

    Actions tied to sync points move with them. Eyes look where the head turns, or at the object of a gesture, and keep
    their target while the head moves.

    Args:
        plan: of the performance.
        times: (m,) [s] performance time, increasing.
    """
    timeline = _planned(plan)
    context = BlockContext(timeline.block, plan.setup.context)
    bodies = plan.keyframes.bodies
    looked = (*block_gazes(timeline, context), *gesture_gazes(timeline, bodies))
    idling = plan.setup.idling
    bearing = context.bearing
    gaze = bearing.standing.gaze if bearing.posture > 0.0 else FRONTAL_GAZE
    habits = Habits(idling.seed) if idling.amount else None
    eyes = Eyes(habits, looked, compute_head_directions(plan, times), gaze)
    block_times = times - plan.trajectory.zero
    affect = bearing.standing.affect(bearing.posture)
    return face_track(
        timeline,
        plan.utterances,
        block_times,
        styles=context.styles,
        eyes=eyes,
        bodies=bodies,
        affect=affect,
        prosody=plan.setup.style_prosody,
    )


def compute_head_directions(plan: Plan, times: Floats) -> Floats:
    """Compute the head direction in the world, (m, 2) [rad].

    The columns are left and up.

    Args:
        plan: of the performance.
        times: (m,) [s] performance time.
    """
    robot = plan.setup.robot
    if not robot.joints("neck"):
        return np.zeros((len(times), 2))
    angles, _, _ = plan.trajectory.sample(times)
    head = robot.skeleton.segment(robot.chains["neck"][-1])
    return direction_angles(robot.body_frames(angles).rotations[:, head, :, 0])


def _planned(plan: Plan) -> Timeline:
    shifts = {(sync.behaviour, sync.sync): sync.planned - sync.requested for sync in plan.syncs}
    timeline, outcomes = plan.keyframes.timeline, plan.keyframes.outcomes
    face_shifts: dict[tuple[str, str], float] = {}
    for equality in find_equalities(timeline.block):
        one, other = (get_point(ref) for ref in (equality.left, equality.right))
        left, right = (one.behaviour, one.sync), (other.behaviour, other.sync)
        face_shifts |= {here: shifts[there] for here, there in ((left, right), (right, left)) if there in shifts}
    kept = (timed for timed in timeline.timed if outcomes[timed.behaviour.id].kind != "dropped")
    return replace(
        timeline,
        timed=tuple(
            _later(timed, face_shifts if isinstance(timed.behaviour.action, Face) else shifts) for timed in kept
        ),
    )


def _later(timed: TimedBehaviour, shifts: Shift) -> TimedBehaviour:
    """Shift a behaviour's sync points, keeping their order."""
    moved = [time + shifts.get((timed.behaviour.id, sync), 0.0) for sync, time in timed.times.items()]
    return replace(timed, times=dict(zip(timed.times, np.maximum.accumulate(moved).tolist(), strict=True)))
