"""Changes the plan of a block that plays or waits: to a better one, or to one in another style."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict, replace

from kinesic.bml.block import (
    RANGES,
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
from kinesic.realizer.feedback import order_feedback, retime_feedback, times_of, without_provisional
from kinesic.realizer.pointing import aim_again
from kinesic.realizer.replan import replan
from kinesic.realizer.request import TimedRequest, retime_request
from kinesic.realizer.running_block import PreparedBlock, RunningBlock
from kinesic.realizer.scene import Scene

BehaviourChange = Callable[[Behaviour], Behaviour]


def improve_block(scene: Scene, block_id: str, better: Plan, now: float) -> Scene | None:
    """Continues a block by another plan of it.

    Args:
        scene: with the block.
        block_id: of the block.
        better: the other plan.
        now: [s] global time.

    Returns:
        The scene, whose agenda says what changed in time. None when the block is over, or the motion cannot go over
        into the other plan any more: what plays then plays to its end.
    """
    running, change = scene.find(block_id), scene.first_change(now)
    if running is None or is_over(scene, running, change):
        return None
    if not running.state.is_playing:
        prepared = PreparedBlock(running.prepared.request, better)
        return _announce(scene, running, replace(running, prepared=prepared, times=times_of(better.syncs)), now)
    if running.merged is None or not _says_the_same(better, running.prepared.plan):
        return None
    better = replace(better, utterances=running.prepared.plan.utterances)
    others = scene.occupancy_without(block_id)
    merged = replan(scene.motion, change, running.merged, better, others=others)
    if merged is None:
        return None
    times = {id: at for id, at in times_of(merged.syncs).items() if id in running.times}
    improved = replace(running, prepared=PreparedBlock(running.prepared.request, better), merged=merged, times=times)
    agenda = retime_feedback(scene.agenda, running.run, improved.agenda(), change)
    after = _announce(replace(scene, motion=merged.trajectory, agenda=agenda), running, improved, now)
    after = aim_again(scene, after, now)
    warnings = after.said[len(scene.said) :]  # in the agenda they are proposed again until they are sent
    return replace(after, said=scene.said, agenda=order_feedback(warnings, after.agenda))


def _says_the_same(better: Plan, plan: Plan) -> bool:
    """Whether speech of both plans sounds at the same times."""

    def speech(of: Plan) -> dict[str, tuple[float, dict[str, float]]]:
        return {id: (each.duration, dict(each.marks)) for id, each in of.utterances.items()}

    return speech(better) == speech(plan)


def change_manner(
    scene: Scene,
    now: float,
    *,
    style: Style | str | None = None,
    amount: float | None = None,
    block: str | None = None,
) -> Scene:
    """Changes the style or the amount of one block or of all; `take_replans` says what is to be planned for it.

    What was said before is taken away.

    Args:
        scene: at some time before.
        now: [s] global time.
        style: another one; for one block the name of a preset.
        amount: of all movements that have one, 0..1.
        block: its id; None: every block, and the style is that of all to come.

    Returns:
        The scene with requests to plan blocks anew, in which is said what is to be sent now.

    Raises:
        ConfigError: there is no style of this name.
        ValueError: the amount is outside 0..1.
    """
    if amount is not None and not 0.0 <= amount <= 1.0:
        raise ValueError(f"amount is {amount:g}, outside [0, 1]")
    scene, name = replace(scene, said=()), None
    if style is not None:
        loaded = style_preset(style) if isinstance(style, str) else style
        if block is None:
            scene = replace(scene, setup=replace(scene.setup, style=loaded))
        else:
            name = style_preset(loaded.name).name

    def change(behaviour: Behaviour) -> Behaviour:
        sized = behaviour if amount is None else _with_amount(behaviour, amount)
        return sized if name is None else _with(sized, "style", name)

    return _request_replans(scene, change, now, [each.id for each in scene.blocks if block in (None, each.id)])


def change_parameter(scene: Scene, by: RunningBlock, behaviour: str, action: ParameterChange, now: float) -> Scene:
    """Does what a `parameterValueChange` asks for.

    Args:
        scene: in which it stands.
        by: the block with it.
        behaviour: its id there.
        action: what is to change.
        now: [s] global time.
    """
    target, _, target_behaviour = action.target.partition(":")
    try:
        change = _change_of(action.parameter, action.value)
    except (ValueError, ConfigError) as error:
        notice = Notice(NoticeType.CUSTOM_BEHAVIOUR_NOT_SUPPORTED, f"{by.id}:{behaviour}", str(error))
        return scene.say(by.warning(notice, now))

    def only(each: Behaviour) -> Behaviour:
        return change(each) if target_behaviour in ("", each.id) else each

    return _request_replans(scene, only, now, [target])


def take_replans(scene: Scene) -> tuple[Scene, tuple[TimedRequest, ...]]:
    """Takes the blocks to be planned anew: each goes to `prepare_block`, and its plan to `improve_block`."""
    return replace(scene, replans=()), scene.replans


def _request_replans(scene: Scene, change: BehaviourChange, now: float, ids: Collection[str]) -> Scene:
    """Has blocks planned anew with changed behaviours; one that cannot be timed so stays as it is."""
    replans: Mapping[str, TimedRequest] = {request.block.id: request for request in scene.replans}
    for running in scene.blocks:
        if running.id in ids:
            request = replans.get(running.id, running.prepared.replan_request)
            block = replace(request.block, behaviours=tuple(map(change, request.block.behaviours)))
            changed = replace(request, block=block, is_decided=running.state.is_playing)
            try:
                replans = {**replans, running.id: retime_request(changed, scene.setup)}
            except BmlError as error:
                notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, running.id, f"it stays as it is: {error}")
                scene = scene.say(running.warning(notice, now))
    return replace(scene, replans=tuple(replans.values()))


def _change_of(parameter: str, value: str) -> BehaviourChange:
    """The change of a behaviour that a parameter stands for.

    Raises:
        ValueError: it is not known, or its value is no number in its range.
        ConfigError: there is no style of this name.
    """
    if parameter == "style":
        name = style_preset(value).name
        return lambda behaviour: _with(behaviour, "style", name)
    ranges = {**RANGES, "amount": (0.0, 1.0)}
    if parameter not in ranges:
        raise ValueError(f"parameter '{parameter}' cannot be changed; style, {', '.join(sorted(ranges))} can")
    least, most = ranges[parameter]
    try:
        number = float(value)
    except ValueError:
        raise ValueError(f"{parameter} '{value}' is no number; from {least:g} to {most:g} is expected") from None
    if not least <= number <= most:
        raise ValueError(f"{parameter} is {number:g}, outside [{least:g}, {most:g}]")
    if parameter == "amount":
        return lambda behaviour: _with_amount(behaviour, number)
    return lambda behaviour: _with(behaviour, parameter, number)


def _with(behaviour: Behaviour, name: str, value: float | str) -> Behaviour:
    return replace(behaviour, manner=Manner(**{**asdict(behaviour.manner), name: value}))


def _with_amount(behaviour: Behaviour, amount: float) -> Behaviour:
    """A behaviour with another amount; one that has none is made as much wider or tighter."""
    match behaviour.action:
        case Head() | Face() | Torso() as action:
            return replace(behaviour, action=replace(action, amount=amount))
    return _with(behaviour, "spatial", 2.0 * amount - 1.0)


def _announce(scene: Scene, before: RunningBlock, running: RunningBlock, now: float) -> Scene:
    """Puts a block with another plan in its place, and schedules a prediction where times differ, and new warnings."""
    agenda = without_provisional(scene.agenda, running.id)
    is_doubtful = len(agenda) < len(scene.agenda)
    known = before.certain_notices if is_doubtful else before.prepared.plan.notices
    news = [running.warning(notice, now) for notice in running.certain_notices if notice not in known]
    if running.differs_from_prediction(SHIFT_TO_WARN):
        news.insert(0, running.prediction(now))
        running = replace(running, predicted=(running.zero, running.times))
    return replace(scene.with_block(running), agenda=order_feedback(news, agenda))
