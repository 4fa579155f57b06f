"""Rotations of head and torso over time: keys, layers and ranges."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from math import degrees

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.passage import Phase, passage_of
from kinesic.expressivity.style.style import Expressivity
from kinesic.motion.keys import PLAIN_PASSAGE, KeyPassage

TURN_AXES = ("torsion", "tilt", "roll")  # rotation axes in the order of Turn; suffixes of neck and torso joint names
UPRIGHT_TURN = Turn()  # rotation of zero
MIN_KEY_SPACING = 0.02  # [s] shortest interval between keys; a closer key is left out or shifted


@dataclass(frozen=True)
class TurnKey:
    """Key of a head or torso rotation: time, rotation and spline parameters."""

    time: float  # [s] block time
    turn: Turn
    passage: KeyPassage = PLAIN_PASSAGE


Layer = tuple[TurnKey, ...]  # in time order; monotone cubics between its keys, constant outside them


@dataclass(frozen=True)
class Hold:
    """Movement to a rotation that is held temporarily or permanently."""

    start: float  # [s] departure from the current rotation
    arrive: float  # [s] arrival at the held rotation
    turn: Turn
    leave: float | None = None  # [s] begin of the return; None: the rotation stays
    back: float | None = None  # [s] end of the return; None: the rotation stays


def hold_turn(turn: Turn, times: Mapping[str, float], *, natural: float, stays: bool) -> Hold:
    """Create a held rotation from its sync points.

    It arrives at `ready` (or at `end` without it), and returns from `relax` to `end`.

    Args:
        turn: rotation to hold.
        times: sync points [s].
        natural: duration of the movement where the sync points leave no time [s].
        stays: whether it never returns.
    """
    start = times["start"]
    arrive = arrival_time(start, times.get("ready", times["end"]), natural)
    if stays:
        return Hold(start, arrive, turn)
    leave = max(times["relax"], arrive)
    return Hold(start, arrive, turn, leave, arrival_time(leave, times["end"], natural))


def scale_turn(turn: Turn, factor: float) -> Turn:
    """Multiply a rotation by a factor, axis by axis."""
    return Turn(turn.torsion * factor, turn.tilt * factor, turn.roll * factor)


def add_turns(a: Turn, b: Turn) -> Turn:
    """Add two rotations, axis by axis."""
    return Turn(a.torsion + b.torsion, a.tilt + b.tilt, a.roll + b.roll)


def turn_angles(turn: Turn) -> tuple[float, float, float]:
    """Return torsion, tilt and roll [rad], in the order of `TURN_AXES`."""
    return turn.torsion, turn.tilt, turn.roll


@lru_cache(maxsize=16)
def rotation_range(robot: Robot, chain: str) -> tuple[Turn, Turn]:
    """Return the smallest and largest rotation of a kinematic chain.

    Axes without a joint have the range zero.
    """
    skeleton = robot.skeleton
    hinges = [skeleton.hinges[k] for k in robot.joints(chain)]
    lower = [sum(h.lower for h in hinges if h.name.endswith(axis)) for axis in TURN_AXES]
    upper = [sum(h.upper for h in hinges if h.name.endswith(axis)) for axis in TURN_AXES]
    return Turn(*lower), Turn(*upper)


@lru_cache(maxsize=16)
def rest_turn(robot: Robot, chain: str) -> Turn:
    """Return the rotation of a kinematic chain in the robot's rest posture."""
    hinges = [robot.skeleton.hinges[k] for k in robot.joints(chain)]
    return Turn(*(sum(h.rest for h in hinges if h.name.endswith(axis)) for axis in TURN_AXES))


@lru_cache(maxsize=16)
def rest_head_turn(robot: Robot) -> Turn:
    """Return the rotation of the resting head in the world."""
    return add_turns(rest_turn(robot, "torso"), rest_turn(robot, "neck"))


def clip_turn(turn: Turn, limits: tuple[Turn, Turn]) -> Turn:
    """Clip a rotation to a range, axis by axis."""
    lower, upper = limits
    return Turn(
        *(min(max(v, a), b) for v, a, b in zip(turn_angles(turn), turn_angles(lower), turn_angles(upper), strict=True))
    )


def range_excess(turn: Turn, limits: tuple[Turn, Turn]) -> float:
    """Return the excess of a rotation over a range [deg].

    It is that of the worst axis.
    """
    inside = clip_turn(turn, limits)
    return degrees(max(abs(a - b) for a, b in zip(turn_angles(turn), turn_angles(inside), strict=True)))


