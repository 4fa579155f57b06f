"""Starts blocks, beside those that play or in their place."""

from dataclasses import replace

from kinesic.bml.block import Composition, Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.realizer.contention import occupancy_of_others, silence_overlap
from kinesic.realizer.ending import end_block, stop_block
from kinesic.realizer.feedback import order_feedback, times_of, without, without_provisional
from kinesic.realizer.idling import end_idle
from kinesic.realizer.merge import MergedMotion, merge, replace_motion
from kinesic.realizer.pointing import aim_again
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene


def start_block(scene: Scene, running: RunningBlock, now: float) -> Scene:
    """Starts a block now, or at the time that it waits for.

    Args:
        scene: with or without the block.
        running: the block, which has not begun.
        now: [s] global time.
    """
    desired = _desired_zero(scene, running, now)
    before = scene = end_idle(scene, now).with_block(running)
    for id in running.block.succession.interrupts:
        if (other := scene.find(id)) is not None and id != running.id:
            scene = stop_block(scene, other, now, f"{running.id} interrupts it")
    if running.block.composition is Composition.REPLACE:
        for other in scene.blocks:
            if other.id != running.id and other.state is not BlockState.PENDING:
                end = end_block if running.prepared.moves else stop_block  # a block that moves takes over their motion
                scene = end(scene, other, now, f"{running.id} replaces it")
    if running.block.composition is Composition.REPLACE and running.prepared.moves:
        scene, running, notices = _replace_motion(scene, running, desired, now)
    else:
        scene, running, notices = _merge_motion(scene, running, desired, now)
    running, speech_notices = silence_overlap(scene, running)
    notices = (*notices, *speech_notices, *_lateness(running))
    left_out = times_of(running.prepared.plan.syncs).keys() - running.times.keys()
    missing = [each.id for each in running.block.behaviours if each.required and each.id in left_out]
    if missing:
        return _fail(before, running, missing, notices, now)
    running = replace(running, state=BlockState.IN_EXEC)
    if running.differs_from_prediction(SHIFT_TO_WARN):
        scene = scene.say(running.prediction(now))
    scene = scene.say(*(running.warning(notice, now) for notice in notices))
    running = replace(running, predicted=(running.zero, running.times))
    coming = tuple(replace(message, time=max(message.time, scene.first_change(now))) for message in running.agenda())
    scene = replace(scene.with_block(running), agenda=order_feedback(scene.agenda, coming))
    scene = aim_again(before, scene, now)
    for id in running.block.succession.activates:
        scene = activate_block(scene, id, now)
    return scene


def _fail(scene: Scene, running: RunningBlock, missing: list[str], notices: tuple[Notice, ...], now: float) -> Scene:
    """Performs nothing of a block when something that it requires is left out."""
    text = f"not performed, because it requires {', '.join(missing)}"
    every = (*notices, Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, text))
    agenda = without_provisional(without(scene.agenda, running.run), running.id)
    after = replace(scene.without_block(running, BlockState.FAILED), agenda=agenda)
    return after.say(*(running.warning(notice, now) for notice in every))


def activate_block(scene: Scene, id: str, now: float) -> Scene:
    """Starts a block that waits to be activated, or lets it wait for other blocks; others stay as they are."""
    running = scene.find(id)
    if running is None or running.state is not BlockState.PENDING:
        return scene
    waiting = replace(running, state=BlockState.LURKING)
    scene = scene.with_block(waiting)
    return start_block(scene, waiting, now) if scene.may_start(waiting, now) else scene


def _desired_zero(scene: Scene, running: RunningBlock, now: float) -> float:
    """Global time [s] at which the block's time 0 is to be."""
    request = running.prepared.request
    earliest = max(now + scene.ahead, scene.earliest_start(running))
    return max(earliest, request.zero) if request.is_anchored else earliest + running.lead


def _merge_motion(
    scene: Scene, running: RunningBlock, desired: float, now: float
) -> tuple[Scene, RunningBlock, tuple[Notice, ...]]:
    """Lays the block over what plays; behaviours without a place are left out."""
    if not running.prepared.moves:
        return scene, replace(running, zero=desired), ()
    others = occupancy_of_others(scene, replace(running, zero=desired))
    merged = merge(scene.motion, scene.first_change(now), running.prepared.plan, begin=desired, occupied=others)
    return _with_motion(scene, running, merged)


def _replace_motion(
    scene: Scene, running: RunningBlock, desired: float, now: float
) -> tuple[Scene, RunningBlock, tuple[Notice, ...]]:
    merged = replace_motion(scene.motion, scene.first_change(now), running.prepared.plan, begin=desired)
    return _with_motion(replace(scene, lasting=()), running, merged)


def _lateness(running: RunningBlock) -> tuple[Notice, ...]:
    """Warns when a block that refers to others begins too late to meet them."""
    request = running.prepared.request
    late = running.zero - request.zero
    if not request.is_anchored or late <= SHIFT_TO_WARN:
        return ()
    text = f"it begins {late:.3f} s too late to meet the sync points of other blocks"
    return (Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, text),)


def _with_motion(
    scene: Scene, running: RunningBlock, merged: MergedMotion
) -> tuple[Scene, RunningBlock, tuple[Notice, ...]]:
    running = replace(running, merged=merged, zero=merged.zero, times=times_of(merged.syncs))
    return replace(scene, motion=merged.trajectory), running, merged.notices
