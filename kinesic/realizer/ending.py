"""Ends blocks before their time: stops those that play, and revokes those that wait."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.body.arrays import Flags, sealed
from kinesic.motion.trajectory import Trajectory
from kinesic.realizer.feedback import retime_feedback, without, without_provisional
from kinesic.realizer.held import END_TOLERANCE, lacking_change
from kinesic.realizer.occupancy import STILL, Occupancy, freed_hinges
from kinesic.realizer.release import release_motion
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene


def is_over(scene: Scene, running: RunningBlock, time: float) -> bool:
    """Whether a playing block ends until a time [s] global."""
    ends = (message.time for message in scene.agenda if message.belongs_to(running.run) and message.is_block_end)
    return running.state.is_playing and next(ends, -inf) <= time


def stop_block(scene: Scene, running: RunningBlock, now: float, why: str) -> Scene:
    """End a block, or revoke it if it waits.

    Its motion is taken back from the earliest change on.

    Args:
        scene: with the block.
        running: the block.
        now: [s] global time.
        why: for the sender.
    """
    after = end_block(scene, running, now, why)
    if running.merged is None or is_over(scene, running, scene.first_change(now)):
        return after
    moved = np.ptp(running.merged.layer.controls, axis=0) > 0.0
    after = replace(after, motion=_take_back(scene, running, running.occupancy, moved, now))
    return _warn_of_rest(after, running, now)


def _warn_of_rest(scene: Scene, running: RunningBlock, now: float) -> Scene:
    """Warn the sender if the trunk cannot return after an interruption."""
    left = float(np.abs(lacking_change(scene.motion.controls, scene.occupancy, scene.setup.robot)).max())
    if left <= END_TOLERANCE:
        return scene
    text = f"the trunk stays {np.degrees(left):.0f} deg from where others hold it: no way back is clear of the body"
    return scene.say(running.warning(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, text), now))


def end_block(scene: Scene, running: RunningBlock, now: float, why: str) -> Scene:
    """End a block without taking its motion back.

    It ends at the earliest change. Points until that time are passed all the same, since the loop may have sent them.
    """
    change = scene.first_change(now)
    if is_over(scene, running, change):
        return scene.without_block(running, BlockState.DONE)
    own = [message for message in scene.agenda if message.belongs_to(running.run)]
    agenda = without_provisional(without(scene.agenda, running.run), running.id)
    if not running.state.is_playing or (own[0].is_block_start and own[0].time > change):
        notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, f"revoked before it began: {why}")
        return replace(scene.without_block(running, BlockState.REVOKED), agenda=agenda).say(
            running.warning(notice, now)
        )
    passed = [message for message in own if message.time <= change]
    end = next(message for message in own if message.is_block_end).interrupted_at(change)
    cut = replace(running, times=_passed(running, change))
    return replace(scene.without_block(cut, BlockState.INTERRUPTED), agenda=agenda).say(*passed, end)


def leave_out(scene: Scene, running: RunningBlock, behaviours: frozenset[str], now: float) -> Scene:
    """End some behaviours of a block and release their hinges."""
    remaining, change = running.without(behaviours), scene.first_change(now)
    if not remaining.times:
        return stop_block(scene, running, now, "all its behaviours are interrupted")
    if is_over(scene, running, change):
        return scene
    ended = [each for each in running.occupancy if each.behaviour in behaviours]
    moved = scene.hinges_of(ended) & ~scene.hinges_of(remaining.occupancy)
    motion = _take_back(scene, running, ended, moved, now)
    agenda = without(scene.agenda, running.run, behaviours, after=change)
    agenda = retime_feedback(agenda, running.run, remaining.agenda(), change)
    after = replace(scene.with_block(remaining), motion=motion, agenda=agenda)
    return _warn_of_rest(after.say(remaining.prediction(now)), running, now)


def _take_back(scene: Scene, running: RunningBlock, ended: Sequence[Occupancy], moved: Flags, now: float) -> Trajectory:
    """The motion without what ended behaviours of a block do with the hinges (n,) that they move."""
    if running.merged is None:
        return scene.motion
    at, remaining = scene.first_change(now), [each for each in running.occupancy if each not in ended]
    others, robot = (*scene.occupancy_without(running.id), *remaining), scene.setup.robot
    free = freed_hinges(ended, moved, at, robot, others=others)
    layer = running.merged.layer
    shared = (np.abs(lacking_change(scene.motion.controls, others, robot)) > STILL) & ~free  # moved by others, too
    if not (free | shared).any():
        return scene.motion
    kept = replace(layer, controls=sealed(np.where(shared, 0.0, layer.controls)))
    return release_motion(scene.motion, at, free | shared, scene.setup, layer=kept, others=others)


def _passed(running: RunningBlock, time: float) -> dict[str, dict[str, float]]:
    """Sync points that were passed, by behaviour, in block time [s]."""
    passed = {id: {sync: t for sync, t in at.items() if running.zero + t <= time} for id, at in running.times.items()}
    return {id: at for id, at in passed.items() if at}
