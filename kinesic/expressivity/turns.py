"""Rotations of head and torso in time: keys, layers that add up, and the range that holds them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from math import degrees

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.style import Expressivity, Phase, passage_of
from kinesic.motion.keys import PLAIN_PASSAGE, KeyPassage

AXES = ("torsion", "tilt", "roll")  # in the order of Turn; hinges of neck and torso are named after them
UPRIGHT = Turn()
MERGE = 0.02  # [s] keys nearer than this are one key


@dataclass(frozen=True)
class TurnKey:
    """A rotation at one time."""

    time: float  # [s] block time
    turn: Turn
    passage: KeyPassage = PLAIN_PASSAGE


Layer = tuple[TurnKey, ...]  # in time order; straight between its keys, constant outside them


@dataclass(frozen=True)
class Hold:
    """Going to a rotation and staying there: for a while, or for good."""

    start: float  # [s] leaves the present rotation
    arrive: float  # [s]
    turn: Turn
    leave: float | None = None  # [s]; None: it stays
    back: float | None = None  # [s]; None: it stays


def hold_turn(turn: Turn, times: Mapping[str, float], *, natural: float, stays: bool) -> Hold:
    """Times a hold by sync points: there at `ready` (or `end`, if there is no other), back from `relax` to `end`.

    Args:
        turn: where it goes.
        times: sync points [s].
        natural: time for the way where the sync points leave none [s].
        stays: whether it never goes back.
    """
    start = times["start"]
    arrive = arrival(start, times.get("ready", times["end"]), natural)
    if stays:
        return Hold(start, arrive, turn)
    leave = max(times["relax"], arrive)
    return Hold(start, arrive, turn, leave, arrival(leave, times["end"], natural))


def scale_turn(turn: Turn, factor: float) -> Turn:
    """Multiplies a rotation, axis by axis."""
    return Turn(turn.torsion * factor, turn.tilt * factor, turn.roll * factor)


def add_turns(a: Turn, b: Turn) -> Turn:
    """Adds two rotations, axis by axis."""
    return Turn(a.torsion + b.torsion, a.tilt + b.tilt, a.roll + b.roll)


def turn_angles(turn: Turn) -> tuple[float, float, float]:
    """Lists torsion, tilt and roll [rad], in the order of `AXES`."""
    return turn.torsion, turn.tilt, turn.roll


@lru_cache(maxsize=16)
def room(robot: Robot, chain: str) -> tuple[Turn, Turn]:
    """Finds the least and greatest rotation of a chain's hinges; zero where it has no hinge for an axis."""
    skeleton = robot.skeleton
    hinges = [skeleton.hinges[k] for k in robot.joints(chain)]
    lower = [sum(h.lower for h in hinges if h.name.endswith(axis)) for axis in AXES]
    upper = [sum(h.upper for h in hinges if h.name.endswith(axis)) for axis in AXES]
    return Turn(*lower), Turn(*upper)


def clip_turn(turn: Turn, within: tuple[Turn, Turn]) -> Turn:
    """Finds the nearest rotation inside a range."""
    least, most = within
    return Turn(
        *(min(max(v, a), b) for v, a, b in zip(turn_angles(turn), turn_angles(least), turn_angles(most), strict=True))
    )


def excess(turn: Turn, within: tuple[Turn, Turn]) -> float:
    """Measures how far a rotation lies outside a range, on its worst axis [deg]."""
    inside = clip_turn(turn, within)
    return degrees(max(abs(a - b) for a, b in zip(turn_angles(turn), turn_angles(inside), strict=True)))


def turn_at(layer: Layer, time: float) -> Turn:
    """Finds the rotation of a layer at a time."""
    return Turn(*(float(v) for v in total([layer], np.array([time]))[0]))


def total(layers: Iterable[Layer], times: Floats) -> Floats:
    """Adds layers at (m,) times [s]: (m, 3) torsion, tilt, roll [rad]."""
    turns = np.zeros((len(times), 3))
    for layer in layers:
        knots = [key.time for key in layer]
        values = np.array([turn_angles(key.turn) for key in layer])
        for axis in range(3):
            turns[:, axis] += np.interp(times, knots, values[:, axis])
    return turns


def bump(hold: Hold, base: Turn = UPRIGHT) -> Layer:
    """Makes the layer of one hold, relative to the rotation that it leaves."""
    change = add_turns(hold.turn, scale_turn(base, -1.0))
    keys = [TurnKey(hold.start, UPRIGHT), TurnKey(hold.arrive, change)]
    if hold.leave is not None and hold.back is not None:
        if hold.leave > hold.arrive:
            keys.append(TurnKey(hold.leave, change))
        keys.append(TurnKey(hold.back, UPRIGHT))
    return tuple(keys)


def exclusive(holds: Sequence[Hold]) -> tuple[Layer, ...]:
    """Makes layers of holds of which only one is in force: the later wins from its start.

    A hold that stays becomes the rotation that later ones return to.

    Args:
        holds: in the order of their starts.

    Returns:
        One layer for each hold; their sum is the motion.
    """
    layers: list[Layer] = []
    base = UPRIGHT
    for k, hold in enumerate(holds):
        layer = bump(hold, base)
        if hold.leave is None:
            base = hold.turn
        elif k + 1 < len(holds) and holds[k + 1].start < hold.leave:
            layer = _give_way(layer, holds[k + 1])
        layers.append(layer)
    return tuple(layers)


def _give_way(layer: Layer, other: Hold) -> Layer:
    """Lets a layer go back to zero while another hold goes to its own rotation."""
    before = tuple(key for key in layer if key.time < other.start)
    return (*before, TurnKey(other.start, turn_at(layer, other.start)), TurnKey(other.arrive, UPRIGHT))


def pass_layer(layer: Layer, manner: Expressivity) -> Layer:
    """Sets how a layer's keys are passed: in a manner, as a stroke there, a hold, and a retraction to upright."""
    keys = [replace(key, passage=passage_of(manner, "retraction")) for key in layer[:1]]
    for before, key in pairwise(layer):
        phase: Phase = "hold" if key.turn == before.turn else "retraction" if key.turn == UPRIGHT else "stroke"
        keys.append(replace(key, passage=passage_of(manner, phase)))
    return tuple(keys)


def departure_time(desired: float, arrival: float, natural: float) -> float:
    """Finds when to leave [s]: as desired, or early enough when no time was given for the way."""
    return desired if arrival - desired >= MERGE else arrival - natural


def arrival(leave: float, desired: float, natural: float) -> float:
    """Finds when to be back [s]: as desired, or late enough when no time was given for the way."""
    return desired if desired - leave >= MERGE else leave + natural
