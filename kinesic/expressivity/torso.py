"""Leans, turns and postures of the trunk."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians

from kinesic.bml.block import Mode, Posture, Torso
from kinesic.body.robot import Robot
from kinesic.expressivity.form import GestureForm
from kinesic.expressivity.head import named, size, words
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon import Lexicon
from kinesic.expressivity.pace import Pace
from kinesic.expressivity.turns import UPRIGHT, Hold, clipped, excess, held, plus, room, scaled

LEAN = radians(24)  # of amount 1, on each axis that a lexeme names: 12 deg at the default amount of 0.5

_ARMS: Mapping[str, Mode] = {"ARMS": "both", "LEFT_ARM": "left", "RIGHT_ARM": "right"}
_TRUNK = ("WHOLEBODY", "BODY", "TORSO", "SPINE", "TRUNK")


@dataclass(frozen=True)
class Lean:
    """A rotation of the trunk, inside its range."""

    turn: Turn
    clipped: str = ""  # what the range took away


@dataclass(frozen=True, eq=False)
class Pose:
    """A posture: what the trunk and the arms do of it."""

    lean: Lean
    arms: tuple[GestureForm | Mode, ...] = ()  # rest forms; a mode: these arms hang
    left_out: str = ""  # what the robot cannot do of it


def lean(torso: Torso, robot: Robot, spatial: float) -> Lean | None:
    """The rotation that the words of a lexeme name: lean, recline, forward, back, left, right, turn, neutral.

    Returns:
        None when no word means a movement of the trunk.
    """
    found = words(torso.lexeme)
    turn = _direction(found)
    return None if turn is None else _limited(scaled(turn, torso.amount * size(found) * (1 + 0.5 * spatial)), robot)


def pose(posture: Posture, lexicon: Lexicon, robot: Robot) -> Pose | None:
    """What this robot does of a posture: it always stands, leans as asked, and puts its arms in rest poses.

    Returns:
        None when it can do nothing of what was asked.
    """
    turn, left_out = UPRIGHT, []
    arms: list[GestureForm | Mode] = []
    for part, lexeme in posture.poses:
        form = _arms(lexeme, _ARMS[part.upper()], lexicon) if part.upper() in _ARMS else None
        moved = _direction(words(lexeme)) if part.upper() in _TRUNK else None
        if form is not None:
            arms.append(form)
        elif moved is not None:
            turn = plus(turn, scaled(moved, 0.5))
        else:
            left_out.append(f"no pose {lexeme} of {part}")
    if posture.stance is None and posture.poses and len(left_out) == len(posture.poses):
        return None
    if posture.stance is not None and posture.stance.upper() != "STANDING":
        left_out.append(f"no stance {posture.stance}, as the base is fixed")
    return Pose(_limited(turn, robot), tuple(arms), "; ".join(left_out))


def hold(turn: Turn, times: Mapping[str, float], *, stays: bool, pace: Pace) -> Hold:
    """When the trunk goes there and, unless it stays, back."""
    natural = max(0.3, pace.turn_time("torso", turn))
    return held(turn, times, natural=natural, stays=stays)


def _direction(found: tuple[str, ...]) -> Turn | None:
    """The rotation of amount 1 that words name; None when they name none."""
    turning = named(found, "turn", "twist", "look", "rotat")
    tilt = LEAN * (named(found, "forward", "down", "front") - named(found, "recline", "back", "up"))
    side = LEAN * (named(found, "left") - named(found, "right"))
    if side or tilt:
        return Turn(torsion=side if turning else 0.0, tilt=tilt, roll=0.0 if turning else -side)
    if named(found, "lean", "inclin", "bow", "tilt"):
        return Turn(tilt=LEAN)
    if turning:
        return Turn(torsion=LEAN)
    return UPRIGHT if named(found, "neutral", "nothing", "upright") else None


def _limited(turn: Turn, robot: Robot) -> Lean:
    within = room(robot, "torso")
    lost = excess(turn, within)
    return Lean(clipped(turn, within), f"{lost:.1f} deg beyond the torso's range are left out" if lost > 0.05 else "")


def _arms(lexeme: str, mode: Mode, lexicon: Lexicon) -> GestureForm | Mode | None:
    """The rest form of a pose of the arms, or the arms that hang; None when the lexicon knows none."""
    if named(words(lexeme), "neutral"):
        return mode
    match = lexicon.find(lexeme, mode, category="rest")
    if match is not None and match.substitute:
        telling = "_".join(word for word in words(lexeme) if not word.startswith("arm"))
        match = lexicon.find(telling, mode, category="rest") if telling else None
    return match.form if match is not None and match.form.rest and match.form.keys else None
