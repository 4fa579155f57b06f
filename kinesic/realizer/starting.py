"""Start of blocks in addition to running blocks, or replacing them."""

from dataclasses import replace

from kinesic.bml.block import Composition, Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.realizer.contention import drop_overlapping_speech, occupancy_of_others
from kinesic.realizer.ending import end_block, stop_block
from kinesic.realizer.feedback import order_feedback, times_by_behaviour, withdraw_feedback, withdraw_provisional
from kinesic.realizer.idling import end_idle
from kinesic.realizer.merge import MergedMotion, merge, replace_motion
from kinesic.realizer.pointing import restore_pointing
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene


def start_block(scene: Scene, running: RunningBlock, now: float) -> Scene:
    """Start a block now or at the time of its dependencies.

    Args:
        scene: scene with or without the block.
        running: block that has not begun.
        now: global time [s].
    """
    desired = _desired_zero(scene, running, now)
    before = scene = end_idle(scene, now).with_block(running)
    for id in running.block.order.interrupts:
        if (other := scene.find(id)) is not None and id != running.id:
            scene = stop_block(scene, other, now, f"{running.id} interrupts it")
    if running.block.composition is Composition.REPLACE:
        for other in scene.blocks:
            if other.id != running.id and other.state is not BlockState.PENDING:
                end = end_block if running.prepared.moves else stop_block  # a moving block takes over their motion
                scene = end(scene, other, now, f"{running.id} replaces it")
    if running.block.composition is Composition.REPLACE and running.prepared.moves:
        scene, running, notices = _replace_motion(scene, running, desired, now)
    else:
        scene, running, notices = _merge_motion(scene, running, desired, now)
    running, speech_notices = drop_overlapping_speech(scene, running)
    notices = (*notices, *speech_notices, *_lateness(running))
    left_out = times_by_behaviour(running.prepared.plan.syncs).keys() - running.times.keys()
    missing = [
        behaviour.id for behaviour in running.block.behaviours if behaviour.required and behaviour.id in left_out
    ]
    if missing:
        return _fail_block(before, running, missing, notices, now)
    running = replace(running, state=BlockState.IN_EXEC)
    if running.differs_from_prediction(SHIFT_TO_WARN):
        scene = scene.with_feedback(running.prediction(now))
    scene = scene.with_feedback(*(running.warning(notice, now) for notice in notices))
    running = replace(running, predicted=(running.zero, running.times))
    coming = tuple(replace(message, time=max(message.time, scene.first_change(now))) for message in running.agenda())
    scene = replace(scene.with_block(running), agenda=order_feedback(scene.agenda, coming))
    scene = restore_pointing(before, scene, now)
    for id in running.block.order.activates:
        scene = activate_block(scene, id, now)
    return scene


def _fail_block(
    scene: Scene, running: RunningBlock, missing: list[str], notices: tuple[Notice, ...], now: float
) -> Scene:
    """Remove a block whose required behaviours were dropped."""
    text = f"not performed, because it requires {', '.join(missing)}"
    all_notices = (*notices, Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, text))
    agenda = withdraw_provisional(withdraw_feedback(scene.agenda, running.run), running.id)
    after = replace(scene.without_block(running, BlockState.FAILED), agenda=agenda)
    return after.with_feedback(*(running.warning(notice, now) for notice in all_notices))


def activate_block(scene: Scene, id: str, now: float) -> Scene:
    """Start a preplanned block, or let it wait for its dependencies."""
    running = scene.find(id)
    if running is None or running.state is not BlockState.PENDING:
        return scene
    waiting = replace(running, state=BlockState.LURKING)
    scene = scene.with_block(waiting)
    return start_block(scene, waiting, now) if scene.may_start(waiting, now) else scene


def _desired_zero(scene: Scene, running: RunningBlock, now: float) -> float:
    """Return the desired global time [s] of block time 0."""
    request = running.prepared.request
    earliest = max(now + scene.ahead, scene.earliest_start(running))
    return max(earliest, request.zero) if request.is_anchored else earliest + running.lead_in


def _merge_motion(
    scene: Scene, running: RunningBlock, desired: float, now: float
) -> tuple[Scene, RunningBlock, tuple[Notice, ...]]:
    """Merge the block with the running motion.

    Conflicting behaviours are dropped.
    """
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
    """Return a warning if a block begins too late for its references."""
    request = running.prepared.request
    late = running.zero - request.zero
    if not request.is_anchored or late <= SHIFT_TO_WARN:
        return ()
    text = f"it begins {late:.3f} s too late for its references to other blocks"
    return (Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, text),)


def _with_motion(
    scene: Scene, running: RunningBlock, merged: MergedMotion
) -> tuple[Scene, RunningBlock, tuple[Notice, ...]]:
    running = replace(running, merged=merged, zero=merged.zero, times=times_by_behaviour(merged.syncs))
    return replace(scene, motion=merged.trajectory), running, merged.notices
