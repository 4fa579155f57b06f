"""Early ends of blocks: stop running blocks and revoke waiting ones."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.body.arrays import Flags, sealed
from kinesic.motion.trajectory import Trajectory
from kinesic.realizer.feedback import retime_feedback, times_by_behaviour, withdraw_feedback, withdraw_provisional
from kinesic.realizer.held import HELD_POSTURE_TOLERANCE, offset_to_held_posture, trunk_hinges
from kinesic.realizer.occupancy import MOTION_TOLERANCE, Occupancy, freed_hinges
from kinesic.realizer.release import release_motion
from kinesic.realizer.replan import replan
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene
from kinesic.realizer.yielding import MAX_YIELDING_RETRACTION, yield_motion


def is_over(scene: Scene, running: RunningBlock, time: float) -> bool:
    """Return whether a running block ends by a global time [s]."""
    ends = (message.time for message in scene.agenda if message.belongs_to(running.run) and message.is_block_end)
    return running.state.is_playing and next(ends, -inf) <= time


def stop_block(scene: Scene, running: RunningBlock, now: float, why: str, *, yields: bool = False) -> Scene:
    """Stop a running block, or revoke a waiting one.

    Its motion is removed from the earliest possible change on.

    Args:
        scene: scene with the block.
        running: block to stop.
        now: global time [s].
        why: reason for the sender.
        yields: whether its arms decelerate and hold before they return.
    """
    after = end_block(scene, running, now, why)
    if running.merged is None or is_over(scene, running, scene.first_change(now)):
        return after
    moved = np.ptp(running.merged.layer.controls, axis=0) > 0.0
    after = replace(after, motion=_take_back(scene, running, running.occupancy, moved, now, yields=yields))
    return _warn_of_incomplete_return(after, running, now)


def _warn_of_incomplete_return(scene: Scene, running: RunningBlock, now: float) -> Scene:
    """Warn the sender if the trunk cannot return after an interruption."""
    left = float(np.abs(offset_to_held_posture(scene.motion.controls, scene.occupancy, scene.setup.robot)).max())
    if left <= HELD_POSTURE_TOLERANCE:
        return scene
    text = f"the trunk stays {np.degrees(left):.0f} deg off the held posture: no return path is free of collisions"
    return scene.with_feedback(running.warning(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, text), now))


def end_block(scene: Scene, running: RunningBlock, now: float, why: str) -> Scene:
    """End a block without removing its motion.

    It ends at the earliest change. Points before that time are reported as passed, because the loop may have sent them.
    """
    change = scene.first_change(now)
    if is_over(scene, running, change):
        return scene.without_block(running, BlockState.DONE)
    block_messages = [message for message in scene.agenda if message.belongs_to(running.run)]
    agenda = withdraw_provisional(withdraw_feedback(scene.agenda, running.run), running.id)
    if not running.state.is_playing or (block_messages[0].is_block_start and block_messages[0].time > change):
        notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, f"revoked before it began: {why}")
        return replace(scene.without_block(running, BlockState.REVOKED), agenda=agenda).with_feedback(
            running.warning(notice, now)
        )
    passed = [message for message in block_messages if message.time <= change]
    end = next(message for message in block_messages if message.is_block_end).interrupted_at(change)
    cut = replace(running, times=_passed(running, change))
    return replace(scene.without_block(cut, BlockState.INTERRUPTED), agenda=agenda).with_feedback(*passed, end)


def end_behaviours(scene: Scene, running: RunningBlock, behaviours: frozenset[str], now: float) -> Scene:
    """End some behaviours of a block and release their hinges."""
    remaining, change = running.without(behaviours), scene.first_change(now)
    if not remaining.times:
        return stop_block(scene, running, now, "all its behaviours are interrupted")
    if is_over(scene, running, change):
        return scene
    ended = [entry for entry in running.occupancy if entry.behaviour in behaviours]
    moved = scene.hinges_of(ended) & ~scene.hinges_of(remaining.occupancy)
    replanned = _replan_trunk(scene, remaining, ended, change)
    if replanned is None or replanned.merged is None:
        motion = _take_back(scene, running, ended, moved, now)
    else:
        arms, others = (
            moved & ~trunk_hinges(scene.setup.robot),
            (*scene.occupancy_without(running.id), *remaining.occupancy),
        )
        motion, remaining = replanned.merged.trajectory, replanned
        motion = release_motion(motion, change, arms, scene.setup, layer=replanned.merged.layer, others=others)
    agenda = withdraw_feedback(scene.agenda, running.run, behaviours, after=change)
    agenda = retime_feedback(agenda, running.run, remaining.agenda(), change)
    after = replace(scene.with_block(remaining), motion=motion, agenda=agenda)
    return _warn_of_incomplete_return(after.with_feedback(remaining.prediction(now)), running, now)


def _replan_trunk(
    scene: Scene, remaining: RunningBlock, ended: Sequence[Occupancy], change: float
) -> RunningBlock | None:
    """Replan a block if ended and remaining behaviours move common trunk hinges.

    Returns:
        None if there is no such hinge, or if the motion cannot change over in time.
    """
    trunk, merged = trunk_hinges(scene.setup.robot), remaining.merged
    shared = trunk & scene.hinges_of(ended) & scene.hinges_of(remaining.occupancy)
    if merged is None or not shared.any() or all(entry.end <= change and not entry.is_held for entry in ended):
        return None
    others = scene.occupancy_without(remaining.id)
    replanned = replan(scene.motion, change, merged, remaining.prepared.plan, others=others)
    if replanned is None:
        return None
    times = times_by_behaviour(replanned.syncs)
    return replace(remaining, merged=replanned, times={id: times.get(id, at) for id, at in remaining.times.items()})


def _take_back(
    scene: Scene, running: RunningBlock, ended: Sequence[Occupancy], moved: Flags, now: float, *, yields: bool = False
) -> Trajectory:
    """Return the scene's motion without the offsets of ended behaviours.

    Their hinges return to rest or to the held posture.
    """
    if running.merged is None:
        return scene.motion
    at, remaining = scene.first_change(now), [entry for entry in running.occupancy if entry not in ended]
    others, robot = (*scene.occupancy_without(running.id), *remaining), scene.setup.robot
    longest = MAX_YIELDING_RETRACTION if yields else inf
    free = freed_hinges(ended, moved, at, robot, others=others, longest_retraction=longest)
    layer = running.merged.layer
    lacking = np.abs(offset_to_held_posture(scene.motion.controls, others, robot))
    shared = (lacking > MOTION_TOLERANCE) & ~free  # hinges that other behaviours move, too
    if not (free | shared).any():
        return scene.motion
    kept = replace(layer, controls=sealed(np.where(shared, 0.0, layer.controls)))
    remove = yield_motion if yields else release_motion
    return remove(scene.motion, at, free | shared, scene.setup, layer=kept, others=others)


def _passed(running: RunningBlock, time: float) -> dict[str, dict[str, float]]:
    """Return passed sync points by behaviour, in block time [s]."""
    passed = {id: {sync: t for sync, t in at.items() if running.zero + t <= time} for id, at in running.times.items()}
    return {id: at for id, at in passed.items() if at}
