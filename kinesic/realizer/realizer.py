"""Performs blocks of BML one after the other and at once: how a scene changes with requests and with time.

Everything here is a pure function of a scene and a time; no clock, no threads. Whoever performs plans a block by
`prepare_block` wherever there is time, hands it to `begin`, and calls `advance` again and again.
"""

from dataclasses import replace
from functools import partial

from kinesic.bml.block import Activate, BlockCommand, Interrupt, Notice, NoticeType, ParameterChange, modality_of
from kinesic.bml.composition import BlockState, required_before, waiting_blocks, waits_for_itself
from kinesic.bml.feedback import warning
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.certify import certify
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.changing import change_manner, change_parameter, improve_block, take_replans
from kinesic.realizer.contention import interrupted_by
from kinesic.realizer.ending import end_block, leave_out, stop_block
from kinesic.realizer.feedback import ScheduledFeedback, order_feedback
from kinesic.realizer.idling import begin_idle, end_idle
from kinesic.realizer.pointing import aim_again
from kinesic.realizer.request import TimedRequest
from kinesic.realizer.running_block import PreparedBlock, RunningBlock
from kinesic.realizer.scene import Scene, forget_past
from kinesic.realizer.starting import activate_block, start_block

__all__ = [
    "PreparedBlock",
    "Scene",
    "ScheduledFeedback",
    "advance",
    "begin",
    "begin_idle",
    "change_manner",
    "halt",
    "improve_block",
    "interrupt",
    "prepare_block",
    "take_replans",
]

MOST_BLOCKS = 256  # in a scene at once
AT_ONCE = partial(certify, lead_in=0.0)
SMALL = 4  # moving behaviours of a block that is planned well as quickly as not
BRIEF = 20.0  # [s] such a block may move


def prepare_block(request: TimedRequest, setup: Setup) -> PreparedBlock:
    """Plans a block so that it can begin at once: a small one well, a large one quickly, to be improved while it plays.

    Raises:
        BmlError: something `required` cannot be performed.
    """
    moving = [each for each in request.timeline.timed if modality_of(each.behaviour.action) not in (None, "face")]
    times = [time for each in moving for time in each.times.values()]
    block, engaged = request.block, request.engaged
    if request.is_decided:
        plan = plan_block(block, setup, conditioned=AT_ONCE, utterances=request.utterances, engaged=engaged)
        return PreparedBlock(request, plan)
    if len(moving) <= SMALL and max(times, default=0.0) - min(times, default=0.0) <= BRIEF:
        return PreparedBlock(request, plan_block(block, setup, conditioned=AT_ONCE, engaged=engaged))
    return PreparedBlock(request, plan_quickly(block, setup, engaged=engaged), is_provisional=True)


def begin(scene: Scene, prepared: PreparedBlock, now: float) -> Scene:
    """Takes a block into the scene: it begins now, or waits until it may start.

    Args:
        scene: at some time before.
        prepared: the block.
        now: [s] global time.

    Returns:
        The scene with the block, in which is said what is to be sent now. A block that is refused changes nothing
        that plays.
    """
    scene = advance(scene, now)
    block = prepared.plan.timeline.block
    refusal = _refusal(scene, prepared)
    if refusal is not None:
        text = warning(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, block.id, refusal), character=block.character)
        return scene.say(ScheduledFeedback(now, text, prepared.request.sender))
    waits = required_before(block, scene.states)
    state = BlockState.PENDING if block.succession.preplanned else BlockState.LURKING
    scene = replace(scene, runs=scene.runs + 1)
    running = RunningBlock.of(prepared, state, waits, run=scene.runs)
    running = replace(running, zero=max(now + scene.ahead, scene.earliest_start(running)) + running.lead)
    scene = _hold_back(scene.with_block(running), running)
    if prepared.is_provisional:
        agenda = order_feedback(scene.agenda, running.doubtful_warnings(now))
        scene = replace(scene, replans=(*scene.replans, prepared.replan_request), agenda=agenda)
    warnings = tuple(running.warning(notice, now) for notice in running.certain_notices)
    if scene.may_start(running, now):
        scene = start_block(scene, running, now)
    else:
        scene = scene.with_block(replace(running, predicted=(running.zero, running.times))).say(running.prediction(now))
    return scene.say(*warnings)


