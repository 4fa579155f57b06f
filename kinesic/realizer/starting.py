"""A block begins: beside what plays, in its place, or after it."""

from dataclasses import replace

from kinesic.bml.block import Composition, Notice, NoticeType
from kinesic.bml.composition import BlockState
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.realizer.contention import occupancy_of_others, silence_overlap
from kinesic.realizer.ending import end_block, stop_block
from kinesic.realizer.feedback import order_feedback, times_of, without
from kinesic.realizer.merge import MergedMotion, merge, replace_motion
from kinesic.realizer.pointing import aim_again
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene


def start_block(scene: Scene, staged: RunningBlock, now: float) -> Scene:
    """Begins a block now, or as soon as its turn has come.

    Args:
        scene: with or without the block.
        staged: the block, which has not begun.
        now: [s] global time.
    """
    wished = _wished(scene, staged, now)
    before = scene = scene.put(staged)
    for id in staged.block.succession.interrupts:
        if (other := scene.find(id)) is not None and id != staged.id:
            scene = stop_block(scene, other, now, f"{staged.id} interrupts it")
    if staged.block.composition is Composition.REPLACE:
        for other in scene.blocks:
            if other.id != staged.id and other.state is not BlockState.PENDING:
                ends = end_block if staged.ready.moves else stop_block  # where it moves, it moves all that did
                scene = ends(scene, other, now, f"{staged.id} replaces it")
    if staged.block.composition is Composition.REPLACE and staged.ready.moves:
        scene, staged, notices = _in_place(scene, staged, wished, now)
    else:
        scene, staged, notices = _beside(scene, staged, wished, now)
    staged, speech_notices = silence_overlap(scene, staged)
    notices = (*notices, *speech_notices, *_late(staged))
    left_out = times_of(staged.ready.plan.syncs).keys() - staged.times.keys()
    missing = [each.id for each in staged.block.behaviours if each.required and each.id in left_out]
    if missing:
        return _failed(before, staged, missing, notices, now)
    staged = replace(staged, state=BlockState.IN_EXEC)
    if staged.differs(SHIFT_TO_WARN):
        scene = scene.say(staged.prediction(now))
    scene = scene.say(*(staged.warning(notice, now) for notice in notices))
    staged = replace(staged, told=(staged.zero, staged.times))
    own = (replace(due, time=max(due.time, now)) for due in staged.agenda())  # what lies in the past is told at once
    scene = replace(scene.put(staged), agenda=order_feedback(scene.agenda, tuple(own)))
    scene = aim_again(before, scene, now)
    for id in staged.block.succession.activates:
        scene = activate_block(scene, id, now)
    return scene


def _failed(scene: Scene, staged: RunningBlock, missing: list[str], notices: tuple[Notice, ...], now: float) -> Scene:
    """Nothing of a block is performed when something that it requires meets what plays."""
    text = f"not performed, because it requires {', '.join(missing)}"
    every = (*notices, Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, staged.id, text))
    agenda = tuple(due for due in without(scene.agenda, staged.id) if due.unless_improved != staged.id)
    after = replace(scene.gone(staged, BlockState.FAILED), agenda=agenda)
    return after.say(*(staged.warning(each, now) for each in every))


def activate_block(scene: Scene, id: str, now: float) -> Scene:
    """Begins a block that was sent early, or lets it wait for its turn; others stay as they are."""
    staged = scene.find(id)
    if staged is None or staged.state is not BlockState.PENDING:
        return scene
    waiting = replace(staged, state=BlockState.LURKING)
    scene = scene.put(waiting)
    return start_block(scene, waiting, now) if scene.has_turn(waiting, now) else scene


def _wished(scene: Scene, staged: RunningBlock, now: float) -> float:
    """Global time [s] at which the block's time 0 is wished."""
    asked = staged.ready.asked
    earliest = max(now + scene.ahead, scene.turn(staged))
    return max(earliest, asked.zero) if asked.is_anchored else earliest + staged.lead


def _beside(
    scene: Scene, staged: RunningBlock, wished: float, now: float
) -> tuple[Scene, RunningBlock, tuple[Notice, ...]]:
    """Laid over what plays; what meets it is left out."""
    if not staged.ready.moves:
        return scene, replace(staged, zero=wished), ()
    others = occupancy_of_others(scene, replace(staged, zero=wished))
    laid = merge(scene.motion, scene.first_change(now), staged.ready.plan, begin=wished, busy=others)
    return _with(scene, staged, laid)


def _in_place(
    scene: Scene, staged: RunningBlock, wished: float, now: float
) -> tuple[Scene, RunningBlock, tuple[Notice, ...]]:
    """In the place of all that moves."""
    over = replace_motion(scene.motion, scene.first_change(now), staged.ready.plan, begin=wished)
    return _with(replace(scene, left=()), staged, over)


def _late(staged: RunningBlock) -> tuple[Notice, ...]:
    """Says when a block that refers to others begins too late to meet them."""
    asked = staged.ready.asked
    late = staged.zero - asked.zero
    if not asked.is_anchored or late <= SHIFT_TO_WARN:
        return ()
    text = f"it begins {late:.3f} s too late to meet the sync points of other blocks"
    return (Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, staged.id, text),)


def _with(scene: Scene, staged: RunningBlock, laid: MergedMotion) -> tuple[Scene, RunningBlock, tuple[Notice, ...]]:
    own = replace(staged, merged=laid, zero=laid.zero, times=times_of(laid.syncs))
    return replace(scene, motion=laid.trajectory), own, laid.notices
