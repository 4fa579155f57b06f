"""Conversion of each behaviour to head and torso layers and hand strokes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from kinesic.bml.block import (
    Gaze,
    Gesture,
    HandMode,
    Head,
    HeadDirectionShift,
    Modality,
    NoticeType,
    Pointing,
    Posture,
    TimedBehaviour,
    Torso,
)
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity import trunk
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.hands.captured_aim import aim_captured, is_captured
from kinesic.expressivity.hands.fingers import lacking_shapes
from kinesic.expressivity.hands.poses import REST_HAND, Poses, pointing_poses, poses
from kinesic.expressivity.hands.strokes import Stroke
from kinesic.expressivity.head import head_form, head_layer
from kinesic.expressivity.keyframes import Outcome
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.form import GestureForm, Match
from kinesic.expressivity.lexicon.lexicon import in_mode, mirror_form
from kinesic.expressivity.lexicon.names import shorten_name
from kinesic.expressivity.lexicon.shape_override import unknown_shape, with_shape
from kinesic.expressivity.missing_fingers import describe_missing_fingers, describe_missing_shapes
from kinesic.expressivity.present_arms import PresentForm, describe_missing_arm, fit_form, select_present
from kinesic.expressivity.turns import UPRIGHT_TURN, Layer, layers_of_holds, set_passages

REALISED_OUTCOME = Outcome("realised")  # outcome of a behaviour that is performed as requested
POINTING_SHAPE = "index"  # hand shape of pointing hands
POINTING_CATEGORY = "deictic"  # category of gestures that point
EXTENT_GAIN = 0.5  # relative increase of the body motion at a spatial extent of 1, decrease at -1
# End of the message about an unknown head movement.
HEAD_MOVEMENTS = "nod, shake, up, down, left, right, aside, tilt, forward, back and their synonyms are valid"
# Modalities whose spatial extents scale the body motion of head, trunk and shoulders.
SCALED_MODALITIES: tuple[Modality, Modality, Modality] = ("head", "torso", "gesture")
COUNTING_PREFIX = "count"  # name prefix of gestures that count on one hand


@dataclass(frozen=True)
class BehaviourWarning:
    """Warning for the sender of a behaviour."""

    type: NoticeType
    text: str


@dataclass(frozen=True, eq=False)
class Move:
    """Motion of one behaviour by body part, before merging into key frames."""

    outcome: Outcome = REALISED_OUTCOME
    head: tuple[Layer, ...] = ()
    torso: tuple[Layer, ...] = ()
    strokes: tuple[Stroke, ...] = ()
    warnings: tuple[BehaviourWarning, ...] = ()
    shapes: tuple[str, ...] = ()  # names of the requested hand shapes


def drop_behaviour(why: str, type: NoticeType = NoticeType.CANNOT_CREATE_BEHAVIOR) -> Move:
    """Create an empty motion with outcome and warning for a dropped behaviour."""
    return Move(Outcome("dropped", why), warnings=(BehaviourWarning(type, f"left out: {why}"),))


def gesture_move(timed: TimedBehaviour, action: Gesture, context: BlockContext) -> Move:
    """Convert a gesture of the lexicon to hand strokes.

    An unknown gesture is dropped with a warning. A one-handed gesture without a requested hand may use either hand. A
    deictic gesture with a target points at it.
    """
    match = context.find_gesture(timed.behaviour, action)
    if match is None:
        near = ", ".join(context.lexicon.near(action.lexeme))
        hint = f"similar: {near}, which may have another meaning" if near else "`kinesic gestures list` shows all"
        return drop_behaviour(f"the lexicon has no gesture for {shorten_name(action.lexeme)}; {hint}")
    match = replace(match, form=with_shape(match.form, action.shape))
    requested_shapes = (*match.form.shapes, *((action.shape,) if unknown_shape(action.shape) else ()))
    match = _apply_fallback(match, action, context)
    present = fit_form(match.form, context.robot, action.mode)
    if present.dropped:
        return drop_behaviour(present.dropped)
    form = present.form
    if not form.keys and not form.rest:
        return drop_behaviour(f"gesture {form.id} has no stroke")
    target_warnings = _target_warnings(action, form, context)
    place = None if action.target is None or target_warnings else context.find_target(action.target)
    if action.target is not None and place is not None:
        if not is_captured(form):
            shape = action.shape or (POINTING_SHAPE if lacking_shapes(form.shapes, context.robot) else "")
            return pointing_move(timed, Pointing(action.target, action.mode, shape), context)
        form = _aim_form(form, action.mode, place, context.robot)
    manner = context.manner(timed.behaviour)
    form = replace(form, body=_scale_body(form.body, timed, context))
    options = [form]
    full_form = context.lexicon.forms_by_id[form.id]  # only forms for one unspecified hand may be mirrored
    if (
        place is None
        and action.mode == "unspecified"
        and len(form.sides) == len(full_form.sides) == 1
        and len(context.robot.sides) == len(SIDES)
        and not form.rest
    ):
        options.append(mirror_form(form))
        if (deviation := context.deviations.get(timed.behaviour.id)) is not None:
            options = deviation.order_hands(options)
    pose_options = tuple(
        poses(option, context.robot, manner) if option.keys else hanging_arms(context.robot.sides) for option in options
    )
    pose_options = tuple(work.with_effort(context.styles[timed.behaviour.id].effort) for work in pose_options)
    outcome, warnings = _match_outcome(replace(match, form=form), action.shape, context.robot, present)
    may_split = action.mode == "unspecified"
    series = COUNTING_PREFIX if may_split and form.id.startswith(f"{COUNTING_PREFIX}_") else ""
    importance = 2 if timed.behaviour.required else 0 if form.category == "beat" else 1
    stroke = Stroke(timed.behaviour.id, timed.times, pose_options, form.rest, manner, may_split, importance, series)
    return Move(outcome, strokes=(stroke,), warnings=(*warnings, *target_warnings), shapes=requested_shapes)


def _aim_form(form: GestureForm, mode: HandMode, place: Floats, robot: Robot) -> GestureForm:
    """Aim a captured gesture of one hand at a place.

    By default, the hand on the side of the place points.
    """
    wished: Side = "l" if mode == "left" or (mode != "right" and place[1] > 0) else "r"
    (side, *_) = select_present((wished,), robot)
    return aim_captured(in_mode(form, "left" if side == "l" else "right"), side, place, robot)[0]


def _apply_fallback(match: Match, action: Gesture, context: BlockContext) -> Match:
    """Replace a gesture by its fallback if the robot lacks needed fingers."""
    form = match.form
    if not form.fallback or not lacking_shapes(form.shapes, context.robot):
        return match
    named_hands = context.lexicon.named_hands(form) if action.mode == "unspecified" else action.mode
    other = context.lexicon.find(form.fallback, named_hands)
    return (
        match
        if other is None
        else replace(other, substitute=f"{form.id} needs fingers; {other.form.id} is performed instead")
    )


def _match_outcome(
    match: Match, shape: str, robot: Robot, present: PresentForm
) -> tuple[Outcome, tuple[BehaviourWarning, ...]]:
    """Return the outcome and warnings of a lexicon match.

    The outcome is realised, substituted, or partial if a hand shape is unknown or the robot lacks fingers for the hand
    shapes or the finger motion.
    """
    synonym_text = f"a synonym of {match.form.id}" if match.kind == "synonym" and not match.substitute else ""
    lacking_text = describe_missing_fingers(match.form, robot)
    unknown_text = unknown_shape(shape)
    reasons = (match.substitute, present.swapped, present.reduced, lacking_text, unknown_text, synonym_text)
    why = "; ".join(filter(None, reasons))
    if match.substitute or present.swapped:
        return substitution_outcome(why)
    return _partly(why) if present.reduced or lacking_text or unknown_text else (Outcome("realised", why), ())


def _partly(why: str) -> tuple[Outcome, tuple[BehaviourWarning, ...]]:
    return Outcome("partly", why), (BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, f"partly: {why}"),)


def _target_warnings(action: Gesture, form: GestureForm, context: BlockContext) -> tuple[BehaviourWarning, ...]:
    """Return warnings about a gesture target that is unknown or unsupported."""
    if action.target is None:
        return ()
    if context.find_target(action.target) is None:
        return (BehaviourWarning(NoticeType.NO_SUCH_TARGET, context.unknown_target(action.target)),)
    if form.category != POINTING_CATEGORY:
        text = f"gesture {form.id} is not deictic, so its target is ignored"
        return (BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, text),)
    return ()


def pointing_move(timed: TimedBehaviour, action: Pointing, context: BlockContext) -> Move:
    """Convert a pointing behaviour to hand strokes.

    By default, the hand on the target's side points. A behaviour with an unknown target is dropped with a warning.
    Without a requested hand shape, a robot without fingers points with the whole hand.
    """
    place = context.find_target(action.target)
    if place is None:
        return drop_behaviour(context.unknown_target(action.target), NoticeType.NO_SUCH_TARGET)
    default_body = _scale_body(context.lexicon.bodies.get(POINTING_CATEGORY, NO_BODY), timed, context)
    bodies: Mapping[Side, BodyForm] = {"l": default_body.mirrored, "r": default_body}
    shape = action.shape or POINTING_SHAPE
    robot = context.robot
    work = {side: replace(pointing_poses(place, side, robot, shape), body=bodies[side]) for side in robot.sides}
    options = _order_pointing(work, action.mode, place, default_body.symmetric)
    manner, weight = context.manner(timed.behaviour, "gesture"), context.styles[timed.behaviour.id].effort
    importance = 2 if timed.behaviour.required else 1
    pose_options = tuple(option.with_effort(weight) for option in options)
    stroke = Stroke(timed.behaviour.id, timed.times, pose_options, manner=manner, importance=importance)
    target_warnings = unknown_shape(action.shape) or (describe_missing_shapes((shape,), robot) if action.shape else "")
    target_warnings = "; ".join(filter(None, (describe_missing_arm(action.mode, robot), target_warnings)))
    outcome, warnings = _partly(target_warnings) if target_warnings else (REALISED_OUTCOME, ())
    requested_shapes = (shape,) if action.shape or not lacking_shapes((shape,), robot) else ()
    return Move(outcome, strokes=(stroke,), warnings=warnings, shapes=requested_shapes)


def _order_pointing(work: Mapping[Side, Poses], mode: HandMode, place: Floats, body: BodyForm) -> tuple[Poses, ...]:
    """Return the poses of pointing hands, best first."""
    if len(work) < len(SIDES):
        return tuple(work.values())
    if mode == "both":
        return (Poses({side: work[side].hands[side] for side in SIDES}, work["l"].stroke, body=body),)
    if mode == "unspecified":
        return (work["l"], work["r"]) if place[1] > 0 else (work["r"], work["l"])
    return (work["l" if mode == "left" else "r"],)


def _scale_body(body: BodyForm, timed: TimedBehaviour, context: BlockContext) -> BodyForm:
    """Scale body motion by style weight and spatial extent."""
    weight = context.styles[timed.behaviour.id].whole_body
    head, trunk, arms = (
        weight * (1.0 + EXTENT_GAIN * context.manner(timed.behaviour, modality).spatial)
        for modality in SCALED_MODALITIES
    )
    return body.weighed(head=head, trunk=trunk, shoulders=arms, face=weight)


def head_move(timed: TimedBehaviour, action: Head, context: BlockContext) -> Move:
    """Convert a nod, shake or head direction to a head layer."""
    if not context.robot.joints("neck"):
        return missing_part("neck", context)
    manner = context.manner(timed.behaviour)
    form = head_form(action, context.robot, manner)
    if form is None:
        return drop_behaviour(f"head movement {shorten_name(action.lexeme)} is unknown; {HEAD_MOVEMENTS}")
    outcome, warnings = substitution_outcome(form.substitute, form.clipped)
    return Move(outcome, head=(head_layer(form, timed.times, context.pace, manner),), warnings=warnings)


def torso_move(timed: TimedBehaviour, action: Torso, context: BlockContext) -> Move:
    """Convert a lean or rotation of the torso to a layer."""
    if not context.robot.joints("torso"):
        return missing_part("torso", context)
    lean = trunk.named_lean(action, context.robot, context.manner(timed.behaviour).spatial)
    if lean is None:
        return drop_behaviour(
            f"torso movement {shorten_name(action.lexeme)} is unknown; lean, recline, turn, left and right are valid"
        )
    if lean.clipped and lean.turn == UPRIGHT_TURN:
        return drop_behaviour(f"the trunk cannot: {lean.clipped}")
    (layer,) = layers_of_holds([trunk.hold_lean(lean.turn, timed.times, chain="torso", stays=False, pace=context.pace)])
    return Move(torso=(set_passages(layer, context.manner(timed.behaviour)),), warnings=_clip_warning(lean.clipped))


def stays(action: object) -> bool:
    """Return whether a behaviour permanently changes gaze, head direction or posture."""
    return isinstance(action, HeadDirectionShift) or (isinstance(action, Gaze | Posture) and action.shift)


def hanging_arms(sides: Sequence[Side]) -> Poses:
    """Return stroke poses of given arms that hang at rest."""
    return Poses(dict.fromkeys(sides, (REST_HAND,)), stroke=0)


def without_upright(layer: Layer) -> tuple[Layer, ...]:
    """Return a tuple of the layer, empty if the layer stays upright."""
    return (layer,) if any(key.turn != UPRIGHT_TURN for key in layer) else ()


def missing_part(part: str, context: BlockContext) -> Move:
    """Create an empty motion for a body part that the robot lacks."""
    return drop_behaviour(f"robot {context.robot.name} has no {part}", NoticeType.BEHAVIOR_TYPE_NOT_SUPPORTED)


def _clip_warning(text: str) -> tuple[BehaviourWarning, ...]:
    return (BehaviourWarning(NoticeType.CANNOT_CREATE_BEHAVIOR, text),) if text else ()


def substitution_outcome(
    why: str, clipped: str = "", missing: str = ""
) -> tuple[Outcome, tuple[BehaviourWarning, ...]]:
    """Return outcome and warnings of a behaviour, substituted if `why` is given."""
    type = NoticeType.NO_SUCH_TARGET if missing else NoticeType.CANNOT_CREATE_BEHAVIOR
    warnings = (BehaviourWarning(type, why),) if why else ()
    return Outcome("substituted", why) if why else REALISED_OUTCOME, warnings + _clip_warning(clipped)
