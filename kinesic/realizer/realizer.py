"""Realizer for sequential and simultaneous BML blocks.

All functions are pure functions of a scene and a time, without clocks and threads. A caller plans a block with
`prepare_block` in any process, adds it with `begin`, and calls `advance` repeatedly.
"""

from dataclasses import replace
from functools import partial

from kinesic.bml.block import Activate, BlockCommand, Interrupt, Notice, NoticeType, ParameterChange, find_modality
from kinesic.bml.composition import BlockState, find_prerequisites, find_waiting_blocks, is_waiting_for_itself
from kinesic.bml.feedback import write_warning
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.certify import certify
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.changing import change_parameter, change_style, improve_block, take_replans
from kinesic.realizer.contention import interrupted_by
from kinesic.realizer.ending import end_behaviours, end_block, stop_block
from kinesic.realizer.feedback import ScheduledFeedback, order_feedback
from kinesic.realizer.idling import begin_idle, end_idle
from kinesic.realizer.pointing import restore_pointing
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
    "change_style",
    "improve_block",
    "interrupt",
    "prepare_block",
    "stop_all_blocks",
    "take_replans",
]

MAX_BLOCKS = 256  # largest number of active blocks in a scene
CERTIFY_WITHOUT_LEAD_IN = partial(certify, lead_in=0.0)  # certification of blocks that start at once
MAX_WELL_PLANNED_BEHAVIOURS = 4  # largest number of moving behaviours of a block that needs no quick plan first
MAX_WELL_PLANNED_DURATION = 20.0  # [s] longest motion of a block that needs no quick plan first


def prepare_block(request: TimedRequest, setup: Setup, *, is_scheduled: bool = False) -> PreparedBlock:
    """Plan the motion of a scheduled block before it joins a scene.

    Plan a large one quickly and mark it for refinement.

    Args:
        request: scheduled block.
        setup: setup for planning.
        is_scheduled: whether it was scheduled with the same setup, so that its timeline is still valid.

    Raises:
        BmlError: a `required` behaviour cannot be performed.
    """
    moving = [item for item in request.timeline.timed if find_modality(item.behaviour.action) not in (None, "face")]
    times = [time for item in moving for time in item.times.values()]
    block, busy_hands = request.block, request.busy_hands
    if request.is_decided:
        plan = plan_block(
            block, setup, conditioned=CERTIFY_WITHOUT_LEAD_IN, utterances=request.utterances, busy_hands=busy_hands
        )
        return PreparedBlock(request, plan)
    duration = max(times, default=0.0) - min(times, default=0.0)
    if len(moving) <= MAX_WELL_PLANNED_BEHAVIOURS and duration <= MAX_WELL_PLANNED_DURATION:
        timeline = request.timeline if is_scheduled else None
        plan = plan_block(block, setup, conditioned=CERTIFY_WITHOUT_LEAD_IN, busy_hands=busy_hands, timeline=timeline)
        return PreparedBlock(request, plan)
    return PreparedBlock(request, plan_quickly(block, setup, busy_hands=busy_hands), is_provisional=True)


def begin(scene: Scene, prepared: PreparedBlock, now: float) -> Scene:
    """Add a planned block to the scene, to start now or wait.

    It waits for other blocks that it depends on, or for its activation.

    Args:
        scene: scene at an earlier time.
        prepared: planned block.
        now: global time [s].

    Returns:
        The scene with the block and feedback to send now. A refused block does not change running blocks.
    """
    scene = advance(scene, now)
    block = prepared.plan.timeline.block
    refusal = _refusal(scene, prepared)
    if refusal is not None:
        text = write_warning(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, block.id, refusal), character=block.character)
        return scene.with_feedback(ScheduledFeedback(now, text, prepared.request.sender))
    waits = find_prerequisites(block, scene.states)
    state = BlockState.PENDING if block.order.preplanned else BlockState.LURKING
    scene = replace(scene, runs=scene.runs + 1)
    running = RunningBlock.of(prepared, state, waits, run=scene.runs)
    running = replace(running, zero=max(now + scene.ahead, scene.earliest_start(running)) + running.lead_in)
    scene = _hold_back(scene.with_block(running), running)
    if prepared.is_provisional:
        agenda = order_feedback(scene.agenda, running.provisional_warnings(now))
        scene = replace(scene, replans=(*scene.replans, prepared.replan_request), agenda=agenda)
    warnings = tuple(running.warning(notice, now) for notice in running.final_notices)
    if scene.may_start(running, now):
        scene = start_block(scene, running, now)
    else:
        scene = scene.with_block(replace(running, predicted=(running.zero, running.times))).with_feedback(
            running.prediction(now)
        )
    return scene.with_feedback(*warnings)


