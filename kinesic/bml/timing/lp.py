"""Linear program for the times of coupled behaviours, close to natural durations.

Unknowns are one time per set of rigidly linked points, and the lengthening and shortening of each phase. Holds are the
cheapest to change, strokes the most expensive; shortening is spread evenly, first within a behaviour, then over all.
Otherwise behaviours are early but not before 0.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from kinesic.bml.timing.constraints import Point
from kinesic.bml.timing.negative_cycles import Edge
from kinesic.bml.timing.network import MIN_BEHAVIOUR_DURATION, Potentials, SyncChain
from kinesic.bml.timing.points import HOLD_SYNCS, is_repeated
from kinesic.body.linear_program import SparseMatrix, solve_linear_program

# [1/s] costs of lengthened phases, by the sync point at the end of the phase
_LENGTHENING_COSTS = {"relax": 1.0, "strokeStart": 1.5, "end": 4.0, "ready": 5.0}


@dataclass(frozen=True)
class _CostWeights:
    """Cost weights of changed phase durations and times.

    They were chosen so that holds change first and strokes last.
    """

    stroke_lengthening: float = 40.0  # [1/s] cost of a stroke that is longer than natural
    hold_shortening: float = 2.0  # [1/s] cost of a hold that is shorter than natural
    repetition_shortening: float = 2.5  # [1/s] cost of a repeated stroke that is shorter than natural
    phase_shortening: float = 3.0  # [1/s] cost of any other shortened phase that is no stroke
    stroke_shortening: float = 20.0  # [1/s] cost of an unrepeated stroke that is shorter than natural
    behaviour_scaling: float = 10.0  # [1/s] cost per natural second; spreads shortening evenly over one behaviour
    overall_scaling: float = 5.0  # [1/s] cost per natural second; spreads shortening evenly over all behaviours
    block_end: float = 0.3  # [1/s] cost of a later block end, or of a block end before 0
    late_start: float = 1e-4  # [1/s] cost of a later behaviour start, so that early starts are preferred
    negative_start: float = 0.6  # [1/s] cost of a start before 0 while the end of the block is free


_COST_WEIGHTS = _CostWeights()  # cost weights of every linear program


@dataclass
class _Rows:
    """Linear program under construction: constraints, costs and lower bounds of unknowns."""

    costs: list[float] = field(default_factory=list)
    lowest: list[float] = field(default_factory=list)
    entries: list[tuple[int, int, float]] = field(default_factory=list)
    bounds: list[float] = field(default_factory=list)

    def unknown(self, cost: float, lowest: float) -> int:
        self.costs.append(cost)
        self.lowest.append(lowest)
        return len(self.costs) - 1

    def at_most(self, bound: float, terms: Iterable[tuple[int, float]]) -> None:
        self.entries += [(len(self.bounds), unknown, factor) for unknown, factor in terms]
        self.bounds.append(bound)

    def solve(self) -> list[float]:
        rows, columns, values = zip(*self.entries, strict=True)
        shape = (len(self.bounds), len(self.costs))
        solution = solve_linear_program(
            np.array(self.costs),
            SparseMatrix(np.array(rows), np.array(columns), np.array(values), shape),
            (np.full(shape[0], -np.inf), np.array(self.bounds)),
            (np.array(self.lowest), np.full(shape[1], np.inf)),
        )
        if solution is None:
            raise ArithmeticError("no times keep all constraints between behaviours")
        times: list[float] = solution.tolist()
        return times


class TimingProgram:
    """Linear program for the times of behaviours under precedence constraints."""

    def __init__(self, potentials: Potentials, fixed_times: Mapping[Point, float]) -> None:
        self._potentials, self._known = potentials, fixed_times
        self._rows = _Rows()
        self._root: dict[Point, int] = {}

    def _time(self, point: Point) -> tuple[list[tuple[int, float]], float]:
        """Return a sync point's time as a linear function of the unknowns."""
        root, gap = self._potentials.find(point)
        if root in self._known:
            return [], self._known[root] + gap
        if root not in self._root:
            self._root[root] = self._rows.unknown(0.0, -np.inf)
        return [(self._root[root], 1.0)], gap

    def _at_least(self, tail: Point, head: Point, gap: float, extra_terms: Iterable[tuple[int, float]] = ()) -> None:
        """Add the constraint time(head) - time(tail) >= gap + extra terms."""
        (tail_terms, tail_gap), (head_terms, head_gap) = self._time(tail), self._time(head)
        negated = [(unknown, -factor) for unknown, factor in head_terms]
        self._rows.at_most(head_gap - tail_gap - gap, [*tail_terms, *negated, *extra_terms])

    def _add(self, chain: SyncChain, spans: Mapping[str, float], all_shrink: int, early_cost: float) -> None:
        action = chain.behaviour.action
        moving = sum(span for name, span in spans.items() if name not in HOLD_SYNCS and not is_repeated(action, name))
        shrink = self._rows.unknown(_COST_WEIGHTS.behaviour_scaling * moving, 0.0)
        self._rows.at_most(0.0, [(shrink, 1.0), (all_shrink, -1.0)])
        for tail, head in pairwise(chain.points):
            if self._potentials.find(tail)[0] == self._potentials.find(head)[0]:
                continue
            name = head.sync
            natural = spans.get(name, 0.0)
            is_hold, is_repetition = name in HOLD_SYNCS, is_repeated(action, name)
            hold_cost = (
                _COST_WEIGHTS.hold_shortening
                if is_hold
                else _COST_WEIGHTS.repetition_shortening
                if is_repetition
                else None
            )
            shorter_cost = hold_cost or (
                _COST_WEIGHTS.phase_shortening if name in _LENGTHENING_COSTS else _COST_WEIGHTS.stroke_shortening
            )
            longer = self._rows.unknown(_LENGTHENING_COSTS.get(name, _COST_WEIGHTS.stroke_lengthening), 0.0)
            shorter = self._rows.unknown(shorter_cost, 0.0)
            self._at_least(tail, head, natural, [(shorter, -1.0)])
            self._at_least(head, tail, -natural, [(longer, -1.0)])
            self._at_least(tail, head, 0.0)
            if hold_cost is None:
                self._rows.at_most(0.0, [(shorter, 1.0), (shrink, -natural)])
        first, last = chain.points[0], chain.points[-1]
        if self._potentials.find(first)[0] != self._potentials.find(last)[0]:
            self._at_least(first, last, MIN_BEHAVIOUR_DURATION)
        self._penalise_offset(first, _COST_WEIGHTS.late_start, early_cost)

    def _penalise_offset(self, point: Point, after_zero: float, before_zero: float) -> None:
        """Add costs [1/s] for a sync point's distance from time 0."""
        terms, gap = self._time(point)
        if terms:
            after, before = self._rows.unknown(after_zero, 0.0), self._rows.unknown(before_zero, 0.0)
            self._rows.at_most(-gap, [*terms, (after, -1.0)])
            self._rows.at_most(gap, [(terms[0][0], -1.0), (before, -1.0)])

    def times(
        self, chains: Sequence[SyncChain], spans: Mapping[str, Mapping[str, float]], orders: Sequence[Edge]
    ) -> dict[Point, float]:
        """Solve for the unknown time [s] of each set's root sync point.

        Args:
            chains: behaviours.
            spans: natural durations [s] of the phases of each behaviour.
            orders: precedence constraints between points.
        """
        natural = sum(sum(spans[chain.behaviour.id].values()) for chain in chains)
        all_shrink = self._rows.unknown(_COST_WEIGHTS.overall_scaling * natural, 0.0)
        ending = [order for order in orders if order.head.behaviour == "bml"]
        bound = not ending or any(self._potentials.find(order.tail)[0] in self._known for order in ending)
        early_cost = _COST_WEIGHTS.late_start * (len(chains) + 1) if bound else _COST_WEIGHTS.negative_start
        for chain in chains:
            if chain.is_rigid:
                self._penalise_offset(
                    chain.points[0], _COST_WEIGHTS.late_start, _COST_WEIGHTS.late_start * (len(chains) + 1)
                )
            else:
                self._add(chain, spans[chain.behaviour.id], all_shrink, early_cost)
        for order in orders:
            self._at_least(order.tail, order.head, order.gap)
        for end in dict.fromkeys(order.head for order in ending):
            self._penalise_offset(
                end, _COST_WEIGHTS.block_end, _COST_WEIGHTS.block_end
            )  # from both sides, since the end may be unconstrained
        solution = self._rows.solve()
        return {root: solution[unknown] for root, unknown in self._root.items()}
