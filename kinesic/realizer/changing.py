"""A block that plays or waits is performed by another plan: a better one, or one in another manner."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict, replace

from kinesic.bml.block import (
    RANGES,
    Behaviour,
    Block,
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
from kinesic.realizer.feedback import order_feedback, retime_feedback, times_of
from kinesic.realizer.pointing import aim_again
from kinesic.realizer.replan import replan
from kinesic.realizer.request import TimedRequest, again
from kinesic.realizer.running_block import PreparedBlock, RunningBlock
from kinesic.realizer.scene import Scene

Change = Callable[[Behaviour], Behaviour]


def improve_block(scene: Scene, block_id: str, better: Plan, now: float) -> Scene | None:
    """Goes on with a block by another plan of it.

    Args:
        scene: with the block.
        block_id: of the block.
        better: the other plan.
        now: [s] global time.

    Returns:
        The scene, whose next messages tell what changed in time. None when the block is over, or the motion cannot go
        over into the other plan any more: what plays then plays to its end.
    """
    staged = scene.find(block_id)
    if staged is None:
        return None
    if not staged.state.is_playing:
        left = replace(staged, ready=PreparedBlock(staged.ready.asked, better), times=times_of(better.syncs))
        return _told(scene, staged, left, now)
    if staged.merged is None or not _says_the_same(better, staged.ready.plan):
        return None
    better = replace(better, utterances=staged.ready.plan.utterances)
    others = scene.busy_but(block_id)
    over = replan(scene.motion, scene.first_change(now), staged.merged, better, others=others)
    if over is None:
        return None
    kept = {id: at for id, at in times_of(over.syncs).items() if id in staged.times}
    left = replace(staged, ready=PreparedBlock(staged.ready.asked, better), merged=over, times=kept)
    agenda = retime_feedback(scene.agenda, block_id, left.agenda(), now)
    after = _told(replace(scene, motion=over.trajectory, agenda=agenda), staged, left, now)
    after = aim_again(scene, after, now)
    astray = after.said[len(scene.said) :]
    return replace(after, said=scene.said, agenda=order_feedback(astray, after.agenda))


def _says_the_same(better: Plan, plan: Plan) -> bool:
    """Whether what is under way is said as it is."""

    def said(of: Plan) -> dict[str, tuple[float, dict[str, float]]]:
        return {id: (each.duration, dict(each.marks)) for id, each in of.utterances.items()}

    return said(better) == said(plan)


def change_manner(
    scene: Scene,
    now: float,
    *,
    style: Style | str | None = None,
    amount: float | None = None,
    block: str | None = None,
) -> Scene:
    """Asks for another manner, of one block or of all; `take_replans` says what is to be planned for it.

    What was said before is taken away.

    Args:
        scene: at some time before.
        now: [s] global time.
        style: another one; for one block the name of a preset.
        amount: of all movements that have one, 0..1.
        block: its id; None: every block, and the style is that of all to come.

    Returns:
        The scene with wishes, in which is said what is to be sent now.

    Raises:
        ConfigError: there is no style of this name.
        ValueError: the amount is outside 0..1.
    """
    if amount is not None and not 0.0 <= amount <= 1.0:
        raise ValueError(f"amount is {amount:g}, outside [0, 1]")
    scene, name = replace(scene, said=()), None
    if style is not None:
        loaded = Style.load(style) if isinstance(style, str) else style
        if block is None:
            scene = replace(scene, setup=replace(scene.setup, style=loaded))
        else:
            name = style_preset(loaded.name).name

    def change(behaviour: Behaviour) -> Behaviour:
        sized = behaviour if amount is None else _with_amount(behaviour, amount)
        return sized if name is None else _with(sized, "style", name)

    return _wished(scene, change, now, [each.id for each in scene.blocks if block in (None, each.id)])


def change_parameter(scene: Scene, by: RunningBlock, behaviour: str, action: ParameterChange, now: float) -> Scene:
    """Does what a `parameterValueChange` asks for.

    Args:
        scene: in which it stands.
        by: the block with it.
        behaviour: its id there.
        action: what is to change.
        now: [s] global time.
    """
    target, _, one = action.target.partition(":")
    try:
        change = _change_of(action.parameter, action.value)
    except (ValueError, ConfigError) as error:
        notice = Notice(NoticeType.CUSTOM_BEHAVIOUR_NOT_SUPPORTED, f"{by.id}:{behaviour}", str(error))
        return scene.say(by.warning(notice, now))

    def only(each: Behaviour) -> Behaviour:
        return change(each) if one in ("", each.id) else each

    return _wished(scene, only, now, [target])


def take_replans(scene: Scene) -> tuple[Scene, tuple[TimedRequest, ...]]:
    """Blocks that are to be planned anew, each to be handed to `ready` and its plan to `improve_block`; told once."""
    return replace(scene, wishes=()), scene.wishes


def _wished(scene: Scene, change: Change, now: float, ids: Collection[str]) -> Scene:
    """Blocks with changed behaviours, as wishes; one that cannot be timed so stays as it is."""
    wishes: Mapping[str, TimedRequest] = {wish.block.id: wish for wish in scene.wishes}
    for staged in scene.blocks:
        if staged.id in ids:
            wish = wishes.get(staged.id, staged.ready.wish)
            changed = replace(wish, block=_changed(wish.block, change), is_decided=staged.state.is_playing)
            try:
                wishes = {**wishes, staged.id: again(changed, scene.setup)}
            except BmlError as error:
                notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, staged.id, f"it stays as it is: {error}")
                scene = scene.say(staged.warning(notice, now))
    return replace(scene, wishes=tuple(wishes.values()))


def _changed(block: Block, change: Change) -> Block:
    return replace(block, behaviours=tuple(map(change, block.behaviours)))


def _change_of(parameter: str, value: str) -> Change:
    """What a parameter does to a behaviour.

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


def _told(scene: Scene, before: RunningBlock, staged: RunningBlock, now: float) -> Scene:
    """The scene with a block that goes on otherwise: its times are told where they differ, and what is new of it."""
    doubts = [due for due in scene.agenda if due.unless_improved == staged.id]
    known = before.certain if doubts else before.ready.plan.notices
    news = [staged.warning(notice, now) for notice in staged.certain if notice not in known]
    if staged.differs(SHIFT_TO_WARN):
        news.insert(0, staged.prediction(now))
        staged = replace(staged, told=(staged.zero, staged.times))
    agenda = [due for due in scene.agenda if due.unless_improved != staged.id]
    return replace(scene.put(staged), agenda=order_feedback(news, agenda))