def advance(scene: Scene, now: float) -> Scene:
    """Advance the scene: start waiting blocks, send due feedback, remove ended blocks.

    Earlier `outgoing_feedback` is cleared.

    Args:
        scene: scene at an earlier time.
        now: global time [s].
    """
    scene = replace(scene, outgoing_feedback=())
    while True:
        coming = next((item for item in scene.blocks if scene.may_start(item, now)), None)
        if coming is not None:
            scene = start_block(scene, coming, now)
        elif scene.agenda and scene.agenda[0].time <= now:
            message = scene.agenda[0]
            scene = _follow_up(replace(scene, agenda=scene.agenda[1:]).with_feedback(message), message, now)
        else:
            return forget_past(scene, now)


def interrupt(scene: Scene, now: float, block: str | None = None, *, yields: bool = False) -> Scene:
    """End one block, or all blocks and idle motion.

    Args:
        scene: scene at an earlier time.
        now: global time [s].
        block: id of the block; None ends all running and waiting blocks.
        yields: whether arms decelerate and hold before they return, as people do who let somebody speak.
    """
    before = scene = advance(scene, now)
    for running in before.blocks:
        if block in (None, running.id):
            scene = stop_block(scene, running, now, "it was interrupted", yields=yields)
    scene = scene if block is not None else replace(end_idle(scene, now), foreign_sound=None)
    return restore_pointing(before, scene, now)


def stop_all_blocks(scene: Scene, time: float, motion: Trajectory) -> Scene:
    """End all blocks and idle motion at an emergency stop.

    Args:
        scene: scene before the stop.
        time: global time [s] at which the deceleration began.
        motion: motion of the emergency stop.
    """
    scene = advance(replace(scene, ahead=0.0), time)
    for running in scene.blocks:
        scene = end_block(scene, running, time, "it was interrupted")
    texts = tuple(message for message in scene.agenda if message.block is None)
    return replace(scene, agenda=texts, motion=motion, idle=None, followed_face=None, foreign_sound=None)


def _follow_up(scene: Scene, message: ScheduledFeedback, now: float) -> Scene:
    """Update a block's state, or execute its command, after a passed point."""
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
    """Execute the command of a behaviour on another block."""
    name = action.target.partition(":")[0]
    other = scene.find(name)
    if other is None:
        text = f"no block {name} plays or waits"
        notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{running.id}:{behaviour}", text)
        return scene.with_feedback(running.warning(notice, now))
    if isinstance(action, Activate):
        return activate_block(scene, name, now)
    if isinstance(action, ParameterChange):
        return change_parameter(scene, running, behaviour, action, now)
    chosen = interrupted_by(action, other)
    if chosen == other.times.keys():
        after = stop_block(scene, other, now, f"{running.id} interrupts it")
    else:
        after = end_behaviours(scene, other, chosen, now)
    return restore_pointing(scene, after, now)


def _hold_back(scene: Scene, running: RunningBlock) -> Scene:
    """Make other blocks wait for this one, except for cyclic waits."""
    for id, until in find_waiting_blocks(running.block, scene.states).items():
        other = scene.find(id)
        if other is not None:
            after = scene.with_block(replace(other, waits={**other.waits, running.id: until}))
            if not is_waiting_for_itself({item.id: item.waits for item in after.blocks}, id):
                scene = after
    return scene


def _refusal(scene: Scene, prepared: PreparedBlock) -> str | None:
    block = prepared.plan.timeline.block
    same = scene.find(block.id)
    if same is not None:
        state = "plays" if same.state.is_playing else "waits"
        return f"a block of this id {state} already ({same.state.value}): give each block an id of its own"
    performer, agents = scene.setup.character, [item.agent for item in block.behaviours if item.agent is not None]
    if (
        performer is not None
        and len(agents) == len(block.behaviours)
        and (agents or block.character not in (None, performer))
    ):
        return f"it is for {' and '.join(dict.fromkeys(agents)) or block.character}, and {performer} performs here"
    if len(scene.blocks) >= MAX_BLOCKS:
        return f"{MAX_BLOCKS} blocks play and wait already; send it again when some have ended"
    return None
