"""Measures by how much a segment lacks time: the least relaxation of all limits with which it can be passed.

Longer gaps by a share s let speeds be higher by s, accelerations by 2 s and jerks by 3 s. The least such s is a linear
program; its multipliers say what a later key would be worth, and which limit binds where.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.double_s import Way
from kinesic.motion.key_time_lp import CuttingPlane
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import relax_limits, smoothest
from kinesic.motion.trajectory import spline_weights

Quantity = Literal["speed", "acceleration", "jerk", "duty"]

QUANTITIES: tuple[Quantity, ...] = ("speed", "acceleration", "jerk", "duty")  # in the order of a grid's rows
EASY = -0.2  # a share of time to spare that need not be known better
ACCELERATING = np.array([1 / 3, -1 / 6, 1 / 3])  # control points at angle 0 and speed 0 with acceleration 1 / step^2
SPARE = -0.01  # amount below which nobody asks for slopes
UNEVEN = 0.1  # share of the slopes that do not sum to 0, as they must: moving all keys together changes nothing
FLAT = 0.5  # [1/s] slopes that are too small to be believed
MARGIN = 0.002  # of the time, that a plane asks for beside what is lacking, so that a motion is found quickly
KINK = 0.1  # [1/s] slopes that lead nowhere
NOTABLE = 0.05  # share of all multipliers that makes a limit bind in a gap


@dataclass(frozen=True)
class Bottleneck:
    """The hinge and limit that a motion meets first."""

    hinge: int
    quantity: Quantity
    ratio: float  # by which the time is too short


@dataclass(frozen=True, eq=False)
class Infeasibility:
    """How much time a segment lacks, and where; of one that does not, it may be known by no more than a bound.

    Then the amount is the bound, slopes are 0, and no limit binds.
    """

    amount: float  # of the logarithm of their time; negative where there is some to spare
    slopes: Floats  # (m + 2,) [1/s] of the amount over the times of start, keys and end
    binding: tuple[Quantity | None, ...]  # (m + 1,) the limit that binds most in each gap
    controls: Floats  # (k + 3,) [rad] control points of the motion that exceeds the limits least
    programs: int = 1  # that were solved


def guess_share(segment: SplineSegment, limits: Limits) -> float:
    """Guesses cheaply: the largest share of any limit on the smoothest way through the keys of a segment."""
    if segment.still:
        return 0.0
    return segment.grid.largest(smoothest(segment), limits, segment.hinge)


def measure_shortage(
    segment: SplineSegment, limits: Limits, *, target: float | None = None, max_work: float = np.inf
) -> Infeasibility | None:
    """Measure the time that a segment lacks.

    Args:
        segment: whose keys are to be passed.
        limits: of all hinges.
        target: amount below which a bound on it does; None: it is asked for exactly.
        max_work: pieces that all programs together may have.

    Returns:
        None when the program cannot be solved, or the programs would have more pieces than `max_work`.
    """
    found = None if segment.grid.pieces > max_work else _least(segment, limits, target)
    if found is None:
        return None
    if found.bound:
        amount = found.amount if target is None else min(found.amount, target)  # its logarithm may be an ulp more
        return Infeasibility(amount, np.zeros(len(segment.marks)), (None,) * len(found.binding), found.controls)
    slopes, programs = _slopes(segment, found), 1
    if found.amount > SPARE and (abs(slopes.sum()) > UNEVEN * np.abs(slopes).sum() or np.abs(slopes).max() < FLAT):
        beside = [key for key, pair in enumerate(pairwise(found.binding)) if pair != (None, None)]
        programs += len(beside)
        if programs * segment.grid.pieces > max_work:
            return None
        for key in beside:
            slopes[key + 1] = _difference(segment, limits, key, found.amount)
    total = float(np.abs(slopes).sum())
    even = slopes - slopes.sum() * np.abs(slopes) / total if total else slopes
    return Infeasibility(found.amount, even, found.binding, found.controls, programs)


def planes_before(segment: SplineSegment, found: Infeasibility, times: Floats) -> list[CuttingPlane]:
    """Finds planes before key times (m,) [s] that are too short for a segment: its shortage, linearised.

    At a kink, where there is no direction, each gap in which a limit binds grows instead.
    """
    amount = max(found.amount, 0.0) + MARGIN
    if np.abs(found.slopes).max() > KINK:
        slopes = _over_all_keys(segment, found.slopes, len(times))
        return [CuttingPlane(slopes, float(slopes @ times) - amount)]
    planes = []
    for k in (k for k, quantity in enumerate(found.binding) if quantity is not None):
        gap = np.zeros(len(segment.marks))
        gap[k : k + 2] = 1.0, -1.0
        slopes = _over_all_keys(segment, gap, len(times))
        planes.append(CuttingPlane(slopes, float(slopes @ times) * float(np.exp(amount))))
    return planes


def short_ways(segment: SplineSegment, found: Infeasibility | None) -> Sequence[Way]:
    """Lists the ways in which a limit binds; all of the segment where that is not known."""
    binding = () if found is None else zip(segment.pairs, found.binding, strict=True)
    return [(segment.hinge, pair) for pair, limit in binding if limit and pair[0] != pair[1]] or segment.ways


def _over_all_keys(segment: SplineSegment, slopes: Floats, count: int) -> Floats:
    """(count,) over all key times, from (m + 2,) over start, keys and end of a segment."""
    spread = np.zeros(count)
    for marks, slope in zip(segment.marks, slopes, strict=True):
        spread[list(marks)] += slope / len(marks)
    return spread


@dataclass(frozen=True, eq=False)
class _Least:
    """The least relaxation of a segment's limits."""

    controls: Floats  # (k + 3,) [rad]
    amount: float  # of the logarithm of the time
    pulls: Floats  # multipliers of what is fixed, of the amount
    binding: tuple[Quantity | None, ...]
    bound: bool  # the amount is no more than that, which did


