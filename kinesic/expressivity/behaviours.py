"""Turns each behaviour into moves: rotations of head and torso, strokes of the hands, and what becomes of it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest

from kinesic.bml.block import (
    Gaze,
    Gesture,
    Head,
    HeadDirectionShift,
    Modality,
    NoticeType,
    Pointing,
    Posture,
    TimedBehaviour,
    Torso,
)
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity import gaze, trunk
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.gather import SAME_FRAME
from kinesic.expressivity.hands.fingers import lacking_shapes
from kinesic.expressivity.hands.poses import REST, Poses, pointing_poses, poses
from kinesic.expressivity.hands.strokes import Stroke
from kinesic.expressivity.head import head_form, head_layer
from kinesic.expressivity.keyframes import Outcome
from kinesic.expressivity.lexicon.asked_shape import unknown_shape, with_shape
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.form import GestureForm, Match
from kinesic.expressivity.lexicon.lexicon import mirror_form
from kinesic.expressivity.lexicon.names import shorten_name
from kinesic.expressivity.turns import UPRIGHT, Layer, exclusive, pass_layer

REALISED = Outcome("realised")
POINTED = "index"  # shape of a hand that points
DEICTIC = "deictic"  # category of gestures that point
EXTENT_GAIN = 0.5  # more of the body's part at a spatial extent of 1, and less at -1
HEAD_KNOWN = "nod, shake, up, down, left, right, aside, tilt, forward, back and their synonyms are known"
WEIGHED: tuple[Modality, Modality, Modality] = ("head", "torso", "gesture")
COUNTING = "count"  # gestures whose names begin with it count on one hand


@dataclass(frozen=True)
class BehaviourWarning:
    """A warning for the sender."""

    type: NoticeType
    text: str


@dataclass(frozen=True, eq=False)
class Move:
    """What one behaviour does, part by part, before all behaviours are gathered."""

    outcome: Outcome = REALISED
    head: tuple[Layer, ...] = ()
    torso: tuple[Layer, ...] = ()
    strokes: tuple[Stroke, ...] = ()
    warnings: tuple[BehaviourWarning, ...] = ()
    shapes: tuple[str, ...] = ()  # names of the hand shapes that are asked for


def drop_behaviour(why: str, type: NoticeType = NoticeType.CANNOT_CREATE_BEHAVIOR) -> Move:
    """Leaves a behaviour out, with the reason as a warning."""
    return Move(Outcome("dropped", why), warnings=(BehaviourWarning(type, f"left out: {why}"),))


def gesture_move(timed: TimedBehaviour, action: Gesture, context: BlockContext) -> Move:
    """Looks a gesture up in the lexicon; a one-handed one whose mode is open may take either hand.

    A deictic one with a target points at it.
    """
    match = context.find_gesture(timed.behaviour, action)
    if match is None:
        near = ", ".join(context.lexicon.near(action.lexeme))
        hint = f"near to it: {near}, which may mean something else" if near else "`kinesic gestures list` shows all"
        return drop_behaviour(f"the lexicon has no gesture for {shorten_name(action.lexeme)}; {hint}")
    match = replace(match, form=with_shape(match.form, action.shape))
    asked = (*match.form.shapes, *((action.shape,) if unknown_shape(action.shape) else ()))
    match = _for_hands(match, action, context)
    form = match.form
    if not form.keys and not form.rest:
        return drop_behaviour(f"gesture {form.id} has no stroke")
    unmet = _unmet(action, form, context)
    if action.target is not None and not unmet:
        return pointing_move(timed, Pointing(action.target, action.mode, action.shape), context)
    manner = context.manner(timed.behaviour)
    form = replace(form, body=_weigh_body(form.body, timed, context))
    options = [form]
    whole = context.lexicon.forms_by_id[form.id]  # whose one hand may be turned round, while that of `left` is `right`
    if action.mode == "unspecified" and len(form.sides) == len(whole.sides) == 1 and not form.rest:
        options.append(mirror_form(form))
        if (deviation := context.deviations.get(timed.behaviour.id)) is not None:
            options = deviation.order_hands(options)
    works = tuple(poses(option, context.robot, manner) if option.keys else hanging_arms(SIDES) for option in options)
    works = tuple(work.with_effort(context.styles[timed.behaviour.id].effort) for work in works)
    outcome, warnings = _match_outcome(match, action.shape, context.robot)
    halves = action.mode == "unspecified"
    series = COUNTING if halves and form.id.startswith(f"{COUNTING}_") else ""
    importance = 2 if timed.behaviour.required else 0 if form.category == "beat" else 1
    stroke = Stroke(timed.behaviour.id, timed.times, works, form.rest, manner, halves, importance, series)
    return Move(outcome, strokes=(stroke,), warnings=(*warnings, *unmet), shapes=asked)


def _for_hands(match: Match, action: Gesture, context: BlockContext) -> Match:
    """The gesture that this one names for a hand that cannot make its shapes, if it is such a hand."""
    form = match.form
    if not form.fallback or not lacking_shapes(form.shapes, context.robot):
        return match
    other = context.lexicon.find(form.fallback, action.mode)
    return match if other is None else replace(other, substitute=f"{form.id} needs fingers; {other.form.id} is done")


def _match_outcome(match: Match, shape: str, robot: Robot) -> tuple[Outcome, tuple[BehaviourWarning, ...]]:
    """Says how much of what is asked for is performed: not the hand shapes for which the robot lacks fingers."""
    named = f"a synonym of {match.form.id}" if match.kind == "synonym" and not match.substitute else ""
    lacking, unknown = _lacking_fingers(match.form.shapes, robot), unknown_shape(shape)
    why = "; ".join(filter(None, (match.substitute, lacking, unknown, named)))
    if match.substitute:
        return substitution_outcome(why)
    return _partly(why) if lacking or unknown else (Outcome("realised", why), ())


def _partly(why: str) -> tuple[Outcome, tuple[BehaviourWarning, ...]]:
    return Outcome("partly", why), (BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, f"partly: {why}"),)


def _lacking_fingers(asked: Sequence[str], robot: Robot) -> str:
    """Names the hand shapes that the hands of a robot cannot make; empty where they can make all."""
    shapes = [f'"{shape}"' for shape in lacking_shapes(asked, robot)]
    plural, singular = "s" * (len(shapes) > 1), "s" * (len(shapes) == 1)
    return f"hand shape{plural} {' and '.join(shapes)} need{singular} fingers" if shapes else ""


def _unmet(action: Gesture, form: GestureForm, context: BlockContext) -> tuple[BehaviourWarning, ...]:
    """Says why a gesture does not meet its target; empty when it does, or has none."""
    if action.target is None:
        return ()
    if context.find_target(action.target) is None:
        return (BehaviourWarning(NoticeType.NO_SUCH_TARGET, context.unknown_target(action.target)),)
    if form.category != DEICTIC:
        text = f"gesture {form.id} is no deictic one and leaves its target out"
        return (BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, text),)
    return ()


def pointing_move(timed: TimedBehaviour, action: Pointing, context: BlockContext) -> Move:
    """Points at a place, with the hand on its side unless the mode says which."""
    place = context.find_target(action.target)
    if place is None:
        return drop_behaviour(context.unknown_target(action.target), NoticeType.NO_SUCH_TARGET)
    usual = _weigh_body(context.lexicon.bodies.get(DEICTIC, NO_BODY), timed, context)
    bodies: Mapping[Side, BodyForm] = {"l": usual.mirrored, "r": usual}
    shape = action.shape or POINTED
    work = {side: replace(pointing_poses(place, side, context.robot, shape), body=bodies[side]) for side in SIDES}
    both = Poses({side: work[side].hands[side] for side in SIDES}, work["l"].stroke, body=usual.symmetric)
    nearer = (work["l"], work["r"]) if place[1] > 0 else (work["r"], work["l"])
    options = {"left": (work["l"],), "right": (work["r"],), "both": (both,), "unspecified": nearer}
    manner, weight = context.manner(timed.behaviour, "gesture"), context.styles[timed.behaviour.id].effort
    importance = 2 if timed.behaviour.required else 1
    works = tuple(option.with_effort(weight) for option in options[action.mode])
    stroke = Stroke(timed.behaviour.id, timed.times, works, manner=manner, importance=importance)
    unmet = unknown_shape(action.shape) or (_lacking_fingers((shape,), context.robot) if action.shape else "")
    outcome, warnings = _partly(unmet) if unmet else (REALISED, ())
    return Move(outcome, strokes=(stroke,), warnings=warnings, shapes=(shape,))


def _weigh_body(body: BodyForm, timed: TimedBehaviour, context: BlockContext) -> BodyForm:
    """Makes the body's part in a gesture as large as its style has it, and each part's spatial extent."""
    weight = context.styles[timed.behaviour.id].whole_body
    head, trunk, arms = (
        weight * (1.0 + EXTENT_GAIN * context.manner(timed.behaviour, modality).spatial) for modality in WEIGHED
    )
    return body.weighed(head=head, trunk=trunk, shoulders=arms, face=weight)


def head_move(timed: TimedBehaviour, action: Head, context: BlockContext) -> Move:
    """Nods, shakes the head, or turns it in a direction."""
    if not context.robot.joints("neck"):
        return _lacking("neck", context)
    manner = context.manner(timed.behaviour)
    form = head_form(action, context.robot, manner)
    if form is None:
        return drop_behaviour(f"no movement of the head is called {shorten_name(action.lexeme)}; {HEAD_KNOWN}")
    outcome, warnings = substitution_outcome(form.substitute, form.clipped)
    return Move(outcome, head=(head_layer(form, timed.times, context.pace, manner),), warnings=warnings)


def torso_move(timed: TimedBehaviour, action: Torso, context: BlockContext) -> Move:
    """Leans or turns the trunk, and returns."""
    if not context.robot.joints("torso"):
        return _lacking("torso", context)
    lean = trunk.named_lean(action, context.robot, context.manner(timed.behaviour).spatial)
    if lean is None:
        return drop_behaviour(
            f"torso movement {shorten_name(action.lexeme)} is unknown; lean, recline, turn, left and right are known"
        )
    if lean.clipped and lean.turn == UPRIGHT:
        return drop_behaviour(f"the trunk cannot: {lean.clipped}")
    (layer,) = exclusive([trunk.hold_lean(lean.turn, timed.times, chain="torso", stays=False, pace=context.pace)])
    return Move(torso=(pass_layer(layer, context.manner(timed.behaviour)),), warnings=_clip_warning(lean.clipped))


def look_moves(looks: Sequence[TimedBehaviour], context: BlockContext) -> Mapping[str, Move]:
    """Turns head and trunk for gazes and head directions, of which the later wins from its start.

    Args:
        looks: behaviours with a Gaze or HeadDirectionShift, in any order.
        context: of their block.
    """
    if not context.robot.joints("neck"):
        return {timed.behaviour.id: _lacking("neck", context) for timed in looks}
    moves: dict[str, Move] = {}
    aims: list[gaze.Aim] = []
    performed: list[TimedBehaviour] = []
    base = gaze.STRAIGHT
    for timed, other in _in_turn(looks):
        action = timed.behaviour.action
        if other is not None:
            why = f"{other.behaviour.id} looks elsewhere from the same moment"
            moves[timed.behaviour.id] = drop_behaviour(why, NoticeType.IMPOSSIBLE_TO_SCHEDULE)
            continue
        if not isinstance(action, Gaze | HeadDirectionShift):
            raise TypeError(f"{timed.behaviour.id} is a {type(action).__name__}, no gaze and no head direction")
        aim = gaze.aim(action, context, base)
        if aim is None:
            why = context.unknown_target(action.target or "")
            moves[timed.behaviour.id] = drop_behaviour(why, NoticeType.NO_SUCH_TARGET)
            continue
        base = aim if stays(action) else base
        aims.append(aim)
        performed.append(timed)
    return moves | _perform_looks(performed, aims, context)


def _in_turn(looks: Sequence[TimedBehaviour]) -> Iterator[tuple[TimedBehaviour, TimedBehaviour | None]]:
    """Yields looks in order of their starts, each with the next of its kind if that starts at the same time."""
    ordered = sorted(looks, key=lambda timed: timed.times["start"])
    for timed, other in zip_longest(ordered, ordered[1:]):
        action = timed.behaviour.action
        same = other is not None and type(other.behaviour.action) is type(action) and not stays(action)
        at_once = same and other.times["start"] - timed.times["start"] < SAME_FRAME
        yield timed, other if at_once else None


def stays(action: object) -> bool:
    """Whether a behaviour changes the posture to which others return."""
    return isinstance(action, HeadDirectionShift) or (isinstance(action, Gaze | Posture) and action.shift)


def _perform_looks(looks: Sequence[TimedBehaviour], aims: Sequence[gaze.Aim], context: BlockContext) -> dict[str, Move]:
    heads, trunks = (
        [
            gaze.hold_gaze(aim, timed.times, part=part, stays=stays(timed.behaviour.action), pace=context.pace)
            for aim, timed in zip(aims, looks, strict=True)
        ]
        for part in gaze.PARTS
    )
    head, lower = exclusive(heads), exclusive(trunks)
    moves: dict[str, Move] = {}
    for k, (timed, aim) in enumerate(zip(looks, aims, strict=True)):
        outcome, warnings = substitution_outcome(aim.substitute, aim.clipped, aim.missing)
        if k + 1 < len(heads) and (leave := heads[k].leave) is not None and heads[k + 1].start < leave:
            text = f"gives way to {looks[k + 1].behaviour.id} at {heads[k + 1].start:.2f} s"
            warnings += (BehaviourWarning(NoticeType.IMPOSSIBLE_TO_SCHEDULE, text),)
        manner = context.manner(timed.behaviour)
        here, below = pass_layer(head[k], manner), without_upright(pass_layer(lower[k], manner))
        moves[timed.behaviour.id] = Move(outcome, head=(here,), torso=below, warnings=warnings)
    return moves


def hanging_arms(sides: Sequence[Side]) -> Poses:
    """Makes the arms hang."""
    return Poses(dict.fromkeys(sides, (REST,)), stroke=0)


def without_upright(layer: Layer) -> tuple[Layer, ...]:
    """Leaves out a layer that is upright all the time."""
    return (layer,) if any(key.turn != UPRIGHT for key in layer) else ()


def _lacking(part: str, context: BlockContext) -> Move:
    return drop_behaviour(f"robot {context.robot.name} has no {part}", NoticeType.BEHAVIOR_TYPE_NOT_SUPPORTED)


def _clip_warning(text: str) -> tuple[BehaviourWarning, ...]:
    return (BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, text),) if text else ()


def substitution_outcome(
    why: str, clipped: str = "", missing: str = ""
) -> tuple[Outcome, tuple[BehaviourWarning, ...]]:
    """Makes the outcome and the warnings of a behaviour that is performed, if need be in another form."""
    type = NoticeType.NO_SUCH_TARGET if missing else NoticeType.CANNOT_CREATE_BEHAVIOR
    warnings = (BehaviourWarning(type, why),) if why else ()
    return Outcome("substituted", why) if why else REALISED, warnings + _clip_warning(clipped)
