"""Idle motion in pauses: the trunk shifts its weight, and the gaze wanders a little, both in time with breath.

Breath itself goes on through all that is done (`kinesic.planning.secondary`). What is here is motion like any other,
written as layers of torso and head: it adds to whatever they hold, and passes the same conditioning. It fills the
pauses in which no part moves, and begins and ends at nothing, so that it is over before anything else begins.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import radians

import numpy as np

from kinesic.body.robot import Robot
from kinesic.expressivity.gather import Sequences
from kinesic.expressivity.hands.poses import REST
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import UPRIGHT, Layer, TurnKey

Span = tuple[float, float]  # [s] from and to

IDLE_MARGIN = 0.3  # [s] between idle motion and what is asked for
LEAST_PAUSE = 2.4  # [s] that is worth a breath

BREATH = 4.0  # [s] of one; people breathe 12 to 18 times a minute
RISE = radians(1.0)  # that the trunk goes back with a breath at most
SWAY = radians(1.5)  # that the trunk leans and turns aside at most, for two breaths
GLANCE, GLANCES = radians(5.0), 0.4  # that the head turns away at most, and the share of breaths that bring it


@dataclass(frozen=True)
class Idling:
    """What a robot does when nothing is asked."""

    amount: float = 0.0  # 0 nothing .. 1 a little .. 2 twice as much
    seed: int = 0  # of what is left to chance; the same seed gives the same motion


OFF = Idling()


def add_idle_motion(sequences: Sequences, whole: Span, idling: Idling, robot: Robot) -> Sequences:
    """Adds idle motion to the parts of a block that the robot has.

    Args:
        sequences: what is asked of the parts.
        whole: [s] from the beginning of the block to its end.
        idling: how lively, and by which chance.
        robot: whose parts idle.
    """
    torso, head = idle(pauses(used_spans(sequences), whole), idling)
    return replace(
        sequences,
        torso=(*sequences.torso, torso) if torso and robot.joints("torso") else sequences.torso,
        head=(*sequences.head, head) if head and robot.joints("neck") else sequences.head,
    )


def idle(free: Iterable[Span], idling: Idling) -> tuple[Layer, Layer]:
    """Makes layers of torso and head that fill pauses.

    Args:
        free: [s] block time, in order, in which nothing is used.
        idling: how lively, and by which chance.

    Returns:
        Of the torso and of the head, both empty when there is nothing to fill. The head stays level while the trunk
        breathes.
    """
    if idling.amount == 0.0:
        return (), ()
    amount, chance = idling.amount, np.random.default_rng(idling.seed)
    torso: list[TurnKey] = []
    head: list[TurnKey] = []
    for begin, end in free:
        if end - begin - 2 * IDLE_MARGIN >= LEAST_PAUSE:
            times = _breaths((begin + IDLE_MARGIN, end - IDLE_MARGIN), chance)
            torso += [TurnKey(times[0], UPRIGHT), *_swaying(times, amount, chance), TurnKey(times[-1], UPRIGHT)]
            head += [TurnKey(times[0], UPRIGHT), *_wandering(times, amount, chance), TurnKey(times[-1], UPRIGHT)]
    return tuple(torso), tuple(head)


def used_spans(sequences: Sequences) -> tuple[Span, ...]:
    """Finds the spans in which a part moves, or a hand is away from its rest [s]; head and trunk may be anywhere."""
    turning = [
        (a.time, b.time)
        for layer in (*sequences.torso, *sequences.head)
        for a, b in pairwise(layer)
        if a.turn != b.turn
    ]
    reaching = [
        (a.time, b.time)
        for row in sequences.hands.values()
        for a, b in pairwise(row)
        if a.hand != REST or b.hand != REST
    ]
    return (*turning, *reaching)


def pauses(occupied: Iterable[Span], whole: Span) -> tuple[Span, ...]:
    """Finds what occupied spans leave of a whole.

    Args:
        occupied: [s] spans in which some part is used, in any order.
        whole: [s] from the beginning to the end.
    """
    found: list[Span] = []
    free = whole[0]
    for begin, end in sorted(occupied):
        if begin > free:
            found.append((free, min(begin, whole[1])))
        free = max(free, end)
    if free < whole[1]:
        found.append((free, whole[1]))
    return tuple(found)


def _breaths(span: Span, chance: np.random.Generator) -> list[float]:
    """Turning points of the breath [s], from the first to the last of a span, an even number of ways between them."""
    count = 2 * max(1, round((span[1] - span[0]) / BREATH))
    shares = 1.0 + 0.15 * chance.uniform(-1.0, 1.0, count)
    return [float(time) for time in span[0] + (span[1] - span[0]) * np.append(0.0, np.cumsum(shares)) / shares.sum()]


def _swaying(times: list[float], amount: float, chance: np.random.Generator) -> Iterator[TurnKey]:
    """At some breaths the weight shifts to a side."""
    weight = UPRIGHT
    for k, time in enumerate(times[1:-1], 1):
        if k % 4 == 1:
            aside, turned = amount * SWAY * chance.uniform(-1.0, 1.0, 2)
            weight = Turn(torsion=float(turned), roll=float(aside))
        yield TurnKey(time, weight)


def _wandering(times: list[float], amount: float, chance: np.random.Generator) -> Iterator[TurnKey]:
    """At some breaths the gaze goes elsewhere, and comes back with a later one."""
    glance = UPRIGHT
    for k, time in enumerate(times[1:-1], 1):
        if k % 2:
            away = float(chance.uniform()) < amount * GLANCES
            aside, down = chance.uniform(-1.0, 1.0, 2) * amount * GLANCE * away
            glance = Turn(torsion=float(aside), tilt=0.4 * float(down))
        yield TurnKey(time, glance)
