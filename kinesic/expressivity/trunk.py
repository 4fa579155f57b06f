"""Trunk leans and rotations, alone and in gestures (thesis 8.7).

Power rotates the trunk at each stroke key by the movement of the hands since the preceding key (equation 8.7.1, in the
proportions of Greta's `ExpressiveTorso`): forward where they go down, to the side where they go aside. Openness
reclines it a little. The gesture space moves with the trunk, so that the postures of the arms do not change.
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
    MIN_KEY_SPACING,
    UPRIGHT_TURN,
    Hold,
    Layer,
    TurnKey,
    add_turns,
    clip_turn,
    hold_turn,
    range_excess,
    rotation_range,
    scale_turn,
)

MIN_LEAN_TIME = 0.3  # [s] shortest duration of the movement to a lean
LEAN_ANGLE = radians(24)  # [rad] lean about each named axis at amount 1; the default amount is 0.5
SWAY_ANGLE = 0.3  # [rad] limit of the trunk rotation for very large hand movements at power 1
RECLINE_ANGLE = radians(5)  # [rad] backward lean of the trunk at openness 1
MAX_TIME_FRACTION = 0.7  # largest fraction of a key interval that a trunk rotation may need
STILL_DISTANCE = 0.02  # [arm lengths] hand movement up to which the trunk keeps its rotation


@dataclass(frozen=True)
class Lean:
    """Trunk rotation, clipped to its range."""

    turn: Turn
    clipped: str = ""  # rotation lost to the range


def named_lean(torso: Torso, robot: Robot, spatial: float) -> Lean | None:
    """Return the trunk rotation for a lexeme such as LEAN_FORWARD.

    Its words are lean, recline, forward, back, left, right, turn and neutral.

    Returns:
        None when no word means a movement of the trunk.
    """
    words = read_trunk_name(torso.lexeme)
    turn = trunk_direction(words)
    return (
        None
        if turn is None
        else limit_trunk(scale_turn(turn, torso.amount * amplitude_factor(words) * (1 + 0.5 * spatial)), robot)
    )


def hold_lean(turn: Turn, times: Mapping[str, float], *, chain: str, stays: bool, pace: Pace) -> Hold:
    """Create a trunk or neck lean that is reached, held and released."""
    natural = max(MIN_LEAN_TIME, pace.turn_time(chain, turn))
    return hold_turn(turn, times, natural=natural, stays=stays)


def trunk_direction(lexeme_words: tuple[str, ...]) -> Turn | None:
    """Return the trunk rotation for direction words at amount 1, or None."""
    words_named = frozenset(lexeme_words)
    turning = "turn" in words_named
    tilt = LEAN_ANGLE * (
        bool(words_named & {"forward", "down", "front"}) - bool(words_named & {"recline", "back", "up"})
    )
    side = LEAN_ANGLE * (("left" in words_named) - ("right" in words_named))
    if side or tilt:
        return Turn(torsion=side if turning else 0.0, tilt=tilt, roll=0.0 if turning else -side)
    if words_named & {"lean", "incline", "bow", "tilt"}:
        return Turn(tilt=LEAN_ANGLE)
    if turning:
        return Turn(torsion=LEAN_ANGLE)
    return UPRIGHT_TURN if words_named & {"neutral", "nothing", "upright"} else None


def limit_trunk(turn: Turn, robot: Robot) -> Lean:
    """Clip a rotation to the range of the trunk."""
    trunk_range = rotation_range(robot, "torso")
    lost_angle = range_excess(turn, trunk_range)
    return Lean(
        clip_turn(turn, trunk_range),
        f"{lost_angle:.1f} deg beyond the torso's range are left out" if lost_angle > 0.05 else "",
    )


def turn_trunk_along(work: HandStroke, manner: Expressivity, pace: Pace) -> Layer:
    """Return the torso layer that follows the hands of one gesture.

    The layer begins and ends upright. Each step fits the time between the hand keys, so that no stroke waits for
    the trunk.

    Args:
        work: stroke of the hands.
        manner: expressivity of the torso; power and openness are used.
        pace: of the robot.

    Returns:
        Empty without power and openness, for a rest pose, or for a robot without a torso.
    """
    power, openness = max(0.0, manner.power), manner.openness
    if work.stroke.rest or not pace.robot.joints("torso") or power == openness == 0.0:
        return ()
    rest, times = resting_hands(pace.robot), work.stroke.times
    keys = [TurnKey(times["start"], UPRIGHT_TURN)]
    sway_turn, recline = UPRIGHT_TURN, Turn(tilt=-RECLINE_ANGLE * openness)
    for displacement, time in zip(
        _hand_displacements(work.poses, rest, pace.robot.arm_length), work.moments, strict=True
    ):
        if float(np.linalg.norm(displacement)) > STILL_DISTANCE:
            sway_turn = _sway(displacement, power)
        if time - keys[-1].time >= MIN_KEY_SPACING:
            before, desired = keys[-1], add_turns(sway_turn, recline)
            turn = pace.manageable_turn("torso", before.turn, desired, time - before.time, MAX_TIME_FRACTION)
            keys.append(TurnKey(time, turn))
    return (*keys, *_return_keys(keys[-1], times, pace))


def _hand_displacements(work: Poses, rest: Mapping[Side, Reach], unit: float) -> list[Floats]:
    """Return displacements (3,) of the hands' midpoint between keys [arm lengths].

    The first one starts at rest.
    """
    middles = [np.mean([rest[side].position for side in work.hands], axis=0)]
    for k in range(work.count):
        middles.append(
            np.mean([(row[k].reach or rest[side]).position for side, row in work.hands.items()], axis=0),
        )
    return [(after - before) / unit for before, after in pairwise(middles)]


def _sway(displacement: Floats, power: float) -> Turn:
    """Return the trunk rotation for a hand displacement (thesis equation 8.7.1).

    Its axes are x forward, y left, z up [arm lengths].
    """
    gain = SWAY_ANGLE * power / (float(np.linalg.norm(displacement)) + 1.0)
    return Turn(torsion=gain * float(displacement[1]), tilt=-gain * float(displacement[2]))


def _return_keys(key: TurnKey, times: Mapping[str, float], pace: Pace) -> tuple[TurnKey, ...]:
    """Return trunk keys that hold until `relax` and then return upright."""
    leave = max(times["relax"], key.time)
    hold = (TurnKey(leave, key.turn),) if leave - key.time >= MIN_KEY_SPACING else ()
    minimum = pace.least_turn_time("torso", key.turn) / MAX_TIME_FRACTION
    return (*hold, TurnKey(max(times["end"], leave + max(minimum, MIN_KEY_SPACING)), UPRIGHT_TURN))
