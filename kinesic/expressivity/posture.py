"""Postures: how trunk, arms and head take a stance and poses, for a while or as the rest to which others return.

In time, trunk, head and arms go into a posture together, and come back unless they stay.
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
from kinesic.expressivity.trunk import Lean, hold_lean, limit_trunk, trunk_direction
from kinesic.expressivity.turns import (
    UPRIGHT,
    add_turns,
    clip_turn,
    exclusive,
    pass_layer,
    room,
    scale_turn,
)

BENT = 0.5  # amount of a lean that is part of a posture

_ARMS: Mapping[str, HandMode] = {"ARMS": "both", "LEFT_ARM": "left", "RIGHT_ARM": "right"}
_TRUNK = ("BODY", "TORSO", "SPINE", "TRUNK")
_WHOLE = "WHOLEBODY"
_FROM_GESTURES = {"open": "welcome"}  # poses of the arms that are the end of a gesture
_EASE = frozenset({"neutral", "idle", "stand", "rest", "hang", "side"})  # words for arms that hang

Arms = GestureForm | HandMode  # a rest form; a mode: these arms hang
_SIDES: Mapping[str, tuple[Side, ...]] = {"both": ("l", "r"), "left": ("l",), "right": ("r",)}


@dataclass(frozen=True, eq=False)
class Pose:
    """A posture: what trunk, head and arms do of it."""

    lean: Lean
    arms: tuple[Arms, ...] = ()
    head: Turn = UPRIGHT
    left_out: str = ""  # what the robot cannot do of it
    names_trunk: bool = False  # whether it says how the trunk is, be it upright


@dataclass(frozen=True, eq=False)
class _Part:
    """What one pose asks of the body."""

    lean: Turn = UPRIGHT
    arms: Arms | None = None
    head: Turn = UPRIGHT
    names_trunk: bool = False


def pose(posture: Posture, lexicon: Lexicon, robot: Robot) -> Pose | None:
    """Finds what this robot does of a posture: it leans and turns its head, and puts its arms in rest poses.

    Of a stance it does what its upper body has part in: who sits has the hands in the lap, who crouches bends forward,
    who stands lets them hang. A pose of the arms goes before.

    Returns:
        None when it can do nothing of what was asked.
    """
    parts, left_out = _parts(posture, lexicon, robot)
    arms = tuple(part.arms for part in parts if part.arms is not None)
    stance = (posture.stance or "").upper()
    if stance:
        stood = _stance(stance, lexicon, stays=posture.shift)
        if stood is None:
            left_out.append(f"no stance {posture.stance}, as the base is fixed")
        else:
            parts.append(replace(stood, arms=None))
            arms = arms or ((stood.arms,) if stood.arms is not None else ())
    if not parts:
        return None
    leaned, bowed = UPRIGHT, UPRIGHT
    for part in parts:
        leaned, bowed = add_turns(leaned, part.lean), add_turns(bowed, part.head)
    upright = any(part.names_trunk for part in parts) and bool(robot.joints("torso"))
    return Pose(limit_trunk(leaned, robot), arms, clip_turn(bowed, room(robot, "neck")), "; ".join(left_out), upright)


def _parts(posture: Posture, lexicon: Lexicon, robot: Robot) -> tuple[list[_Part], list[str]]:
    """Lists what the poses of a posture ask, and why some are left out; of two for one arm, the first counts."""
    parts: list[_Part] = []
    left_out: list[str] = []
    placed: dict[Side, str] = {}
    for name, lexeme in posture.poses:
        part = _part(name.upper(), lexeme, lexicon)
        sides: tuple[Side, ...] = () if part is None or part.arms is None else _sides(part.arms)
        before = next((placed[side] for side in sides if side in placed), None)
        if part is None:
            left_out.append(f"no pose {shorten_name(lexeme)} of {name}")
        elif before is not None:
            left_out.append(f"the pose {lexeme} of {name} is left out: the arms are in {before}")
        elif part.head != UPRIGHT and not robot.joints("neck"):
            left_out.append(f"no neck for the pose {lexeme} of {name}")
        else:
            parts.append(part)
            placed |= dict.fromkeys(sides, lexeme)
    return parts, left_out


def _sides(arms: Arms) -> tuple[Side, ...]:
    return tuple(sorted(arms.sides)) if isinstance(arms, GestureForm) else _SIDES[arms]


def _stance(stance: str, lexicon: Lexicon, *, stays: bool) -> _Part | None:
    match stance:
        case "STANDING":
            return _Part(arms="both" if stays else None)
        case "SITTING":
            return _Part(arms=_arms("lap", "both", lexicon))
        case "CROUCHING":
            return _Part(lean=scale_turn(trunk_direction(("forward",)) or UPRIGHT, BENT))
    return None


def _part(name: str, lexeme: str, lexicon: Lexicon) -> _Part | None:
    """Finds what one pose asks of trunk, arms or head; None when they can do nothing of it."""
    if name in _ARMS:
        arms = _arms(lexeme, _ARMS[name], lexicon)
        return None if arms is None else _Part(arms=arms)
    if name == "HEAD":
        held = read_head_name(lexeme)
        return _Part(head=scale_turn(direction(held.words), BENT)) if held and held.kind == "direction" else None
    if name == _WHOLE or name in _TRUNK:
        leaned = trunk_direction(read_trunk_name(lexeme))
        arms = None if name != _WHOLE or leaned not in (None, UPRIGHT) else _arms(lexeme, "both", lexicon)
        if leaned is not None or arms is not None:
            return _Part(lean=scale_turn(leaned or UPRIGHT, BENT), arms=arms, names_trunk=leaned is not None)
    return None


def _arms(lexeme: str, mode: HandMode, lexicon: Lexicon) -> Arms | None:
    """Finds the rest form of a pose of the arms, or the arms that hang; None when the lexicon knows none."""
    found = movement_words(lexeme)
    if _EASE & {*found}:
        return mode
    gesture = next((form for word, form in _FROM_GESTURES.items() if word in found), None)
    if gesture is not None and (match := lexicon.find(gesture, mode)) is not None and match.form.keys:
        return replace(match.form, keys=match.form.keys[-1:], rest=True)
    for name in (lexeme, f"arms {lexeme}"):  # the draft's CROSSED of ARMS
        match = lexicon.find(name, mode, category="rest")
        if match is not None and match.form.rest and match.form.keys:
            return match.form
    return None


def posture_moves(postures: Sequence[TimedBehaviour], context: BlockContext) -> Mapping[str, Move]:
    """Leans trunk and head and brings the arms into rest poses; of several postures the later wins from its start."""
    moves: dict[str, Move] = {}
    found: list[tuple[TimedBehaviour, Pose]] = []
    for timed in sorted(postures, key=lambda timed: timed.times["start"]):
        action = timed.behaviour.action
        if not isinstance(action, Posture):
            raise TypeError(f"{timed.behaviour.id} is a {type(action).__name__}, no posture")
        posed = pose(action, context.lexicon, context.robot)
        if posed is None:
            requested = [f"stance {action.stance}"] if action.stance else []
            names = ", ".join((*requested, *(f"{shorten_name(lexeme)} of {part}" for part, lexeme in action.poses)))
            known = "standing, sitting, leaning, and rest poses of the arms, are known"
            moves[timed.behaviour.id] = drop_behaviour(f"no pose {names}; {known}")
        elif posed.lean.clipped and posed.lean.turn == UPRIGHT and not posed.arms:
            moves[timed.behaviour.id] = drop_behaviour(f"the trunk cannot: {posed.lean.clipped}")
        else:
            found.append((timed, posed))
    trunks, heads = (
        exclusive(
            [
                hold_lean(turn, timed.times, chain=chain, stays=stays(timed.behaviour.action), pace=context.pace)
                for timed, turn in turns
            ]
        )
        for chain, turns in (
            ("torso", [(timed, posed.lean.turn) for timed, posed in found]),
            ("neck", [(timed, posed.head) for timed, posed in found]),
        )
    )
    for (timed, posed), trunk, head in zip(found, trunks, heads, strict=True):
        outcome, warnings = substitution_outcome(posed.left_out, posed.lean.clipped)
        bowed = pass_layer(head, context.manner(timed.behaviour, "head")) if context.robot.joints("neck") else ()
        leaned = pass_layer(trunk, context.manner(timed.behaviour, "torso"))
        moves[timed.behaviour.id] = Move(
            outcome,
            head=without_upright(bowed),
            torso=(leaned,) if posed.names_trunk and stays(timed.behaviour.action) else without_upright(leaned),
            strokes=tuple(stroke for arms in posed.arms for stroke in _arm_strokes(timed, arms, context)),
            warnings=warnings,
        )
    return moves


def _arm_strokes(timed: TimedBehaviour, arms: Arms, context: BlockContext) -> tuple[Stroke, ...]:
    """Brings the arms into a rest pose, and back unless the posture stays."""
    times, shift, manner = timed.times, stays(timed.behaviour.action), context.manner(timed.behaviour)
    work = poses(arms, context.robot, manner) if isinstance(arms, GestureForm) else hanging_arms(_SIDES[arms])
    there = times["end"] if shift else times["ready"]
    back = times["end"] if shift else times["relax"]
    taken = Stroke(timed.behaviour.id, _at_once(times["start"], there), (work,), rest=True)
    left = Stroke(timed.behaviour.id, _at_once(back, times["end"]), (hanging_arms(tuple(work.hands)),), rest=True)
    return (taken,) if shift else (taken, left)


def _at_once(start: float, arrive: float) -> dict[str, float]:
    """Sync points of work that is done when it arrives."""
    return {"start": start} | dict.fromkeys(("ready", "strokeStart", "stroke", "strokeEnd", "relax", "end"), arrive)