def advance(scene: Scene, now: float) -> Scene:
    """Lets time pass: blocks that may start begin, feedback that is due is said, and what is over is forgotten.

    What was said before is taken away.

    Args:
        scene: at some time before.
        now: [s] global time.
    """
    scene = replace(scene, said=())
    while True:
        coming = next((each for each in scene.blocks if scene.may_start(each, now)), None)
        if coming is not None:
            scene = start_block(scene, coming, now)
        elif scene.agenda and scene.agenda[0].time <= now:
            message = scene.agenda[0]
            scene = _follow_up(replace(scene, agenda=scene.agenda[1:]).say(message), message, now)
        else:
            return forget_past(scene, now)


def interrupt(scene: Scene, now: float, block: str | None = None) -> Scene:
    """Ends one block, or all of them and idle motion; what others do goes on.

    Args:
        scene: at some time before.
        now: [s] global time.
        block: its id; None: all, those that wait too.
    """
    before = scene = advance(scene, now)
    for running in before.blocks:
        if block in (None, running.id):
            scene = stop_block(scene, running, now, "it was interrupted")
    scene = scene if block is not None else end_idle(scene, now)
    return aim_again(before, scene, now)


def halt(scene: Scene, time: float, motion: Trajectory) -> Scene:
    """End all blocks and idle motion at an emergency stop.

    Args:
        scene: as it was before the stop.
        time: [s] global time at which the motion began to stop.
        motion: that plays instead.
    """
    scene = advance(replace(scene, ahead=0.0), time)
    for running in scene.blocks:
        scene = end_block(scene, running, time, "it was interrupted")
    texts = tuple(message for message in scene.agenda if message.block is None)
    return replace(scene, agenda=texts, motion=motion, idle=None)


def _follow_up(scene: Scene, message: ScheduledFeedback, now: float) -> Scene:
    """Does what follows from a point that a block has passed: its state changes, or it commands another block."""
    point = message.content
    running = None if isinstance(point, str) else scene.find(point.block)
    if isinstance(point, str) or running is None or running.run != point.run:
        return scene
    match point.key:
        case (None, "relax"):
            return scene.with_block(replace(running, state=BlockState.SUBSIDING))
        case (None, "end"):
            return scene.without_block(running, BlockState.DONE)
        case (str(id), "start"):
            action = next(behaviour.action for behaviour in running.block.behaviours if behaviour.id == id)
            if isinstance(action, Interrupt | Activate | ParameterChange):
                return _command(scene, running, id, action, now)
    return scene


def _command(scene: Scene, running: RunningBlock, behaviour: str, action: BlockCommand, now: float) -> Scene:
    """Does to another block what a behaviour of a running one asks for."""
    name = action.target.partition(":")[0]
    other = scene.find(name)
    if other is None:
        text = f"no block {name} plays or waits"
        notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{running.id}:{behaviour}", text)
        return scene.say(running.warning(notice, now))
    if isinstance(action, Activate):
        return activate_block(scene, name, now)
    if isinstance(action, ParameterChange):
        return change_parameter(scene, running, behaviour, action, now)
    chosen = interrupted_by(action, other)
    if chosen == other.times.keys():
        after = stop_block(scene, other, now, f"{running.id} interrupts it")
    else:
        after = leave_out(scene, other, chosen, now)
    return aim_again(scene, after, now)


def _hold_back(scene: Scene, running: RunningBlock) -> Scene:
    """Has blocks wait for this one where it says so, unless they would wait for themselves."""
    for id, until in waiting_blocks(running.block, scene.states).items():
        other = scene.find(id)
        if other is not None:
            after = scene.with_block(replace(other, waits={**other.waits, running.id: until}))
            if not waits_for_itself({each.id: each.waits for each in after.blocks}, id):
                scene = after
    return scene


def _refusal(scene: Scene, prepared: PreparedBlock) -> str | None:
    block = prepared.plan.timeline.block
    same = scene.find(block.id)
    if same is not None:
        how = "plays" if same.state.is_playing else "waits"
        return f"a block of this id {how} already ({same.state.value}): give each block an id of its own"
    own, others = scene.setup.character, [each.agent for each in block.behaviours if each.agent is not None]
    if own is not None and len(others) == len(block.behaviours) and (others or block.character not in (None, own)):
        return f"it is for {' and '.join(dict.fromkeys(others)) or block.character}, and {own} performs here"
    if len(scene.blocks) >= MOST_BLOCKS:
        return f"{MOST_BLOCKS} blocks play and wait already, send it again when some are over"
    return None
