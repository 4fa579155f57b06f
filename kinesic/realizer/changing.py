"""Plan changes of active blocks, for refinement or another style."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict, replace

from kinesic.bml.block import (
    EXPRESSIVITY_RANGES,
    Behaviour,
    BmlError,
    Face,
    Head,
    Manner,
    Notice,
    NoticeType,
    ParameterChange,
    Torso,
)
from kinesic.body.config import ConfigError
from kinesic.expressivity.style.style import Style, style_preset
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.realizer.ending import is_over
from kinesic.realizer.feedback import order_feedback, retime_feedback, times_by_behaviour, withdraw_provisional
from kinesic.realizer.pointing import restore_pointing
from kinesic.realizer.replan import replan
from kinesic.realizer.request import TimedRequest, retime_request
from kinesic.realizer.running_block import PreparedBlock, RunningBlock
from kinesic.realizer.scene import Scene

BehaviourChange = Callable[[Behaviour], Behaviour]


def improve_block(scene: Scene, block_id: str, new_plan: Plan, now: float) -> Scene | None:
    """Switch a block to a new plan, or return None if impossible.

    Args:
        scene: scene with the block.
        block_id: id of the block.
        new_plan: refined or restyled plan of the block.
        now: global time [s].

    Returns:
        The scene, whose agenda reports changed times. None if the block has ended or its motion cannot join the new
        plan; the old plan then continues to its end.
    """
    running, change = scene.find(block_id), scene.first_change(now)
    if running is None or is_over(scene, running, change):
        return None
    if not running.state.is_playing:
        prepared = PreparedBlock(running.prepared.request, new_plan)
        return _announce(
            scene, running, replace(running, prepared=prepared, times=times_by_behaviour(new_plan.syncs)), now
        )
    if running.merged is None or not _has_equal_speech(new_plan, running.prepared.plan):
        return None
    new_plan = replace(new_plan, utterances=running.prepared.plan.utterances)
    others = scene.occupancy_without(block_id)
    merged = replan(scene.motion, change, running.merged, new_plan, others=others)
    if merged is None:
        return None
    times = {id: at for id, at in times_by_behaviour(merged.syncs).items() if id in running.times}
    improved = replace(running, prepared=PreparedBlock(running.prepared.request, new_plan), merged=merged, times=times)
    agenda = retime_feedback(scene.agenda, running.run, improved.agenda(), change)
    after = _announce(replace(scene, motion=merged.trajectory, agenda=agenda), running, improved, now)
    after = restore_pointing(scene, after, now)
    warnings = after.outgoing_feedback[len(scene.outgoing_feedback) :]  # the agenda repeats them until sent
    return replace(after, outgoing_feedback=scene.outgoing_feedback, agenda=order_feedback(warnings, after.agenda))


def _has_equal_speech(new_plan: Plan, plan: Plan) -> bool:
    """Return whether both plans have the same speech durations and marks."""

    def speech(of: Plan) -> dict[str, tuple[float, dict[str, float]]]:
        return {id: (utterance.duration, dict(utterance.marks)) for id, utterance in of.utterances.items()}

    return speech(new_plan) == speech(plan)


def change_style(
    scene: Scene,
    now: float,
    *,
    style: Style | str | None = None,
    amount: float | None = None,
    block: str | None = None,
) -> Scene:
    """Request another style or amount of movement for one block or all.

    `take_replans` returns the requests to be planned. Earlier `outgoing_feedback` is cleared.

    Args:
        scene: scene at an earlier time.
        now: global time [s].
        style: new style; for a single block the name of a preset.
        amount: amount of all movements that have one, 0..1.
        block: id of the block; None changes all blocks and the style of future blocks.

    Returns:
        The scene with replanning requests and feedback to send now.

    Raises:
        ConfigError: there is no style of this name.
        ValueError: the amount is outside 0..1.
    """
    if amount is not None and not 0.0 <= amount <= 1.0:
        raise ValueError(f"amount is {amount:g}, outside [0, 1]")
    scene, name = replace(scene, outgoing_feedback=()), None
    if style is not None:
        loaded = style_preset(style) if isinstance(style, str) else style
        if block is None:
            scene = replace(scene, setup=replace(scene.setup, style=loaded))
        else:
            name = style_preset(loaded.name).name

    def change(behaviour: Behaviour) -> Behaviour:
        sized = behaviour if amount is None else _with_amount(behaviour, amount)
        return sized if name is None else _with_parameter(sized, "style", name)

    return _request_replans(scene, change, now, [running.id for running in scene.blocks if block in (None, running.id)])


def change_parameter(scene: Scene, by: RunningBlock, behaviour: str, action: ParameterChange, now: float) -> Scene:
    """Execute a `parameterValueChange` behaviour.

    An invalid parameter or value gives a warning.

    Args:
        scene: current scene.
        by: block that contains the behaviour.
        behaviour: id of the behaviour.
        action: requested change.
        now: global time [s].
    """
    target, _, target_behaviour = action.target.partition(":")
    try:
        change = _parameter_change(action.parameter, action.value)
    except (ValueError, ConfigError) as error:
        notice = Notice(NoticeType.CUSTOM_BEHAVIOUR_NOT_SUPPORTED, f"{by.id}:{behaviour}", str(error))
        return scene.with_feedback(by.warning(notice, now))

    def change_target(candidate: Behaviour) -> Behaviour:
        return change(candidate) if target_behaviour in ("", candidate.id) else candidate

    return _request_replans(scene, change_target, now, [target])


def take_replans(scene: Scene) -> tuple[Scene, tuple[TimedRequest, ...]]:
    """Return the scene without its replanning requests, and those requests.

    Each request goes to `prepare_block`, and its plan to `improve_block`.
    """
    return replace(scene, replans=()), scene.replans


def _request_replans(scene: Scene, change: BehaviourChange, now: float, ids: Collection[str]) -> Scene:
    """Change the behaviours of given blocks and request new plans.

    A block whose changed behaviours cannot be timed stays unchanged, with a warning.
    """
    replans: Mapping[str, TimedRequest] = {request.block.id: request for request in scene.replans}
    for running in scene.blocks:
        if running.id in ids:
            request = replans.get(running.id, running.prepared.replan_request)
            block = replace(request.block, behaviours=tuple(map(change, request.block.behaviours)))
            changed = replace(request, block=block, is_decided=running.state.is_playing)
            try:
                replans = {**replans, running.id: retime_request(changed, scene.setup)}
            except BmlError as error:
                notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, f"it is not changed: {error}")
                scene = scene.with_feedback(running.warning(notice, now))
    return replace(scene, replans=tuple(replans.values()))


def _parameter_change(parameter: str, value: str) -> BehaviourChange:
    """Return the behaviour change for a parameter and its value.

    Raises:
        ValueError: the parameter is unknown, or its value is not a number in its range.
        ConfigError: there is no style of this name.
    """
    if parameter == "style":
        name = style_preset(value).name
        return lambda behaviour: _with_parameter(behaviour, "style", name)
    ranges = {**EXPRESSIVITY_RANGES, "amount": (0.0, 1.0)}
    if parameter not in ranges:
        raise ValueError(f"parameter '{parameter}' cannot be changed; style, {', '.join(sorted(ranges))} can")
    lower, upper = ranges[parameter]
    try:
        number = float(value)
    except ValueError:
        raise ValueError(f"{parameter} '{value}' is not a number; expected {lower:g} to {upper:g}") from None
    if not lower <= number <= upper:
        raise ValueError(f"{parameter} is {number:g}, outside [{lower:g}, {upper:g}]")
    if parameter == "amount":
        return lambda behaviour: _with_amount(behaviour, number)
    return lambda behaviour: _with_parameter(behaviour, parameter, number)


def _with_parameter(behaviour: Behaviour, name: str, value: float | str) -> Behaviour:
    return replace(behaviour, manner=Manner(**{**asdict(behaviour.manner), name: value}))


def _with_amount(behaviour: Behaviour, amount: float) -> Behaviour:
    """Return a behaviour with another movement amount or spatial extent."""
    match behaviour.action:
        case Head() | Face() | Torso() as action:
            return replace(behaviour, action=replace(action, amount=amount))
    return _with_parameter(behaviour, "spatial", 2.0 * amount - 1.0)


def _announce(scene: Scene, before: RunningBlock, running: RunningBlock, now: float) -> Scene:
    """Replace a block's plan and schedule feedback on the changes."""
    agenda = withdraw_provisional(scene.agenda, running.id)
    had_provisional = len(agenda) < len(scene.agenda)
    old_notices = before.final_notices if had_provisional else before.prepared.plan.notices
    messages = [running.warning(notice, now) for notice in running.final_notices if notice not in old_notices]
    if running.differs_from_prediction(SHIFT_TO_WARN):
        messages.insert(0, running.prediction(now))
        running = replace(running, predicted=(running.zero, running.times))
    return replace(scene.with_block(running), agenda=order_feedback(messages, agenda))
