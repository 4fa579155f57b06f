"""Blocks that end before their time: stopped while they play, or taken back while they wait."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.body.arrays import Flags
from kinesic.motion.trajectory import Trajectory
from kinesic.realizer.feedback import Progress, ScheduledFeedback, retime_feedback, without
from kinesic.realizer.occupancy import Occupancy, freed_hinges
from kinesic.realizer.release import release_motion
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene


def stop_block(scene: Scene, staged: RunningBlock, now: float, why: str) -> Scene:
    """A block ends now: what it does is taken back while all others go on; one that waits is revoked.

    Args:
        scene: with the block.
        staged: the block.
        now: [s] global time.
        why: for the sender.
    """
    after = end_block(scene, staged, now, why)
    merged = staged.merged
    if merged is None or not merged.busy:
        return after
    moved = np.ptp(merged.layer.controls, axis=0) > 0.0
    return replace(after, motion=_taken_back(scene, staged, staged.busy, moved, now))


def end_block(scene: Scene, staged: RunningBlock, now: float, why: str) -> Scene:
    """The same, while its motion is somebody else's matter."""
    agenda = tuple(due for due in without(scene.agenda, staged.id) if due.unless_improved != staged.id)
    waits_for_start = any(
        isinstance(due.told, Progress) and due.told.key == (None, "start")
        for due in scene.agenda
        if due.block == staged.id
    )
    if not staged.state.is_playing or waits_for_start:
        notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, staged.id, f"revoked before it began: {why}")
        return replace(scene.gone(staged, BlockState.REVOKED), agenda=agenda).say(staged.warning(notice, now))
    point = Progress(staged.id, None, "end", now - staged.zero, staged.block.character, BlockState.INTERRUPTED)
    cut = replace(staged, times=_until(staged, now))
    after = replace(scene.gone(cut, BlockState.INTERRUPTED), agenda=agenda)
    return after.say(ScheduledFeedback(now, point, staged.sender))


def leave_out(scene: Scene, staged: RunningBlock, behaviours: frozenset[str], now: float) -> Scene:
    """Some behaviours of a block end now; what nobody else moves goes back."""
    left = staged.without(behaviours)
    if not left.times:
        return stop_block(scene, staged, now, "all its behaviours are interrupted")
    after = scene.put(left)
    gone = [each for each in staged.busy if each.behaviour in behaviours]
    motion = _taken_back(scene, staged, gone, scene.hinges(gone) & ~scene.hinges(left.busy), now)
    agenda = retime_feedback(without(scene.agenda, staged.id, behaviours), staged.id, left.agenda(), now)
    return replace(after, motion=motion, agenda=agenda).say(left.prediction(now))


def _taken_back(scene: Scene, staged: RunningBlock, gone: Sequence[Occupancy], moved: Flags, now: float) -> Trajectory:
    """The motion without what some behaviours of a block do with the hinges (n,) that they move."""
    if staged.merged is None:
        return scene.motion
    at, left = scene.first_change(now), [each for each in staged.busy if each not in gone]
    others = (*scene.busy_but(staged.id), *left)
    free = freed_hinges(gone, moved, at, scene.setup.robot, others=others)
    if not free.any():
        return scene.motion
    return release_motion(scene.motion, at, free, scene.setup, layer=staged.merged.layer, others=others)


def _until(staged: RunningBlock, now: float) -> dict[str, dict[str, float]]:
    """The sync points that were passed."""
    own = {id: {sync: t for sync, t in at.items() if staged.zero + t <= now} for id, at in staged.times.items()}
    return {id: at for id, at in own.items() if at}
