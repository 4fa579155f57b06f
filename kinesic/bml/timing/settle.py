"""Computation of all sync times of a network without contradictions.

Coupled behaviours are solved together. Groups linked to the block's start are solved in place; other groups are solved
separately and moved so that they start at 0. An uncoupled behaviour fits its free sync points between the fixed ones
(Greta's rule; source: BML 1.0): spare time lengthens the hold after the stroke; missing time is taken from the holds
first, then from repetitions of the stroke, and then from all other phases in proportion.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from kinesic.bml.timing.constraints import Point
from kinesic.bml.timing.lp import TimingProgram
from kinesic.bml.timing.negative_cycles import Edge
from kinesic.bml.timing.network import Network, Potentials, SyncChain
from kinesic.bml.timing.points import HOLD_SYNCS, is_repeated

Spans = Mapping[str, Mapping[str, float]]

_STRETCHABLE_SYNCS = ("relax", "strokeStart", "end", "ready")  # ends of the phases that absorb spare time, by priority


def fit_behaviour(
    names: Sequence[str],
    spans: Mapping[str, float],
    requested_times: Mapping[str, float],
    repeated: Collection[str] = (),
) -> list[float]:
    """Return the times of all sync points of one behaviour [s].

    Args:
        names: sync points in order.
        spans: natural duration [s] from the previous point to each point; 0 if missing.
        requested_times: requested times [s] in order; if empty, the behaviour starts at 0.
        repeated: points that end a repetition of the stroke.

    Returns:
        A time for each name; times never decrease.
    """
    natural = [spans.get(name, 0.0) for name in names]
    fixed = [index for index, name in enumerate(names) if name in requested_times]
    if not fixed:
        fixed, requested_times = [0], {names[0]: 0.0}
    times = [requested_times.get(name, 0.0) for name in names]
    for index in range(fixed[0] - 1, -1, -1):
        times[index] = times[index + 1] - natural[index + 1]
    for early, late in pairwise(fixed):
        phases = slice(early + 1, late + 1)
        durations = _fit_durations(names[phases], natural[phases], times[late] - times[early], repeated)
        for index in range(early + 1, late):
            times[index] = min(times[index - 1] + durations[index - early - 1], times[late])
    for index in range(fixed[-1] + 1, len(names)):
        times[index] = times[index - 1] + natural[index]
    return times


def _fit_durations(
    names: Sequence[str], natural: Sequence[float], total: float, repeated: Collection[str]
) -> list[float]:
    """Stretch or shorten phase durations [s] to a given total."""
    spare = total - sum(natural)
    if spare >= 0.0:
        stretched = next((name for name in _STRETCHABLE_SYNCS if name in names), names[-1])
        return [span + spare * (name == stretched) for name, span in zip(names, natural, strict=True)]
    # shortened last, second and first
    ranks = [2 if name in HOLD_SYNCS else 1 if name in repeated else 0 for name in names]
    factors, remaining = [], total
    for rank in range(3):
        needed = sum(span for span, phase_rank in zip(natural, ranks, strict=True) if phase_rank == rank)
        factors.append(min(1.0, remaining / needed) if needed else 0.0)
        remaining = max(0.0, remaining - needed)
    return [span * factors[rank] for span, rank in zip(natural, ranks, strict=True)]


@dataclass(frozen=True)
class _Group:
    """Behaviours that are coupled by points with unknown times."""

    chains: tuple[SyncChain, ...]
    orders: tuple[Edge, ...]


def solve_times(network: Network, spans: Spans) -> dict[Point, float]:
    """Return the time of every sync point [s].

    Args:
        network: network without contradictions.
        spans: behaviour id -> {sync point: natural duration [s] from the previous one}.
    """
    potentials = network.potentials
    root, gap = potentials.find(network.start)
    fixed_times = _Solver(potentials, spans).solve(network.chains, network.orders, {root: -gap})
    times = {point: _compute_time(point, potentials, fixed_times) for chain in network.chains for point in chain.points}
    constrained = {point for distance in network.distances for point in (distance.late, distance.early)}
    constrained |= {point for order in network.orders for point in (order.tail, order.head)}
    for chain in network.chains:
        for early, late in pairwise(chain.points):
            times[late] = max(times[late], times[early])  # remove rounding errors
        if chain.points[0] not in constrained and not _has_negative_time(chain, network, times):
            _shorten_preparation(chain, times, spans[chain.behaviour.id])
    return times


def _compute_time(point: Point, potentials: Potentials, fixed_times: Mapping[Point, float]) -> float:
    root, gap = potentials.find(point)
    return fixed_times[root] + gap


class _Solver:
    """Solver for the times of linked sync points, group by group."""

    def __init__(self, potentials: Potentials, spans: Spans) -> None:
        self._potentials, self._spans = potentials, spans

    def solve(
        self, chains: Sequence[SyncChain], orders: Sequence[Edge], fixed_times: Mapping[Point, float]
    ) -> dict[Point, float]:
        """Return the time of each set's root sync point.

        `fixed_times` holds the known ones [s].
        """
        times = dict(fixed_times)
        coupled: list[_Group] = []
        for group in self._groups(chains, orders, fixed_times):
            has_fixed_root = any(self._root(point) in fixed_times for point in _list_points(group))
            if self._is_single(group, fixed_times):
                times |= self._solve_single(group.chains[0], fixed_times)
            elif has_fixed_root:
                coupled.append(group)
            else:
                times |= self._solve_floating(group)
        if coupled:
            chains_of_groups = [chain for group in coupled for chain in group.chains]
            orders_of_groups = [order for group in coupled for order in group.orders]
            times |= TimingProgram(self._potentials, fixed_times).times(chains_of_groups, self._spans, orders_of_groups)
        return times

    def _root(self, point: Point) -> Point:
        return self._potentials.find(point)[0]

    def _groups(
        self, chains: Sequence[SyncChain], orders: Sequence[Edge], fixed_times: Mapping[Point, float]
    ) -> Iterator[_Group]:
        """Yield groups of coupled behaviours whose times are not fixed."""
        sets = Potentials()

        def first_free(points: Sequence[Point]) -> Point | None:
            free = [root for point in points if (root := self._root(point)) not in fixed_times]
            for root in free:
                sets.join(root, free[0], 0.0)
            return free[0] if free else None

        free_of_chains = [(chain, first_free(chain.points)) for chain in chains]
        free_of_orders = [(order, first_free((order.tail, order.head))) for order in orders]
        members: dict[Point, tuple[list[SyncChain], list[Edge]]] = {}
        for chain, free in free_of_chains:
            if free is not None:
                members.setdefault(sets.find(free)[0], ([], []))[0].append(chain)
        for order, free in free_of_orders:
            if free is not None:
                members.setdefault(sets.find(free)[0], ([], []))[1].append(order)
        for group_chains, group_orders in members.values():
            yield _Group(tuple(group_chains), tuple(group_orders))

    def _is_single(self, group: _Group, fixed_times: Mapping[Point, float]) -> bool:
        """Return whether a group is one behaviour solvable without the linear program."""
        if len(group.chains) != 1 or group.orders:
            return False
        chain = group.chains[0]
        free = [root for point in chain.points if (root := self._root(point)) not in fixed_times]
        return chain.is_rigid or len(set(free)) == len(free)

    def _solve_single(self, chain: SyncChain, fixed_times: Mapping[Point, float]) -> dict[Point, float]:
        if chain.is_rigid:
            return {chain.points[0]: 0.0}  # root of a set without other chains
        names = [point.sync for point in chain.points]
        requested_times = {
            point.sync: _compute_time(point, self._potentials, fixed_times)
            for point in chain.points
            if self._root(point) in fixed_times
        }
        repeated = {name for name in names if is_repeated(chain.behaviour.action, name)}
        times = fit_behaviour(names, self._spans[chain.behaviour.id], requested_times, repeated)
        root_times = {}
        for point, time in zip(chain.points, times, strict=True):
            root, gap = self._potentials.find(point)
            if root not in fixed_times:
                root_times[root] = time - gap
        return root_times

    def _solve_floating(self, group: _Group) -> dict[Point, float]:
        """Solve the times of a group that starts at 0.

        The times of a speech, if there is one, are set first.
        """
        speech = next((chain for chain in group.chains if chain.is_rigid), None)
        if speech is None:
            times = TimingProgram(self._potentials, {}).times(group.chains, self._spans, group.orders)
        else:
            root, gap = self._potentials.find(speech.points[0])
            times = self.solve(group.chains, group.orders, {root: -gap})
        start = min(_compute_time(chain.points[0], self._potentials, times) for chain in group.chains)
        return {root: time - start for root, time in times.items()}


def _list_points(group: _Group) -> Iterator[Point]:
    for chain in group.chains:
        yield from chain.points
    for order in group.orders:
        yield from (order.tail, order.head)


def _has_negative_time(chain: SyncChain, network: Network, times: Mapping[Point, float]) -> bool:
    """Return whether the document gives a behaviour a time before 0."""
    root = network.potentials.find(network.start)[0]
    return any(times[point] < 0.0 and network.potentials.find(point)[0] == root for point in chain.points)


def _shorten_preparation(chain: SyncChain, times: dict[Point, float], spans: Mapping[str, float]) -> None:
    """Delay a start before 0 by at most half the preparation.

    A speech is never given, because distances constrain its start.
    """
    start, after = chain.points[:2]
    if times[start] < 0.0:
        half = times[after] - 0.5 * spans.get(after.sync, 0.0)
        times[start] = max(times[start], min(0.0, half))
