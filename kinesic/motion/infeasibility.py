"""Time deficit of infeasible segments, with its gradient.

Gaps longer by a fraction s permit velocities higher by s, accelerations by 2 s and jerks by 3 s. The least such s is
the result of a linear program. Its multipliers give the gradient over key times and the binding limit of each gap.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.double_s import IntervalDurations, KeyInterval
from kinesic.motion.key_time_lp import CuttingPlane
from kinesic.motion.keys import TIME_TOLERANCE, Keys, Pair
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import relax_limits, smoothest
from kinesic.motion.trajectory import spline_weights

Quantity = Literal["speed", "acceleration", "jerk", "duty"]

# Limited quantities, in the order of `Grid.rows`.
LIMIT_QUANTITIES: tuple[Quantity, ...] = ("speed", "acceleration", "jerk", "duty")
EASY_DEFICIT = -0.2  # ln(required / available time) below which the deficit is not computed exactly: time is ample
ACCELERATION_CONTROLS = np.array(
    [1 / 3, -1 / 6, 1 / 3]
)  # spline control points with position 0, velocity 0, acceleration 1 / step^2
MIN_SLOPE_DEFICIT = -0.01  # ln(required / available time) above which inaccurate slopes are recomputed
MAX_SLOPE_IMBALANCE = 0.1  # largest |sum of slopes| / sum of |slopes| of reliable slopes; the ideal is 0
MIN_RELIABLE_SLOPE = 0.5  # [1/s] if no deficit slope exceeds this, finite differences replace the slopes
DEFICIT_MARGIN = 0.002  # [ln(time ratio)] extra time demanded by cutting planes, so that the search ends soon
MIN_PLANE_SLOPE = 0.1  # [1/s] deficit gradient that counts as zero; each binding key interval then gets a cut
BINDING_FRACTION = 0.05  # fraction of a segment's summed multipliers from which a gap's limit is binding


@dataclass(frozen=True)
class Bottleneck:
    """Hinge and limit that require more time than available."""

    hinge: int
    quantity: Quantity
    ratio: float  # required / requested duration


@dataclass(frozen=True, eq=False)
class Infeasibility:
    """Log of required / available time of a segment, or a bound.

    For a bound, the amount is the bound, slopes are 0, and no limit binds.
    """

    amount: float  # ln(required / available time), negative if there is spare time
    slopes: Floats  # (m + 2,) [1/s] of the amount over the times of start, keys and end
    binding: tuple[Quantity | None, ...]  # (m + 1,) most binding limit of each gap
    controls: Floats  # (k + 3,) [rad] control points of the motion that exceeds the limits least
    programs: int = 1  # number of solved programs


def estimate_limit_ratio(segment: SplineSegment, limits: Limits) -> float:
    """Estimate a segment's largest limit ratio from its smoothest motion."""
    if segment.is_still:
        return 0.0
    return segment.grid.largest_limit_ratio(smoothest(segment), limits, segment.hinge)


def measure_time_deficit(
    segment: SplineSegment, limits: Limits, *, target: float | None = None, max_work: float = np.inf
) -> Infeasibility | None:
    """Measure ln(required / available time) of a segment, with its gradient.

    Args:
        segment: with the keys to be passed.
        limits: of all hinges.
        target: amount below which an upper bound suffices; None: always exact.
        max_work: largest number of knot intervals of all programs together.

    Returns:
        None if the program cannot be solved, or the programs would have more knot intervals than `max_work`.
    """
    relaxation = None if segment.grid.pieces > max_work else _relax(segment, limits, target)
    if relaxation is None:
        return None
    if relaxation.is_bound:
        amount = relaxation.amount if target is None else min(relaxation.amount, target)  # the log rounds up by an ulp
        no_limits = (None,) * len(relaxation.binding)
        return Infeasibility(amount, np.zeros(len(segment.marks)), no_limits, relaxation.controls)
    slopes, programs = _compute_slopes(segment, relaxation), 1
    if relaxation.amount > MIN_SLOPE_DEFICIT and (
        abs(slopes.sum()) > MAX_SLOPE_IMBALANCE * np.abs(slopes).sum() or np.abs(slopes).max() < MIN_RELIABLE_SLOPE
    ):
        affected = [key for key, pair in enumerate(pairwise(relaxation.binding)) if pair != (None, None)]
        programs += len(affected)
        if programs * segment.grid.pieces > max_work:
            return None
        for key in affected:
            slopes[key + 1] = _compute_difference(segment, limits, key, relaxation.amount)
    total = float(np.abs(slopes).sum())
    balanced = slopes - slopes.sum() * np.abs(slopes) / total if total else slopes
    return Infeasibility(relaxation.amount, balanced, relaxation.binding, relaxation.controls, programs)


def make_cutting_planes(segment: SplineSegment, deficit: Infeasibility, times: Floats) -> list[CuttingPlane]:
    """Return cutting planes that exclude the current, infeasible key times (m,) [s].

    If the gradient is close to zero, each gap with a binding limit grows instead.
    """
    amount = max(deficit.amount, 0.0) + DEFICIT_MARGIN
    if np.abs(deficit.slopes).max() > MIN_PLANE_SLOPE:
        slopes = _expand_slopes(segment, deficit.slopes, len(times))
        return [CuttingPlane(slopes, float(slopes @ times) - amount)]
    planes = []
    for k in (k for k, quantity in enumerate(deficit.binding) if quantity is not None):
        gap = np.zeros(len(segment.marks))
        gap[k : k + 2] = 1.0, -1.0
        slopes = _expand_slopes(segment, gap, len(times))
        planes.append(CuttingPlane(slopes, float(slopes @ times) * float(np.exp(amount))))
    return planes


