"""Behaviours whose times hang on one another: the times nearest to their natural phases, by linear programming.

Unknowns are one time per class of equal points, and by how much each phase is longer or shorter than natural. Holds
are the cheapest to change, strokes the dearest; what is shortened is shortened alike, first within a behaviour, then
among all. Where nothing pulls, behaviours are early but not before 0.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import scipy

from kinesic.bml.timing.constraints import Point
from kinesic.bml.timing.negative_cycles import Edge
from kinesic.bml.timing.network import SHORTEST_BEHAVIOUR, Potentials, SyncChain
from kinesic.bml.timing.points import HOLDS, is_repeated

_LONGER = {"relax": 1.0, "strokeStart": 1.5, "end": 4.0, "ready": 5.0}
_STROKE_LONGER = 40.0
_SHORTER_HOLD = 2.0
_SHORTER_AGAIN = 2.5  # a stroke that is done once more
_SHORTER = 3.0
_STROKE_SHORTER = 20.0
_SHRINK = 10.0  # of one behaviour, per natural second
_SHRINK_ALL = 5.0  # of the one that shrinks most, per natural second of all
_BLOCK_END = 0.3  # per second that the block ends later, or before its start
_EARLY = 1e-4  # per second that a behaviour starts later
_BEFORE_ZERO = 0.6  # per second that it starts before 0, where nothing else says when the block ends: it ends later


@dataclass
class _Rows:
    """Sparse rows `coefficients @ unknowns <= bound`, and the cost and bounds of each unknown."""

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
        matrix = scipy.sparse.csr_array((values, (rows, columns)), shape=(len(self.bounds), len(self.costs)))
        found = scipy.optimize.linprog(
            self.costs,
            A_ub=matrix,
            b_ub=self.bounds,
            bounds=np.column_stack([self.lowest, np.full(len(self.lowest), np.inf)]),
            method="highs",
        )
        if found.x is None:
            raise ArithmeticError(f"times without contradiction were not found: {found.message}")
        return [float(value) for value in found.x]


class TimingProgram:
    """The linear program of some chains and orders."""

    def __init__(self, potentials: Potentials, known: Mapping[Point, float]) -> None:
        self._potentials, self._known = potentials, known
        self._rows = _Rows()
        self._root: dict[Point, int] = {}

    def _time(self, point: Point) -> tuple[list[tuple[int, float]], float]:
        """A point's time as unknown times plus a constant."""
        root, gap = self._potentials.find(point)
        if root in self._known:
            return [], self._known[root] + gap
        if root not in self._root:
            self._root[root] = self._rows.unknown(0.0, -np.inf)
        return [(self._root[root], 1.0)], gap

    def _at_least(self, tail: Point, head: Point, gap: float, more: Iterable[tuple[int, float]] = ()) -> None:
        """Adds time(head) - time(tail) >= gap + more."""
        (tail_terms, tail_gap), (head_terms, head_gap) = self._time(tail), self._time(head)
        minus = [(unknown, -factor) for unknown, factor in head_terms]
        self._rows.at_most(head_gap - tail_gap - gap, [*tail_terms, *minus, *more])

    def _add(self, chain: SyncChain, spans: Mapping[str, float], all_shrink: int, early: float) -> None:
        action = chain.behaviour.action
        moving = sum(span for name, span in spans.items() if name not in HOLDS and not is_repeated(action, name))
        shrink = self._rows.unknown(_SHRINK * moving, 0.0)
        self._rows.at_most(0.0, [(shrink, 1.0), (all_shrink, -1.0)])
        for tail, head in pairwise(chain.points):
            if self._potentials.find(tail)[0] == self._potentials.find(head)[0]:
                continue
            name = head.sync
            natural = spans.get(name, 0.0)
            is_hold, again = name in HOLDS, is_repeated(action, name)
            least = _SHORTER_HOLD if is_hold else _SHORTER_AGAIN if again else None
            less = least or (_SHORTER if name in _LONGER else _STROKE_SHORTER)
            longer = self._rows.unknown(_LONGER.get(name, _STROKE_LONGER), 0.0)
            shorter = self._rows.unknown(less, 0.0)
            self._at_least(tail, head, natural, [(shorter, -1.0)])
            self._at_least(head, tail, -natural, [(longer, -1.0)])
            self._at_least(tail, head, 0.0)
            if least is None:
                self._rows.at_most(0.0, [(shorter, 1.0), (shrink, -natural)])
        first, last = chain.points[0], chain.points[-1]
        if self._potentials.find(first)[0] != self._potentials.find(last)[0]:
            self._at_least(first, last, SHORTEST_BEHAVIOUR)
        self._pull_to_zero(first, _EARLY, early)

    def _pull_to_zero(self, point: Point, after_zero: float, before_zero: float) -> None:
        """Costs so much for each second that a point is after 0, and so much for each second before it."""
        terms, gap = self._time(point)
        if terms:
            after, before = self._rows.unknown(after_zero, 0.0), self._rows.unknown(before_zero, 0.0)
            self._rows.at_most(-gap, [*terms, (after, -1.0)])
            self._rows.at_most(gap, [(terms[0][0], -1.0), (before, -1.0)])

    def times(
        self, chains: Sequence[SyncChain], spans: Mapping[str, Mapping[str, float]], orders: Sequence[Edge]
    ) -> dict[Point, float]:
        """Solves for the time of every class that is not known.

        Args:
            chains: behaviours.
            spans: natural seconds of each behaviour's phases.
            orders: between their points.
        """
        natural = sum(sum(spans[chain.behaviour.id].values()) for chain in chains)
        all_shrink = self._rows.unknown(_SHRINK_ALL * natural, 0.0)
        ending = [order for order in orders if order.head.behaviour == "bml"]
        bound = not ending or any(self._potentials.find(order.tail)[0] in self._known for order in ending)
        early = _EARLY * (len(chains) + 1) if bound else _BEFORE_ZERO
        for chain in chains:
            if chain.is_rigid:
                self._pull_to_zero(chain.points[0], _EARLY, _EARLY * (len(chains) + 1))
            else:
                self._add(chain, spans[chain.behaviour.id], all_shrink, early)
        for order in orders:
            self._at_least(order.tail, order.head, order.gap)
        for end in dict.fromkeys(order.head for order in ending):
            self._pull_to_zero(end, _BLOCK_END, _BLOCK_END)  # from both sides: nothing else may hold it
        found = self._rows.solve()
        return {root: found[unknown] for root, unknown in self._root.items()}
