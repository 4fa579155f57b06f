"""Blocks of BML one after the other and at once: what becomes of a scene when something is asked or time passes.

Everything here is a pure function of a scene and a time; no clock, no threads. Whoever performs asks `ready` for the
plan of a block wherever there is time, hands it to `begin`, and calls `advance` again and again.
"""

from dataclasses import replace
from functools import partial

from kinesic.bml.block import Activate, Command, Interrupt, Notice, NoticeType, ParameterChange, modality_of
from kinesic.bml.composition import BlockState, awaited, goes_round, waiting_blocks
from kinesic.bml.feedback import warning
from kinesic.planning.certify import certify
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.changing import change_manner, change_parameter, improve_block, take_replans
from kinesic.realizer.contention import interrupted_by
from kinesic.realizer.ending import leave_out, stop_block
from kinesic.realizer.feedback import ScheduledFeedback, order_feedback
from kinesic.realizer.pointing import aim_again
from kinesic.realizer.request import TimedRequest
from kinesic.realizer.running_block import PreparedBlock, RunningBlock
from kinesic.realizer.scene import Scene, forgotten
from kinesic.realizer.starting import activate_block, start_block

__all__ = [
    "PreparedBlock",
    "Scene",
    "ScheduledFeedback",
    "advance",
    "begin",
    "change_manner",
    "improve_block",
    "interrupt",
    "ready",
    "take_replans",
]

MOST_BLOCKS = 256  # in a scene at once
AT_ONCE = partial(certify, lead_in=0.0)
SMALL = 4  # moving behaviours of a block that is planned well as quickly as not
BRIEF = 20.0  # [s] such a block may move


def ready(asked: TimedRequest, setup: Setup) -> PreparedBlock:
    """Plans a block so that it can begin at once: a small one well, a large one quickly, to be improved while it plays.

    Raises:
        BmlError: something `required` cannot be performed.
    """
    moving = [each for each in asked.timeline.timed if modality_of(each.behaviour.action) not in (None, "face")]
    times = [time for each in moving for time in each.times.values()]
    block, engaged = asked.block, asked.engaged
    if asked.is_decided:
        return PreparedBlock(
            asked, plan_block(block, setup, conditioned=AT_ONCE, utterances=asked.utterances, engaged=engaged)
        )
    if len(moving) <= SMALL and max(times, default=0.0) - min(times, default=0.0) <= BRIEF:
        return PreparedBlock(asked, plan_block(block, setup, conditioned=AT_ONCE, engaged=engaged))
    return PreparedBlock(asked, plan_quickly(block, setup, engaged=engaged), is_provisional=True)


def begin(scene: Scene, ready: PreparedBlock, now: float) -> Scene:
    """Takes a block into the scene: it begins now, or waits for its turn.

    Args:
        scene: at some time before.
        ready: the block.
        now: [s] global time.

    Returns:
        The scene with the block, in which is said what is to be sent now. A block that is refused changes nothing
        that plays.
    """
    scene = advance(scene, now)
    block = ready.plan.timeline.block
    refusal = _refusal(scene, ready)
    if refusal is not None:
        text = warning(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, block.id, refusal), character=block.character)
        return scene.say(ScheduledFeedback(now, text, ready.asked.sender))
    waits = awaited(block, scene.states)
    staged = RunningBlock.of(ready, BlockState.PENDING if block.succession.preplanned else BlockState.LURKING, waits)
    staged = replace(staged, zero=max(now + scene.ahead, scene.turn(staged)) + staged.lead)
    scene = _held_back(scene.put(staged), staged)
    if ready.is_provisional:
        scene = replace(
            scene, wishes=(*scene.wishes, ready.wish), agenda=order_feedback(scene.agenda, staged.doubts(now))
        )
    notices = tuple(staged.warning(notice, now) for notice in staged.certain)
    if scene.has_turn(staged, now):
        scene = start_block(scene, staged, now)
    else:
        scene = scene.put(replace(staged, told=(staged.zero, staged.times))).say(staged.prediction(now))
    return scene.say(*notices)


