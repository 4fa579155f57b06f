"""Idle motion in pauses: weight shifts and glances.

Breath itself continues through all behaviours (`kinesic.planning.secondary`). This module writes layers of torso and
head: they are added to the held rotations, and conditioned like other motion. They fill the pauses in which no part
moves, and begin and end at zero, so that they are over before another behaviour begins.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import radians

import numpy as np

from kinesic.body.robot import Robot
from kinesic.expressivity.gather import Sequences
from kinesic.expressivity.hands.poses import REST_HAND
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import UPRIGHT_TURN, Layer, TurnKey

Span = tuple[float, float]  # [s] begin and end

IDLE_MARGIN = 0.3  # [s] smallest pause between idle and requested motion

MIN_PAUSE = 2.4  # [s] shortest idle or breathing motion; a pause also needs `IDLE_MARGIN` at both ends
BREATH_PERIOD = 4.0  # [s] duration of one breath; people breathe 12 to 18 times a minute

RISE_ANGLE = radians(1.0)  # [rad] largest backward rotation of the trunk with a breath
SWAY_ANGLE = radians(1.5)  # [rad] largest roll and torsion of the trunk in a weight shift, which lasts two breaths
GLANCE_ANGLE = radians(5.0)  # [rad] largest head rotation of a glance
GLANCE_PROBABILITY = 0.4  # probability of a glance per breath at amount 1


@dataclass(frozen=True)
class Idling:
    """Amount of idle motion, with its random seed."""

    amount: float = 0.0  # 0 none .. 1 a little .. 2 twice as much
    seed: int = 0  # seed of the random generator; the same seed gives the same motion


NO_IDLING = Idling()  # no idle motion


def add_idle_motion(sequences: Sequences, block_span: Span, idling: Idling, robot: Robot) -> Sequences:
    """Add idle motion to the pauses of a block.

    Args:
        sequences: requested motion of the parts.
        block_span: begin and end of the block [s].
        idling: amount and seed.
        robot: parts that it lacks do not move.
    """
    torso, head = idle(pauses(used_spans(sequences), block_span), idling)
    return replace(
        sequences,
        torso=(*sequences.torso, torso) if torso and robot.joints("torso") else sequences.torso,
        head=(*sequences.head, head) if head and robot.joints("neck") else sequences.head,
    )


def idle(free_spans: Iterable[Span], idling: Idling) -> tuple[Layer, Layer]:
    """Create torso and head layers of idle motion in free time spans.

    Args:
        free_spans: unused spans in block time, in order [s].
        idling: amount and seed.

    Returns:
        Layer of the torso and of the head, both empty without pauses.
    """
    if idling.amount == 0.0:
        return (), ()
    amount, generator = idling.amount, np.random.default_rng(idling.seed)
    torso: list[TurnKey] = []
    head: list[TurnKey] = []
    for begin, end in free_spans:
        if end - begin - 2 * IDLE_MARGIN >= MIN_PAUSE:
            times = _breath_times((begin + IDLE_MARGIN, end - IDLE_MARGIN), generator)
            torso += [
                TurnKey(times[0], UPRIGHT_TURN),
                *_sway_keys(times, amount, generator),
                TurnKey(times[-1], UPRIGHT_TURN),
            ]
            head += [
                TurnKey(times[0], UPRIGHT_TURN),
                *_glance_keys(times, amount, generator),
                TurnKey(times[-1], UPRIGHT_TURN),
            ]
    return tuple(torso), tuple(head)


def used_spans(sequences: Sequences) -> tuple[Span, ...]:
    """Return time spans [s] with head motion, trunk motion or raised hands.

    Hands count while they are away from rest. Head and trunk may hold any rotation.
    """
    turning_spans = [
        (a.time, b.time)
        for layer in (*sequences.torso, *sequences.head)
        for a, b in pairwise(layer)
        if a.turn != b.turn
    ]
    reaching_spans = [
        (a.time, b.time)
        for row in sequences.hands.values()
        for a, b in pairwise(row)
        if a.hand != REST_HAND or b.hand != REST_HAND
    ]
    return (*turning_spans, *reaching_spans)


def pauses(occupied: Iterable[Span], block_span: Span) -> tuple[Span, ...]:
    """Return the time spans [s] of a block outside occupied spans.

    Args:
        occupied: spans in which some part is used, in any order [s].
        block_span: begin and end [s].
    """
    gaps: list[Span] = []
    free_time = block_span[0]
    for begin, end in sorted(occupied):
        if begin > free_time:
            gaps.append((free_time, min(begin, block_span[1])))
        free_time = max(free_time, end)
    if free_time < block_span[1]:
        gaps.append((free_time, block_span[1]))
    return tuple(gaps)


def _breath_times(span: Span, generator: np.random.Generator) -> list[float]:
    """Return the times of breath reversals over a span [s].

    The number of intervals is even.
    """
    count = 2 * max(1, round((span[1] - span[0]) / BREATH_PERIOD))
    durations = 1.0 + 0.15 * generator.uniform(-1.0, 1.0, count)
    return [
        float(time) for time in span[0] + (span[1] - span[0]) * np.append(0.0, np.cumsum(durations)) / durations.sum()
    ]


def _sway_keys(times: list[float], amount: float, generator: np.random.Generator) -> Iterator[TurnKey]:
    """Yield torso keys of random weight shifts at breath reversals."""
    shifted = UPRIGHT_TURN
    for k, time in enumerate(times[1:-1], 1):
        if k % 4 == 1:
            lateral, turned = amount * SWAY_ANGLE * generator.uniform(-1.0, 1.0, 2)
            shifted = Turn(torsion=float(turned), roll=float(lateral))
        yield TurnKey(time, shifted)


def _glance_keys(times: list[float], amount: float, generator: np.random.Generator) -> Iterator[TurnKey]:
    """Yield head keys of random glances at breath reversals.

    A glance returns at a later breath.
    """
    glance_turn = UPRIGHT_TURN
    for k, time in enumerate(times[1:-1], 1):
        if k % 2:
            is_glancing = float(generator.uniform()) < amount * GLANCE_PROBABILITY
            lateral, down = generator.uniform(-1.0, 1.0, 2) * amount * GLANCE_ANGLE * is_glancing
            glance_turn = Turn(torsion=float(lateral), tilt=0.4 * float(down))
        yield TurnKey(time, glance_turn)
