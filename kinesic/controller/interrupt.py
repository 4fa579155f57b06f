"""Leaves a running motion: to rest in the least time, or over into another motion, under the same limits.

The new motion keeps the control points that are in force at the cut, so that angles, speeds and accelerations go on
without a step and every limit holds across the cut as it does elsewhere.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.double_s import least_stop
from kinesic.body.limits import Limits
from kinesic.controller.condition import Conditioned
from kinesic.controller.grid import grid
from kinesic.controller.keys import Keys
from kinesic.controller.postures import Posture
from kinesic.controller.quadratic import nearest
from kinesic.controller.segments import Segment, segments
from kinesic.controller.trajectory import STEP, Trajectory

LEAST = 3  # pieces in which three control points give way to three others
LONGEST = 400  # pieces
ROOM = 1.0008  # on limits
SAME = 1e-9  # steps


def cut(running: Trajectory, time: float) -> int:
    """The knot at which a motion can be left: the first not before a performance time [s]."""
    return int(np.clip(np.ceil(time / STEP - SAME), 0, len(running.controls) - 3))


@dataclass(frozen=True, eq=False)
class Joined:
    """A running motion that goes over into another."""

    trajectory: Trajectory
    delay: float  # [s] by which the other comes later than it would from rest


def stopped(running: Trajectory, time: float, limits: Limits) -> Trajectory:
    """Comes to rest in the least time, each hinge wherever it can.

    Args:
        running: the motion, within the limits.
        time: [s] performance time from which it may be left, at the next knot.
        limits: of all hinges.

    Returns:
        The same until the cut, then to rest.
    """
    knot, roomy = cut(running, time), _roomy(limits)
    _, speeds, accelerations = running.sample(np.array([knot * STEP]))
    least = least_stop(speeds[0], accelerations[0], roomy.acceleration, roomy.jerk) / STEP
    ways = enumerate(zip(running.controls[knot:].T, least, strict=True))
    tails = [_halt(hinge, own, int(pieces), roomy) for hinge, (own, pieces) in ways]
    length = max(4 - knot, *(len(tail) for tail in tails))  # one piece at least
    whole = np.stack([np.append(tail, np.full(length - len(tail), tail[-1])) for tail in tails], axis=1)
    return Trajectory(sealed(np.vstack([running.controls[:knot], whole])), running.zero)


def _halt(hinge: int, own: Floats, least: int, limits: Limits) -> Floats:
    """Control points of the shortest way to rest, of at least so many pieces; at worst its own way (k + 3,)."""
    if np.ptp(own[:3]) == 0.0:
        return own[:3]
    about, none, entry = float(own[1]), np.empty(0), tuple(map(float, own[:3]))

    def way(more: int) -> Floats | None:
        whole = grid(max(LEAST, least) + more, STEP)
        halt = Segment(hinge, 0, whole, about, about, none, none, (), entry=entry, halts=True)
        return nearest(halt, np.full(whole.pieces + 1, about), limits)

    found = _first(way, len(own) - 3 - max(LEAST, least))
    return own if found is None else found[1]


def joined(
    running: Trajectory, time: float, postures: tuple[Posture, ...], following: Conditioned, limits: Limits
) -> Joined:
    """Goes over into another motion without coming to rest, as soon as that can be.

    Each hinge finds its way from how it moves at the cut to how the other motion passes its first key, or rests; where
    there is none, to where the other motion begins. The other motion comes later by the least that lets all do so.

    Args:
        running: the motion, within the limits.
        time: [s] performance time from which it may be left, at the next knot.
        postures: of the other motion.
        following: what came of them.
        limits: of all hinges.

    Raises:
        ValueError: a motion does not keep the limits, so that there is no way.
    """
    knot, roomy = cut(running, time), _roomy(limits)
    entries, after = running.controls[knot : knot + 3], following.trajectory.controls
    firsts = [s for s in segments(following.planned, Keys.of(postures, limits), STEP) if s.first == 0]
    bridges = [_bridged(first, entries[:, first.hinge], after[:, first.hinge], roomy) for first in firsts]
    more = max(delay for _, delay in bridges)
    columns: list[Floats] = []
    while len(columns) < len(bridges):
        begins = [_crossed(bridge, more, roomy) for bridge, _ in bridges]
        columns = [
            np.append(begin, after[bridge.controls.stop :, bridge.hinge])
            for (bridge, _), begin in zip(bridges, begins, strict=True)
            if begin is not None
        ]
        more += len(columns) < len(bridges)
    controls = np.vstack([running.controls[:knot], np.stack(columns, axis=1)])
    zero = (knot + more) * STEP + following.trajectory.zero
    return Joined(Trajectory(sealed(controls), zero), more * STEP)


def _bridged(first: Segment, entry: Floats, after: Floats, limits: Limits) -> tuple[Segment, int]:
    """A way from control points (3,) to those of another motion (k + 3,), and by how many pieces it is longer."""
    for pieces in (int(first.places[0]) if len(first.places) else first.grid.pieces, 0):
        bridge = replace(
            first,
            grid=grid(pieces, STEP),
            places=np.empty(0),
            angles=np.empty(0),
            pairs=(),
            start=float(entry[1]),
            end=float(after[pieces + 1]),
            entry=tuple(map(float, entry)),
            exit=tuple(map(float, after[pieces : pieces + 3])),
        )
        found = _first(partial(_crossed, bridge, limits=limits), LONGEST)
        if found is not None:
            return bridge, found[0]
    raise ValueError(f"hinge {first.hinge}: no way on within {LONGEST * STEP:.0f} s, so its motion exceeds its limits")


def _crossed(bridge: Segment, more: int, limits: Limits) -> Floats | None:
    """Control points over a bridge that is longer by some pieces; None when there are none."""
    pieces = bridge.grid.pieces + more
    if pieces < LEAST:
        return None
    longer = replace(bridge, grid=grid(pieces, STEP))
    found = nearest(longer, np.linspace(bridge.start, bridge.end, pieces + 1), limits)
    if found is not None:
        found[:3], found[-3:] = bridge.entry, bridge.exit  # to the last bit
    return found


def _first(way: Callable[[int], Floats | None], most: int) -> tuple[int, Floats] | None:
    """The least number of pieces more with which there is a way: doubled until there is, then halved back."""
    low, high, found = -1, 0, way(0)
    while found is None:
        low, high = high, 2 * high + 1
        if high > most:
            return None
        found = way(high)
    while high - low > 1:
        middle = (low + high) // 2
        shorter = way(middle)
        if shorter is None:
            low = middle
        else:
            high, found = middle, shorter
    return high, found


def _roomy(limits: Limits) -> Limits:
    """A little more than the limits: where a motion is at one, there may be just one way on, and none is found."""
    return replace(
        limits,
        speed=sealed(ROOM * limits.speed),
        acceleration=sealed(ROOM * limits.acceleration),
        jerk=sealed(ROOM * limits.jerk),
        duty=sealed(ROOM * limits.duty),
    )
