"""Leans and turns of the trunk, and its part in a gesture: it opens, and goes along with the hands (thesis 8.7).

Power turns the trunk at each stroke key by what the hands have moved since the key before (equation 8.7.1, in the
proportions of Greta's `ExpressiveTorso`): forward where they go down, to the side where they go aside. Openness draws
it back a little. The gesture's box goes along, so that the arms' postures stay what they are.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import radians

import numpy as np

from kinesic.bml.block import Torso
from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.hands.poses import Poses, resting_hands
from kinesic.expressivity.hands.strokes import HandStroke
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.movement_words import amplitude_factor, read_trunk_name
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import Expressivity
from kinesic.expressivity.turns import (
    MERGE,
    UPRIGHT,
    Hold,
    Layer,
    TurnKey,
    add_turns,
    clip_turn,
    excess,
    hold_turn,
    room,
    scale_turn,
)

LEAST_HOLD = 0.3  # [s] for the way to a lean
LEAN = radians(24)  # of amount 1, on each axis that a lexeme names: 12 deg at the default amount of 0.5
SWAY = 0.3  # [rad] of power 1, for hands that go very far
RECLINE = radians(5)  # of openness 1
HASTE = 0.7  # share of the time from key to key that the trunk may need
STILL_HAND = 0.02  # arm lengths: hands that move less hold still, and the trunk with them


@dataclass(frozen=True)
class Lean:
    """A rotation of the trunk, inside its range."""

    turn: Turn
    clipped: str = ""  # what the range took away


def named_lean(torso: Torso, robot: Robot, spatial: float) -> Lean | None:
    """Finds the rotation that the words of a lexeme name: lean, recline, forward, back, left, right, turn, neutral.

    Returns:
        None when no word means a movement of the trunk.
    """
    found = read_trunk_name(torso.lexeme)
    turn = trunk_direction(found)
    return (
        None
        if turn is None
        else limit_trunk(scale_turn(turn, torso.amount * amplitude_factor(found) * (1 + 0.5 * spatial)), robot)
    )


def hold_lean(turn: Turn, times: Mapping[str, float], *, chain: str, stays: bool, pace: Pace) -> Hold:
    """Times a lean of the torso or the neck: it goes there and, unless it stays, back."""
    natural = max(LEAST_HOLD, pace.turn_time(chain, turn))
    return hold_turn(turn, times, natural=natural, stays=stays)


def trunk_direction(lexeme_words: tuple[str, ...]) -> Turn | None:
    """Finds the rotation of amount 1 that words name; None when they name none."""
    named = frozenset(lexeme_words)
    turning = "turn" in named
    tilt = LEAN * (bool(named & {"forward", "down", "front"}) - bool(named & {"recline", "back", "up"}))
    side = LEAN * (("left" in named) - ("right" in named))
    if side or tilt:
        return Turn(torsion=side if turning else 0.0, tilt=tilt, roll=0.0 if turning else -side)
    if named & {"lean", "incline", "bow", "tilt"}:
        return Turn(tilt=LEAN)
    if turning:
        return Turn(torsion=LEAN)
    return UPRIGHT if named & {"neutral", "nothing", "upright"} else None


def limit_trunk(turn: Turn, robot: Robot) -> Lean:
    """Keeps a rotation inside the range of the trunk."""
    within = room(robot, "torso")
    lost = excess(turn, within)
    return Lean(clip_turn(turn, within), f"{lost:.1f} deg beyond the torso's range are left out" if lost > 0.05 else "")


def turn_trunk_along(work: HandStroke, manner: Expressivity, pace: Pace) -> Layer:
    """Turns the trunk along with one gesture, from upright to upright.

    No step asks more of the trunk than it does in the time that the hands have, so that no stroke waits for it.

    Args:
        work: what the hands do, and when.
        manner: of the torso; power and openness are used.
        pace: of the robot.

    Returns:
        Empty when neither power nor openness asks for anything, when the gesture is a rest pose, or when the robot
        has no torso.
    """
    power, openness = max(0.0, manner.power), manner.openness
    if work.stroke.rest or not pace.robot.joints("torso") or power == openness == 0.0:
        return ()
    rest, times = resting_hands(pace.robot), work.stroke.times
    keys = [TurnKey(times["start"], UPRIGHT)]
    swayed, recline = UPRIGHT, Turn(tilt=-RECLINE * openness)
    for way, moment in zip(_ways(work.poses, rest, pace.robot.arm_length), work.moments, strict=True):
        if float(np.linalg.norm(way)) > STILL_HAND:
            swayed = _sway(way, power)
        if moment - keys[-1].time >= MERGE:
            before, desired = keys[-1], add_turns(swayed, recline)
            turn = pace.manageable_turn("torso", before.turn, desired, moment - before.time, HASTE)
            keys.append(TurnKey(moment, turn))
    return (*keys, *_return(keys[-1], times, pace))


def _ways(work: Poses, rest: Mapping[Side, Reach], unit: float) -> list[Floats]:
    """(3,) how far the middle of the hands has gone from key to key, at first from rest [arm lengths]."""
    middles = [np.mean([rest[side].position for side in work.hands], axis=0)]
    for k in range(work.count):
        middles.append(
            np.mean([(row[k].reach or rest[side]).position for side, row in work.hands.items()], axis=0),
        )
    return [(after - before) / unit for before, after in pairwise(middles)]


def _sway(way: Floats, power: float) -> Turn:
    """Equation 8.7.1 for a way of the hands, x forward, y left, z up [arm lengths]."""
    gain = SWAY * power / (float(np.linalg.norm(way)) + 1.0)
    return Turn(torsion=gain * float(way[1]), tilt=-gain * float(way[2]))


def _return(key: TurnKey, times: Mapping[str, float], pace: Pace) -> tuple[TurnKey, ...]:
    """Stays until the hands relax, then goes upright again."""
    leave = max(times["relax"], key.time)
    hold = (TurnKey(leave, key.turn),) if leave - key.time >= MERGE else ()
    least = pace.least_turn_time("torso", key.turn) / HASTE
    return (*hold, TurnKey(max(times["end"], leave + max(least, MERGE)), UPRIGHT))