def turn_at(layer: Layer, time: float) -> Turn:
    """Return a layer's rotation at a block time [s]."""
    return Turn(*(float(v) for v in sum_layers([layer], np.array([time]))[0]))


def sum_layers(layers: Iterable[Layer], times: Floats) -> Floats:
    """Return the sum of layers at (m,) times [s].

    Returns:
        (m, 3) torsion, tilt, roll [rad].
    """
    turns = np.zeros((len(times), 3))
    for layer in layers:
        knots = np.array([key.time for key in layer])
        values = np.array([turn_angles(key.turn) for key in layer])
        inside = np.clip(times, knots[0], knots[-1])
        turns += _interpolate(knots, values, inside)
    return turns


def _interpolate(knots: Floats, values: Floats, times: Floats) -> Floats:
    """Interpolate rotations (k, 3) by monotone cubics at times (m,).

    The velocity is zero at both ends and where a value turns back, as in the motion itself (Fritsch and Butland, 1984).
    """
    gaps = np.diff(knots)[:, None]
    chords = np.diff(values, axis=0) / gaps
    before, after = chords[:-1], chords[1:]
    is_passed = before * after > 0.0
    harmonic = (gaps[:-1] + 2.0 * gaps[1:]) * after + (2.0 * gaps[:-1] + gaps[1:]) * before
    slopes = np.zeros_like(values)
    np.divide(3.0 * (gaps[:-1] + gaps[1:]) * before * after, harmonic, out=slopes[1:-1], where=is_passed)
    k = np.searchsorted(knots, times, side="right") - 1
    following = np.minimum(k + 1, len(knots) - 1)
    gap = np.vstack([gaps, [[1.0]]])[k]
    part = (times - knots[k])[:, None] / gap
    rest = 1.0 - part
    rise = (values[following] - values[k]) * (3.0 - 2.0 * part) * part**2
    return np.asarray(values[k] + rise + gap * part * rest * (slopes[k] * rest - slopes[following] * part))


def hold_layer(hold: Hold, base: Turn = UPRIGHT_TURN) -> Layer:
    """Convert one held rotation to a layer relative to a base rotation."""
    change = add_turns(hold.turn, scale_turn(base, -1.0))
    keys = [TurnKey(hold.start, UPRIGHT_TURN), TurnKey(hold.arrive, change)]
    if hold.leave is not None and hold.back is not None:
        if hold.leave > hold.arrive:
            keys.append(TurnKey(hold.leave, change))
        keys.append(TurnKey(hold.back, UPRIGHT_TURN))
    return tuple(keys)


def layers_of_holds(holds: Sequence[Hold]) -> tuple[Layer, ...]:
    """Convert holds to layers, with priority of later holds.

    A hold that stays becomes the rotation to which later ones return.

    Args:
        holds: in the order of their starts.

    Returns:
        One layer for each hold; their sum is the motion.
    """
    layers: list[Layer] = []
    base = UPRIGHT_TURN
    for k, hold in enumerate(holds):
        layer = hold_layer(hold, base)
        if hold.leave is None:
            base = hold.turn
        elif k + 1 < len(holds) and holds[k + 1].start < hold.leave:
            layer = _yield_to(layer, holds[k + 1])
        layers.append(layer)
    return tuple(layers)


def _yield_to(layer: Layer, other: Hold) -> Layer:
    """Fade a rotation layer to zero while a later hold begins."""
    before = tuple(key for key in layer if key.time < other.start)
    return (*before, TurnKey(other.start, turn_at(layer, other.start)), TurnKey(other.arrive, UPRIGHT_TURN))


def set_passages(layer: Layer, manner: Expressivity) -> Layer:
    """Set the spline parameters of a layer's keys from expressivity.

    Movements away from upright are strokes, constant spans are holds, and movements to upright are retractions.
    """
    keys = [replace(key, passage=passage_of(manner, "retraction")) for key in layer[:1]]
    for before, key in pairwise(layer):
        phase: Phase = "hold" if key.turn == before.turn else "retraction" if key.turn == UPRIGHT_TURN else "stroke"
        keys.append(replace(key, passage=passage_of(manner, phase)))
    return tuple(keys)


def departure_time(desired: float, arrival: float, natural: float) -> float:
    """Return the desired departure time, or an earlier feasible time [s]."""
    return desired if arrival - desired >= MIN_KEY_SPACING else arrival - natural


def arrival_time(leave: float, desired: float, natural: float) -> float:
    """Return the desired arrival time, or a later feasible time [s]."""
    return desired if desired - leave >= MIN_KEY_SPACING else leave + natural
