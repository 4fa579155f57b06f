"""Stretching of key times by a sequence of linear programs.

Each program is exact to first order only. If a segment remains infeasible, its time reserve grows. If a step makes the
result worse, the next step is smaller.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.budget import UNLIMITED_BUDGET, Budget
from kinesic.motion.infeasibility import Infeasibility
from kinesic.motion.key_time_lp import KeyTimeProblem, shift_cost, solve_key_times
from kinesic.motion.segments import SplineSegment
from kinesic.motion.time_warp import DEFICIT_WEIGHT, stretch_times

Deficits = Sequence[tuple[SplineSegment, Infeasibility | None]]  # None: the deficit is unknown

MAX_ROUNDS = 10  # largest number of linear programs per search
LP_COST_FACTOR = 12  # cost of a segment in the linear program, in evaluations of its knot intervals
INITIAL_RADIUS = 0.4  # largest relative stretch of a gap in the first round
GAP_RESOLUTION = 1e-4  # [s] resolution to which durations are rounded up, for equal results on all machines
TIME_RESERVE = 0.002  # extra time given to each segment, as the natural logarithm of its relative stretch
MAX_RESERVE_GROWTH = 0.01  # largest increase of a segment's reserve after a round that leaves over half the deficit


@dataclass(frozen=True, eq=False)
class _Candidate:
    """Candidate key times with the time deficits of their segments."""

    times: Floats  # (m,) [s]
    deficits: list[tuple[SplineSegment, Infeasibility]]
    shift_cost: float

    @property
    def largest_deficit(self) -> float:
        """Largest time deficit, as a log-time ratio."""
        return max((deficit.amount for _, deficit in self.deficits), default=-np.inf)

    @property
    def is_feasible(self) -> bool:
        """Whether all segments are feasible at these times."""
        return self.largest_deficit <= -TIME_RESERVE / 4

    @property
    def cost(self) -> float:
        """Cost of key-time shifts plus a penalty for the largest deficit."""
        return self.shift_cost + DEFICIT_WEIGHT * max(self.largest_deficit + TIME_RESERVE / 4, 0.0)


def stretch_until_enough(
    problem: KeyTimeProblem,
    times: Floats,
    limits: Limits,
    measure: Callable[[Floats], Deficits],
    budget: Budget = UNLIMITED_BUDGET,
) -> Floats | None:
    """Return feasible key times near the given key times, or None.

    Args:
        problem: constraints on key times.
        times: (m,) [s] initial key times.
        limits: of all hinges.
        measure: function that returns the segments at key times with their deficits.
        budget: for the linear programs.

    Returns:
        (m,) [s] block time; None if no feasible times are found within the budget.
    """

    def evaluate(times: Floats) -> _Candidate | None:
        deficits = measure(times)
        measured = [(segment, deficit) for segment, deficit in deficits if deficit is not None]
        return _Candidate(times, measured, shift_cost(problem.keys, times)) if len(measured) == len(deficits) else None

    best, radius = evaluate(times), INITIAL_RADIUS
    reserves: dict[tuple[int, int], float] = {}
    for _ in range(MAX_ROUNDS):
        if best is None or best.is_feasible:
            break
        budget.spend(LP_COST_FACTOR * sum(segment.grid.pieces for segment, _ in best.deficits))
        if budget.spent:
            break
        kept = [reserves.get(_identify(segment), TIME_RESERVE) for segment, _ in best.deficits]
        stretched = stretch_times(problem, best.times, best.deficits, limits=limits, radius=radius, reserves=kept)
        candidate = None if stretched is None else evaluate(_solve_exactly(problem, stretched, best))
        if candidate is None:
            radius /= 4.0
            continue
        is_stuck = candidate.largest_deficit > best.largest_deficit / 2.0
        for segment, deficit in candidate.deficits:
            if deficit.amount > -TIME_RESERVE / 4:
                identity = _identify(segment)
                reserves[identity] = reserves.get(identity, TIME_RESERVE) + min(
                    deficit.amount + TIME_RESERVE, MAX_RESERVE_GROWTH if is_stuck else TIME_RESERVE
                )
        is_better = candidate.is_feasible or candidate.cost < best.cost
        best, radius = (candidate, radius / 2.0) if is_better else (best, radius / 4.0)
    return best.times if best is not None and best.is_feasible else None


def _solve_exactly(problem: KeyTimeProblem, times: Floats, previous: _Candidate) -> Floats:
    """Return optimal key times [s] that shorten no stretched gap.

    If the solver fails, the given times remain.
    """
    gaps = dict(problem.gaps)
    for segment, _ in previous.deficits:
        for i, j in segment.pairs:
            if i != j:
                gaps[i, j] = max(gaps[i, j], GAP_RESOLUTION * float(np.ceil((times[j] - times[i]) / GAP_RESOLUTION)))
    try:
        return solve_key_times(replace(problem, gaps=gaps))
    except ArithmeticError:  # planes that are violated only by rounding
        return problem.keys.interpolate_path_times(times)


def _identify(segment: SplineSegment) -> tuple[int, int]:
    return segment.hinge, segment.marks[0][0]
