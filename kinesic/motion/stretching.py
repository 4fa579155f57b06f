"""Stretches key times until every short segment has a motion: one linear program about the last times after the other.

Each program is exact to first order only. Where a segment falls short of what it was promised, more is reserved for
it; where a step makes things worse, the next one is smaller.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.budget import ENDLESS, Budget
from kinesic.motion.infeasibility import Infeasibility
from kinesic.motion.key_time_lp import KeyTimeProblem, relax_key_times, strain
from kinesic.motion.segments import SplineSegment
from kinesic.motion.time_warp import LACKING, stretch_times

Lacks = Sequence[tuple[SplineSegment, Infeasibility | None]]

ROUNDS = 10
WORK = 12  # pieces that could be measured while the linear program of one is solved
RADIUS = 0.4  # share by which time is stretched in the first round
FINE = 1e-4  # [s] to which spans are rounded up, so that every processor finds the same
MARGIN = 0.002  # of the time, that is reserved for each segment
LARGEST_GROWTH = 0.01  # of the time, by which a reserve grows where a stretch leads no nearer


@dataclass(frozen=True, eq=False)
class _Look:
    """Key times, and what is short at them."""

    times: Floats  # (m,) [s]
    lacks: list[tuple[SplineSegment, Infeasibility]]
    strain: float

    @property
    def amount(self) -> float:
        """The largest share of the time that is lacking."""
        return max((lack.amount for _, lack in self.lacks), default=-np.inf)

    @property
    def suffices(self) -> bool:
        """Whether there is a motion."""
        return self.amount <= -MARGIN / 4

    @property
    def cost(self) -> float:
        """The strain of the keys plus a penalty for the time that is lacking: what the search makes least."""
        return self.strain + LACKING * max(self.amount + MARGIN / 4, 0.0)


def stretch_until_enough(
    problem: KeyTimeProblem,
    times: Floats,
    limits: Limits,
    measure: Callable[[Floats], Lacks],
    budget: Budget = ENDLESS,
) -> Floats | None:
    """Finds key times near some others at which all segments that are measured have a motion.

    Args:
        problem: what key times keep to.
        times: (m,) [s] where to begin.
        limits: of all hinges.
        measure: segments at some times, with what each lacks.
        budget: for the linear programs.

    Returns:
        (m,) [s] block time; None when none were found, or the budget is spent before.
    """

    def look(times: Floats) -> _Look | None:
        found = measure(times)
        known = [(segment, lack) for segment, lack in found if lack is not None]
        return _Look(times, known, strain(problem.keys, times)) if len(known) == len(found) else None

    here, radius = look(times), RADIUS
    reserves: dict[tuple[int, int], float] = {}
    for _ in range(ROUNDS):
        if here is None or here.suffices:
            break
        budget.spend(WORK * sum(segment.grid.pieces for segment, _ in here.lacks))
        if budget.spent:
            break
        kept = [reserves.get(_place(segment), MARGIN) for segment, _ in here.lacks]
        found = stretch_times(problem, here.times, here.lacks, limits=limits, radius=radius, reserves=kept)
        there = None if found is None else look(_exactly(problem, found, here))
        if there is None:
            radius /= 4.0
            continue
        stuck = there.amount > here.amount / 2.0
        for segment, lack in there.lacks:
            if lack.amount > -MARGIN / 4:
                place = _place(segment)
                reserves[place] = reserves.get(place, MARGIN) + min(
                    lack.amount + MARGIN, LARGEST_GROWTH if stuck else MARGIN
                )
        better = there.suffices or there.cost < here.cost
        here, radius = (there, radius / 2.0) if better else (here, radius / 4.0)
    return here.times if here is not None and here.suffices else None


def _exactly(problem: KeyTimeProblem, times: Floats, here: _Look) -> Floats:
    """The best times at which segments have as much time as at others, found exactly; these where there are none."""
    spans = dict(problem.gaps)
    for segment, _ in here.lacks:
        for i, j in segment.pairs:
            if i != j:
                spans[i, j] = max(spans[i, j], FINE * float(np.ceil((times[j] - times[i]) / FINE)))
    try:
        return relax_key_times(replace(problem, gaps=spans))
    except ArithmeticError:  # planes that are kept but for a rounding
        return problem.keys.spread(times)


def _place(segment: SplineSegment) -> tuple[int, int]:
    return segment.hinge, segment.marks[0][0]
