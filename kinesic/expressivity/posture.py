"""Postures of trunk, arms and head, temporary or permanent.

Trunk, head and arms take a posture together, and return unless it stays.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from kinesic.bml.block import HandMode, Posture, TimedBehaviour
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.behaviours import (
    Move,
    drop_behaviour,
    hanging_arms,
    stays,
    substitution_outcome,
    without_upright,
)
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.hands.strokes import Stroke
from kinesic.expressivity.head import direction
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.movement_words import movement_words, read_head_name, read_trunk_name
from kinesic.expressivity.lexicon.names import shorten_name
from kinesic.expressivity.present_arms import fit_form, select_present
from kinesic.expressivity.trunk import Lean, hold_lean, limit_trunk, trunk_direction
from kinesic.expressivity.turns import (
    UPRIGHT_TURN,
    add_turns,
    clip_turn,
    layers_of_holds,
    rest_turn,
    rotation_range,
    scale_turn,
    set_passages,
)

LEAN_AMOUNT = 0.5  # factor on trunk and head rotations that are part of a posture

_ARM_PARTS: Mapping[str, HandMode] = {"ARMS": "both", "LEFT_ARM": "left", "RIGHT_ARM": "right"}
_TRUNK_PARTS = ("BODY", "TORSO", "SPINE", "TRUNK")  # pose parts that move the trunk
_WHOLE_BODY = "WHOLEBODY"  # pose part of trunk and arms
_GESTURE_POSES = {"open": "welcome"}  # word for an arm pose -> gesture whose final pose shows this arm pose
_HANGING_WORDS = frozenset({"neutral", "idle", "stand", "rest", "hang", "side"})  # words for arms that hang

Arms = GestureForm | HandMode  # form of a rest gesture, or which arms hang
_MODE_SIDES: Mapping[str, tuple[Side, ...]] = {"both": ("l", "r"), "left": ("l",), "right": ("r",)}


@dataclass(frozen=True, eq=False)
class Pose:
    """Trunk, head and arm poses of a posture."""

    lean: Lean
    arms: tuple[Arms, ...] = ()
    head: Turn = UPRIGHT_TURN
    left_out: str = ""  # parts that the robot cannot perform
    names_trunk: bool = False  # whether the pose sets the trunk, possibly to upright


@dataclass(frozen=True, eq=False)
class _PosePart:
    """Contribution of one pose lexeme to a posture."""

    lean: Turn = UPRIGHT_TURN
    arms: Arms | None = None
    head: Turn = UPRIGHT_TURN
    names_trunk: bool = False


def pose(posture: Posture, lexicon: Lexicon, robot: Robot) -> Pose | None:
    """Return the trunk, head and arm poses of a posture behaviour.

    Of a stance the upper body performs its part: sitting puts the hands in the lap, crouching bends the trunk forward,
    standing lets the arms hang. An explicit pose of the arms has precedence.

    Returns:
        None when the robot can perform no part of it.
    """
    parts, left_out = _pose_parts(posture, lexicon, robot)
    arms = tuple(part.arms for part in parts if part.arms is not None)
    stance = (posture.stance or "").upper()
    if stance:
        stance_part = _stance_part(stance, lexicon, stays=posture.shift)
        if stance_part is None:
            left_out.append(f"no stance {posture.stance}, as the base is fixed")
        else:
            parts.append(replace(stance_part, arms=None))
            arms = arms or ((stance_part.arms,) if stance_part.arms is not None else ())
    if not parts:
        return None
    lean_turn, head_turn = UPRIGHT_TURN, UPRIGHT_TURN
    for part in parts:
        lean_turn, head_turn = add_turns(lean_turn, part.lean), add_turns(head_turn, part.head)
    sets_trunk = any(part.names_trunk for part in parts) and bool(robot.joints("torso"))
    return Pose(
        limit_trunk(lean_turn, robot),
        arms,
        clip_turn(head_turn, rotation_range(robot, "neck")),
        "; ".join(left_out),
        sets_trunk,
    )


def _pose_parts(posture: Posture, lexicon: Lexicon, robot: Robot) -> tuple[list[_PosePart], list[str]]:
    """Return the contributions of pose lexemes, and reasons for omitted lexemes.

    Of two for one arm, the first counts.
    """
    parts: list[_PosePart] = []
    left_out: list[str] = []
    lexeme_by_side: dict[Side, str] = {}
    for name, lexeme in posture.poses:
        part = _pose_part(name.upper(), lexeme, lexicon)
        sides: tuple[Side, ...] = () if part is None or part.arms is None else _sides(part.arms)
        earlier = next((lexeme_by_side[side] for side in sides if side in lexeme_by_side), None)
        if part is None:
            left_out.append(f"no pose {shorten_name(lexeme)} of {name}")
        elif earlier is not None:
            left_out.append(f"the pose {lexeme} of {name} is left out: the arms are in {earlier}")
        elif part.head != UPRIGHT_TURN and not robot.joints("neck"):
            left_out.append(f"no neck for the pose {lexeme} of {name}")
        else:
            parts.append(part)
            lexeme_by_side |= dict.fromkeys(sides, lexeme)
    return parts, left_out


def _sides(arms: Arms) -> tuple[Side, ...]:
    return tuple(sorted(arms.sides)) if isinstance(arms, GestureForm) else _MODE_SIDES[arms]


def _stance_part(stance: str, lexicon: Lexicon, *, stays: bool) -> _PosePart | None:
    match stance:
        case "STANDING":
            return _PosePart(arms="both" if stays else None)
        case "SITTING":
            return _PosePart(arms=_find_arm_pose("lap", "both", lexicon))
        case "CROUCHING":
            return _PosePart(lean=scale_turn(trunk_direction(("forward",)) or UPRIGHT_TURN, LEAN_AMOUNT))
    return None


def _pose_part(name: str, lexeme: str, lexicon: Lexicon) -> _PosePart | None:
    """Return the contribution of one pose lexeme.

    Returns:
        None if the lexeme is unknown.
    """
    if name in _ARM_PARTS:
        arms = _find_arm_pose(lexeme, _ARM_PARTS[name], lexicon)
        return None if arms is None else _PosePart(arms=arms)
    if name == "HEAD":
        head_name = read_head_name(lexeme)
        return (
            _PosePart(head=scale_turn(direction(head_name.words), LEAN_AMOUNT))
            if head_name and head_name.kind == "direction"
            else None
        )
    if name == _WHOLE_BODY or name in _TRUNK_PARTS:
        lean_turn = trunk_direction(read_trunk_name(lexeme))
        arms = (
            None
            if name != _WHOLE_BODY or lean_turn not in (None, UPRIGHT_TURN)
            else _find_arm_pose(lexeme, "both", lexicon)
        )
        if lean_turn is not None or arms is not None:
            return _PosePart(
                lean=scale_turn(lean_turn or UPRIGHT_TURN, LEAN_AMOUNT), arms=arms, names_trunk=lean_turn is not None
            )
    return None


def _find_arm_pose(lexeme: str, mode: HandMode, lexicon: Lexicon) -> Arms | None:
    """Return a pose's gesture form, or which arms hang, or None.

    Returns:
        None when the lexicon has no such pose.
    """
    performed = movement_words(lexeme)
    if _HANGING_WORDS & {*performed}:
        return mode
    gesture = next((form for word, form in _GESTURE_POSES.items() if word in performed), None)
    if gesture is not None and (match := lexicon.find(gesture, mode)) is not None and match.form.keys:
        return replace(match.form, keys=match.form.keys[-1:], rest=True)
    for name in (lexeme, f"arms {lexeme}"):  # the draft's CROSSED of ARMS
        match = lexicon.find(name, mode, category="rest")
        if match is not None and match.form.rest and match.form.keys:
            return match.form
    return None


def posture_moves(postures: Sequence[TimedBehaviour], context: BlockContext) -> Mapping[str, Move]:
    """Convert <posture> behaviours to trunk and head layers and arm poses.

    Later postures override earlier ones.
    """
    moves: dict[str, Move] = {}
    performed: list[tuple[TimedBehaviour, Pose]] = []
    for timed in sorted(postures, key=lambda timed: timed.times["start"]):
        action = timed.behaviour.action
        if not isinstance(action, Posture):
            raise TypeError(f"{timed.behaviour.id} is a {type(action).__name__}, not a posture")
        posture_pose = pose(action, context.lexicon, context.robot)
        if posture_pose is None:
            stance_text = [f"stance {action.stance}"] if action.stance else []
            names = ", ".join((*stance_text, *(f"{shorten_name(lexeme)} of {part}" for part, lexeme in action.poses)))
            hint = "standing, sitting, leaning, and rest poses of the arms, are valid"
            moves[timed.behaviour.id] = drop_behaviour(f"no pose {names}; {hint}")
        elif posture_pose.lean.clipped and posture_pose.lean.turn == UPRIGHT_TURN and not posture_pose.arms:
            moves[timed.behaviour.id] = drop_behaviour(f"the trunk cannot: {posture_pose.lean.clipped}")
        else:
            performed.append((timed, posture_pose))
    trunks, heads = (
        layers_of_holds(
            [
                hold_lean(turn, timed.times, chain=chain, stays=stays(timed.behaviour.action), pace=context.pace)
                for timed, turn in turns
            ]
        )
        for chain, turns in (
            ("torso", [(timed, _from_standing(posture_pose, context.robot)) for timed, posture_pose in performed]),
            ("neck", [(timed, posture_pose.head) for timed, posture_pose in performed]),
        )
    )
    for (timed, posture_pose), trunk, head in zip(performed, trunks, heads, strict=True):
        outcome, warnings = substitution_outcome(posture_pose.left_out, posture_pose.lean.clipped)
        head_turn = set_passages(head, context.manner(timed.behaviour, "head")) if context.robot.joints("neck") else ()
        lean_turn = set_passages(trunk, context.manner(timed.behaviour, "torso"))
        moves[timed.behaviour.id] = Move(
            outcome,
            head=without_upright(head_turn),
            torso=(lean_turn,)
            if posture_pose.names_trunk and stays(timed.behaviour.action)
            else without_upright(lean_turn),
            strokes=tuple(stroke for arms in posture_pose.arms for stroke in _arm_strokes(timed, arms, context)),
            warnings=warnings,
        )
    return moves


def _from_standing(posture_pose: Pose, robot: Robot) -> Turn:
    """Return the trunk rotation that a pose adds to the standing posture."""
    turn = posture_pose.lean.turn
    return add_turns(turn, scale_turn(rest_turn(robot, "torso"), -1.0)) if posture_pose.names_trunk else turn


def _arm_strokes(timed: TimedBehaviour, arms: Arms, context: BlockContext) -> tuple[Stroke, ...]:
    """Return arm motions into a posture and, if temporary, to rest."""
    times, shift, manner = timed.times, stays(timed.behaviour.action), context.manner(timed.behaviour)
    if isinstance(arms, GestureForm):
        present = fit_form(arms, context.robot)
        if present.dropped:
            return ()
        work = poses(present.form, context.robot, manner)
    else:
        work = hanging_arms(select_present(_MODE_SIDES[arms], context.robot))
    arrival_time = times["end"] if shift else times["ready"]
    departure = times["end"] if shift else times["relax"]
    into_pose = Stroke(timed.behaviour.id, _instant_syncs(times["start"], arrival_time), (work,), rest=True)
    out_of_pose = Stroke(
        timed.behaviour.id, _instant_syncs(departure, times["end"]), (hanging_arms(tuple(work.hands)),), rest=True
    )
    return (into_pose,) if shift else (into_pose, out_of_pose)


def _instant_syncs(start: float, arrive: float) -> dict[str, float]:
    """Return an arm motion's sync times [s], with later points at arrival."""
    return {"start": start} | dict.fromkeys(("ready", "strokeStart", "stroke", "strokeEnd", "relax", "end"), arrive)