def find_limiting_intervals(segment: SplineSegment, deficit: Infeasibility | None) -> Sequence[KeyInterval]:
    """Return key intervals with a binding limit, or all if unknown."""
    binding = () if deficit is None else zip(segment.pairs, deficit.binding, strict=True)
    return [(segment.hinge, pair) for pair, limit in binding if limit and pair[0] != pair[1]] or segment.key_intervals


def find_bottlenecks(segment: SplineSegment, deficit: Infeasibility | None) -> list[tuple[Pair, Bottleneck]]:
    """Return bottlenecks of a segment's key intervals with a binding limit."""
    if deficit is None:
        return []
    ratio = float(np.exp(deficit.amount))
    limits = zip(segment.pairs, deficit.binding, strict=True)
    return [(pair, Bottleneck(segment.hinge, limit, ratio)) for pair, limit in limits if limit and pair[0] != pair[1]]


def find_velocity_bottlenecks(
    keys: Keys, limits: Limits, velocity_durations: IntervalDurations
) -> Iterator[tuple[Pair, Bottleneck]]:
    """Yield bottlenecks of key intervals too short even at full velocity."""
    times = keys.requested_times.tolist()
    for (hinge, pair), duration in velocity_durations.items():
        requested = max(times[pair[1]] - times[pair[0]], keys.gaps[pair])
        if duration > requested + TIME_TOLERANCE:
            is_velocity_bound = limits.speed[hinge] <= limits.duty[hinge] / limits.viscous[hinge]
            yield pair, Bottleneck(hinge, "speed" if is_velocity_bound else "duty", duration / requested)


def _expand_slopes(segment: SplineSegment, slopes: Floats, count: int) -> Floats:
    """Map a segment's gradient to the key times of the whole motion."""
    expanded = np.zeros(count)
    for marks, slope in zip(segment.marks, slopes, strict=True):
        expanded[list(marks)] += slope / len(marks)
    return expanded


@dataclass(frozen=True, eq=False)
class _LogRelaxation:
    """Least logarithmic time stretch that makes a segment feasible, with its motion."""

    controls: Floats  # (k + 3,) [rad]
    amount: float  # ln(required / available time)
    multipliers: Floats  # of the fixed equations, with respect to the amount
    binding: tuple[Quantity | None, ...]
    is_bound: bool  # whether the amount is only an upper bound, below the target


def _relax(segment: SplineSegment, limits: Limits, target: float | None = None) -> _LogRelaxation | None:
    lowest = -np.inf if target is None else float(np.expm1(2 * target) / 2)
    grid, relaxation = segment.grid, relax_limits(segment, limits, easy=EASY_DEFICIT, target=lowest)
    if relaxation is None:
        return None
    free = grid.free_rows
    gaps = np.searchsorted(segment.places, free.places)
    return _LogRelaxation(
        relaxation.controls,
        float(np.log1p(2 * relaxation.amount) / 2),
        relaxation.fixed_multipliers / (1 + 2 * relaxation.amount),
        _find_binding_limits(gaps, free.kinds, relaxation.limit_multipliers * free.powers, len(segment.places) + 1),
        relaxation.amount <= lowest,
    )


def _compute_slopes(segment: SplineSegment, relaxation: _LogRelaxation) -> Floats:
    """Return the gradient of the deficit with respect to key times [1/s].

    Of shape (m + 2,) for start, keys and end, from the multipliers of the fixed equations.
    """
    step, count, places = segment.grid.step, len(segment.places), segment.places
    controls, multipliers = relaxation.controls, relaxation.multipliers
    first, weights = spline_weights(places, segment.grid.pieces, 1)
    velocities = np.sum((np.diff(controls) / step)[first[:, None] + np.arange(3)] * weights, axis=1)
    slopes = np.array([0.0, *(multipliers[:count] * velocities), 0.0])
    start, end, last = multipliers[count : count + 3], multipliers[count + 3 :], controls[-4:]
    if segment.rests_early:
        end, last, slopes[-2] = np.append(multipliers[count - 1], end)[:3], controls[-5:-1], 0.0
    jerks = np.array([controls[:4], last]) @ [-1.0, 3.0, -3.0, 1.0] / step**3
    slopes[[0, -1]] = np.stack([start, end]) @ ACCELERATION_CONTROLS * step**2 * jerks
    return slopes


def _compute_difference(segment: SplineSegment, limits: Limits, key: int, amount: float) -> float:
    """Compute one key's slope of the deficit by finite differences [1/s]."""
    ends = np.array([0.0, *segment.places, float(segment.grid.pieces)])
    step = 1.0 if ends[key + 2] - ends[key + 1] > 3.0 else -1.0
    moved = replace(segment, places=segment.places + step * (np.arange(len(segment.places)) == key))
    relaxation = _relax(moved, limits)
    return 0.0 if relaxation is None else (relaxation.amount - amount) / (step * segment.grid.step)


def _find_binding_limits(
    gaps: np.ndarray, kinds: np.ndarray, multipliers: Floats, count: int
) -> tuple[Quantity | None, ...]:
    """Return the binding limit of each gap between keys, None without one.

    One entry for each of m + 1 gaps.
    """
    sums = np.zeros((4, count))
    np.add.at(sums, (kinds, gaps), multipliers)
    is_significant = sums.max(axis=0) >= BINDING_FRACTION * sums.sum()
    return tuple(
        LIMIT_QUANTITIES[k] if binds else None for k, binds in zip(sums.argmax(axis=0), is_significant, strict=True)
    )
