"""Leans and turns of the trunk."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians

from kinesic.bml.block import Torso
from kinesic.body.robot import Robot
from kinesic.expressivity.head import named, size, words
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import UPRIGHT, Hold, clipped, excess, held, room, scaled

LEAST_HOLD = 0.3  # [s] for the way to a lean
LEAN = radians(24)  # of amount 1, on each axis that a lexeme names: 12 deg at the default amount of 0.5


@dataclass(frozen=True)
class Lean:
    """A rotation of the trunk, inside its range."""

    turn: Turn
    clipped: str = ""  # what the range took away


def lean(torso: Torso, robot: Robot, spatial: float) -> Lean | None:
    """The rotation that the words of a lexeme name: lean, recline, forward, back, left, right, turn, neutral.

    Returns:
        None when no word means a movement of the trunk.
    """
    found = words(torso.lexeme)
    turn = trunk_direction(found)
    return None if turn is None else limited(scaled(turn, torso.amount * size(found) * (1 + 0.5 * spatial)), robot)


def hold(turn: Turn, times: Mapping[str, float], *, stays: bool, pace: Pace) -> Hold:
    """When the trunk goes there and, unless it stays, back."""
    natural = max(LEAST_HOLD, pace.turn_time("torso", turn))
    return held(turn, times, natural=natural, stays=stays)


def trunk_direction(found: tuple[str, ...]) -> Turn | None:
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


def limited(turn: Turn, robot: Robot) -> Lean:
    """A rotation inside the range of the trunk."""
    within = room(robot, "torso")
    lost = excess(turn, within)
    return Lean(clipped(turn, within), f"{lost:.1f} deg beyond the torso's range are left out" if lost > 0.05 else "")