def advance(scene: Scene, now: float) -> Scene:
    """Lets time pass: blocks whose turn has come begin, feedback that is due is said, what is over is forgotten.

    What was said before is taken away.

    Args:
        scene: at some time before.
        now: [s] global time.
    """
    scene = replace(scene, said=())
    while True:
        coming = next((each for each in scene.blocks if scene.has_turn(each, now)), None)
        if coming is not None:
            scene = start_block(scene, coming, now)
        elif scene.agenda and scene.agenda[0].time <= now:
            due = scene.agenda[0]
            scene = _happened(replace(scene, agenda=scene.agenda[1:]).say(due), due, now)
        else:
            return forgotten(scene, now)


def interrupt(scene: Scene, now: float, block: str | None = None) -> Scene:
    """Ends one block or all of them; what others do goes on.

    Args:
        scene: at some time before.
        now: [s] global time.
        block: its id; None: all, those that wait too.
    """
    before = scene = advance(scene, now)
    for staged in before.blocks:
        if block in (None, staged.id):
            scene = stop_block(scene, staged, now, "it was interrupted")
    return aim_again(before, scene, now)


def _happened(scene: Scene, due: ScheduledFeedback, now: float) -> Scene:
    """What follows from a point that a block has passed."""
    point = due.told
    staged = None if isinstance(point, str) else scene.find(point.block)
    if isinstance(point, str) or staged is None:
        return scene
    match point.key:
        case (None, "relax"):
            return scene.put(replace(staged, state=BlockState.SUBSIDING))
        case (None, "end"):
            return scene.gone(staged, BlockState.DONE)
        case (str(id), "start"):
            action = next(behaviour.action for behaviour in staged.block.behaviours if behaviour.id == id)
            if isinstance(action, Interrupt | Activate | ParameterChange):
                return _commanded(scene, staged, id, action, now)
    return scene


def _commanded(scene: Scene, staged: RunningBlock, behaviour: str, action: Command, now: float) -> Scene:
    """What a block does to another one."""
    name = action.target.partition(":")[0]
    other = scene.find(name)
    if other is None:
        notice = Notice(
            NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{staged.id}:{behaviour}", f"no block {name} plays or waits"
        )
        return scene.say(staged.warning(notice, now))
    if isinstance(action, Activate):
        return activate_block(scene, name, now)
    if isinstance(action, ParameterChange):
        return change_parameter(scene, staged, behaviour, action, now)
    chosen = interrupted_by(action, other)
    if chosen == other.times.keys():
        after = stop_block(scene, other, now, f"{staged.id} interrupts it")
    else:
        after = leave_out(scene, other, chosen, now)
    return aim_again(scene, after, now)


def _held_back(scene: Scene, staged: RunningBlock) -> Scene:
    """Blocks that wait, and by this block's wish go after it, unless they would wait for themselves."""
    for id, until in waiting_blocks(staged.block, scene.states).items():
        other = scene.find(id)
        if other is not None:
            after = scene.put(replace(other, waits={**other.waits, staged.id: until}))
            if not goes_round({each.id: each.waits for each in after.blocks}, id):
                scene = after
    return scene


def _refusal(scene: Scene, ready: PreparedBlock) -> str | None:
    """Why a block is not taken; None when it is."""
    block = ready.plan.timeline.block
    same = scene.find(block.id)
    if same is not None:
        how = "plays" if same.state.is_playing else "waits"
        return f"a block of this id {how} already ({same.state.value}): give each block an id of its own"
    if scene.character is not None and block.character not in (None, scene.character):
        return f"it is for {block.character}, and {scene.character} performs here"
    if len(scene.blocks) >= MOST_BLOCKS:
        return f"{MOST_BLOCKS} blocks play and wait already, send it again when some are over"
    return None
