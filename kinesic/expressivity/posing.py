"""Postures in time: trunk, head and arms go into them together, and come back unless they stay."""

from collections.abc import Mapping, Sequence

from kinesic.bml.block import Posture, Timed
from kinesic.body.robot import Side
from kinesic.expressivity.behaviours import Move, Scene, dropped, hanging, moving, stays, substituted
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.hands.strokes import Stroke
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.posture import Arms, Pose, pose
from kinesic.expressivity.torso import LEAST_HOLD
from kinesic.expressivity.turns import UPRIGHT, Hold, exclusive, held, passed

_SIDES: Mapping[str, tuple[Side, ...]] = {"both": ("l", "r"), "left": ("l",), "right": ("r",)}


def posture_moves(postures: Sequence[Timed], scene: Scene) -> Mapping[str, Move]:
    """Postures, of which the later wins from its start: trunk and head lean, the arms take rest poses."""
    moves: dict[str, Move] = {}
    found: list[tuple[Timed, Pose]] = []
    for timed in sorted(postures, key=lambda timed: timed.times["start"]):
        action = timed.behaviour.action
        if not isinstance(action, Posture):
            raise TypeError(f"{timed.behaviour.id} is a {type(action).__name__}, no posture")
        posed = pose(action, scene.lexicon, scene.robot)
        if posed is None:
            asked = [f"stance {action.stance}"] if action.stance else []
            names = ", ".join((*asked, *(f"{lexeme} of {part}" for part, lexeme in action.poses)))
            known = "standing, sitting, leaning, and rest poses of the arms, are known"
            moves[timed.behaviour.id] = dropped(f"no pose {names}; {known}")
        elif posed.lean.clipped and posed.lean.turn == UPRIGHT and not posed.arms:
            moves[timed.behaviour.id] = dropped(f"the trunk cannot: {posed.lean.clipped}")
        else:
            found.append((timed, posed))
    trunks, heads = (
        exclusive([_posture_hold(timed, turn, part, scene) for timed, turn in turns])
        for part, turns in (
            ("torso", [(timed, posed.lean.turn) for timed, posed in found]),
            ("neck", [(timed, posed.head) for timed, posed in found]),
        )
    )
    for (timed, posed), trunk, head in zip(found, trunks, heads, strict=True):
        outcome, warnings = substituted(posed.left_out, posed.lean.clipped)
        moves[timed.behaviour.id] = Move(
            outcome,
            head=moving(passed(head, scene.manner(timed, "head"))) if scene.robot.joints("neck") else (),
            torso=moving(passed(trunk, scene.manner(timed, "torso"))),
            strokes=tuple(stroke for arms in posed.arms for stroke in _posed(timed, arms, scene)),
            warnings=warnings,
        )
    return moves


def _posture_hold(timed: Timed, turn: Turn, chain: str, scene: Scene) -> Hold:
    """When a part goes into a posture and, unless it stays, back."""
    natural = max(LEAST_HOLD, scene.pace.turn_time(chain, turn))
    return held(turn, timed.times, natural=natural, stays=stays(timed.behaviour.action))


def _posed(timed: Timed, arms: Arms, scene: Scene) -> tuple[Stroke, ...]:
    """Work that brings the arms into a rest pose, and back unless the posture stays."""
    times, shift = timed.times, stays(timed.behaviour.action)
    work = poses(arms, scene.robot, scene.manner(timed)) if isinstance(arms, GestureForm) else hanging(_SIDES[arms])
    there = times["end"] if shift else times["ready"]
    back = times["end"] if shift else times["relax"]
    taken = Stroke(timed.behaviour.id, _at_once(times["start"], there), (work,), rest=True)
    left = Stroke(timed.behaviour.id, _at_once(back, times["end"]), (hanging(tuple(work.hands)),), rest=True)
    return (taken,) if shift else (taken, left)


def _at_once(start: float, arrive: float) -> dict[str, float]:
    """Sync points of work that is done when it arrives."""
    return {"start": start} | dict.fromkeys(("ready", "strokeStart", "stroke", "strokeEnd", "relax", "end"), arrive)