def _least(segment: SplineSegment, limits: Limits, target: float | None = None) -> _Least | None:
    lowest = -np.inf if target is None else float(np.expm1(2 * target) / 2)
    grid, found = segment.grid, relax_limits(segment, limits, easy=EASY, target=lowest)
    if found is None:
        return None
    free = grid.free_rows
    gaps = np.searchsorted(segment.places, free.places)
    return _Least(
        found.controls,
        float(np.log1p(2 * found.amount) / 2),
        found.ties / (1 + 2 * found.amount),
        _binding(gaps, free.kinds, found.pulls * free.powers, len(segment.places) + 1),
        found.amount <= lowest,
    )


def _slopes(segment: SplineSegment, found: _Least) -> Floats:
    """(m + 2,) [1/s] change of the amount when start, keys and end move in time, by the multipliers of what is fixed.

    A key that comes later asks for an angle less by the speed there; a rest that comes later asks for an acceleration
    less by the jerk there.
    """
    step, count, places = segment.grid.step, len(segment.places), segment.places
    controls, pulls = found.controls, found.pulls
    first, shares = spline_weights(places, segment.grid.pieces, 1)
    speeds = np.sum((np.diff(controls) / step)[first[:, None] + np.arange(3)] * shares, axis=1)
    slopes = np.array([0.0, *(pulls[:count] * speeds), 0.0])
    start, end, last = pulls[count : count + 3], pulls[count + 3 :], controls[-4:]
    if segment.rests_early:
        end, last, slopes[-2] = np.append(pulls[count - 1], end)[:3], controls[-5:-1], 0.0
    jerks = np.array([controls[:4], last]) @ [-1.0, 3.0, -3.0, 1.0] / step**3
    slopes[[0, -1]] = np.stack([start, end]) @ ACCELERATING * step**2 * jerks
    return slopes


def _difference(segment: SplineSegment, limits: Limits, key: int, amount: float) -> float:
    """[1/s] change of the amount when a key moves by a step; for corridors, which move with their keys unseen."""
    ends = np.array([0.0, *segment.places, float(segment.grid.pieces)])
    step = 1.0 if ends[key + 2] - ends[key + 1] > 3.0 else -1.0
    moved = replace(segment, places=segment.places + step * (np.arange(len(segment.places)) == key))
    found = _least(moved, limits)
    return 0.0 if found is None else (found.amount - amount) / (step * segment.grid.step)


def _binding(gaps: np.ndarray, kinds: np.ndarray, pulls: Floats, count: int) -> tuple[Quantity | None, ...]:
    """(m + 1,) the limit with the largest sum of multipliers in each gap."""
    sums = np.zeros((4, count))
    np.add.at(sums, (kinds, gaps), pulls)
    notable = sums.max(axis=0) >= NOTABLE * sums.sum()
    return tuple(QUANTITIES[k] if binds else None for k, binds in zip(sums.argmax(axis=0), notable, strict=True))
