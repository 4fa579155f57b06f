"""Finds a time for every sync point of a network without contradictions.

Behaviours that hang together are settled together. Groups that hang on the block's start are settled where they are;
others are settled by themselves and moved so that they start at 0. A behaviour whose times hang on nothing else fits
its free sync points between those that are given (Greta's rule, and facts on BML 1.0): longer than natural lengthens
the hold after the stroke; shorter takes the holds first, then strokes that are done once more, and then shortens all
the rest alike.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from kinesic.bml.timing.constraints import Point
from kinesic.bml.timing.lp import TimingProgram
from kinesic.bml.timing.negative_cycles import Edge
from kinesic.bml.timing.network import Network, Potentials, SyncChain
from kinesic.bml.timing.points import HOLDS, is_repeated

Spans = Mapping[str, Mapping[str, float]]

_GIVING = ("relax", "strokeStart", "end", "ready")  # phases that are lengthened, by the point that ends them


def fit_behaviour(
    names: Sequence[str], spans: Mapping[str, float], given: Mapping[str, float], repeated: Collection[str] = ()
) -> list[float]:
    """Finds the times of all sync points of a behaviour.

    Args:
        names: sync points in order.
        spans: natural seconds from the previous point to each; 0 where missing.
        given: times that are asked for [s], in order; none: it starts at 0.
        repeated: points that end a stroke done once more.

    Returns:
        A time for each name, never going back.
    """
    natural = [spans.get(name, 0.0) for name in names]
    fixed = [index for index, name in enumerate(names) if name in given]
    if not fixed:
        fixed, given = [0], {names[0]: 0.0}
    times = [given.get(name, 0.0) for name in names]
    for index in range(fixed[0] - 1, -1, -1):
        times[index] = times[index + 1] - natural[index + 1]
    for early, late in pairwise(fixed):
        phases = slice(early + 1, late + 1)
        lengths = _lengths(names[phases], natural[phases], times[late] - times[early], repeated)
        for index in range(early + 1, late):
            times[index] = min(times[index - 1] + lengths[index - early - 1], times[late])
    for index in range(fixed[-1] + 1, len(names)):
        times[index] = times[index - 1] + natural[index]
    return times


def _lengths(names: Sequence[str], natural: Sequence[float], total: float, repeated: Collection[str]) -> list[float]:
    """Seconds of each phase, with a given sum."""
    spare = total - sum(natural)
    if spare >= 0.0:
        gives = next((name for name in _GIVING if name in names), names[-1])
        return [span + spare * (name == gives) for name, span in zip(names, natural, strict=True)]
    ranks = [2 if name in HOLDS else 1 if name in repeated else 0 for name in names]
    factors, left = [], total
    for rank in range(3):
        wanted = sum(span for span, own in zip(natural, ranks, strict=True) if own == rank)
        factors.append(min(1.0, left / wanted) if wanted else 0.0)
        left = max(0.0, left - wanted)
    return [span * factors[rank] for span, rank in zip(natural, ranks, strict=True)]


@dataclass(frozen=True)
class _Group:
    """Behaviours that hang together over points that are not known yet."""

    chains: tuple[SyncChain, ...]
    orders: tuple[Edge, ...]


def settle_times(network: Network, spans: Spans) -> dict[Point, float]:
    """Finds the time of every sync point [s].

    Args:
        network: without contradictions.
        spans: behaviour id -> {sync point: natural seconds from the previous one}.
    """
    potentials = network.potentials
    root, gap = potentials.find(network.start)
    known = _Settling(potentials, spans).settled(network.chains, network.orders, {root: -gap})
    times = {point: _time(point, potentials, known) for chain in network.chains for point in chain.points}
    used = {point for distance in network.distances for point in (distance.late, distance.early)}
    used |= {point for order in network.orders for point in (order.tail, order.head)}
    for chain in network.chains:
        for early, late in pairwise(chain.points):
            times[late] = max(times[late], times[early])  # the last bit of rounding
        if chain.points[0] not in used and not _asks_for_less(chain, network, times):
            _shorten_preparation(chain, times, spans[chain.behaviour.id])
    return times


def _time(point: Point, potentials: Potentials, known: Mapping[Point, float]) -> float:
    root, gap = potentials.find(point)
    return known[root] + gap


class _Settling:
    """Settles groups; `known` holds the times of roots of classes."""

    def __init__(self, potentials: Potentials, spans: Spans) -> None:
        self._potentials, self._spans = potentials, spans

    def settled(
        self, chains: Sequence[SyncChain], orders: Sequence[Edge], known: Mapping[Point, float]
    ) -> dict[Point, float]:
        """Finds the times of all roots."""
        times = dict(known)
        coupled: list[_Group] = []
        for group in self._groups(chains, orders, known):
            is_grounded = any(self._root(point) in known for point in _points(group))
            if self._is_alone(group, known):
                times |= self._alone(group.chains[0], known)
            elif is_grounded:
                coupled.append(group)
            else:
                times |= self._afloat(group)
        if coupled:
            every = [chain for group in coupled for chain in group.chains]
            between = [order for group in coupled for order in group.orders]
            times |= TimingProgram(self._potentials, known).times(every, self._spans, between)
        return times

    def _root(self, point: Point) -> Point:
        return self._potentials.find(point)[0]

    def _groups(
        self, chains: Sequence[SyncChain], orders: Sequence[Edge], known: Mapping[Point, float]
    ) -> Iterator[_Group]:
        """Splits into groups; what has nothing left to find is left out."""
        together = Potentials()

        def first_free(points: Sequence[Point]) -> Point | None:
            free = [root for point in points if (root := self._root(point)) not in known]
            for root in free:
                together.join(root, free[0], 0.0)
            return free[0] if free else None

        free_of_chains = [(chain, first_free(chain.points)) for chain in chains]
        free_of_orders = [(order, first_free((order.tail, order.head))) for order in orders]
        members: dict[Point, tuple[list[SyncChain], list[Edge]]] = {}
        for chain, free in free_of_chains:
            if free is not None:
                members.setdefault(together.find(free)[0], ([], []))[0].append(chain)
        for order, free in free_of_orders:
            if free is not None:
                members.setdefault(together.find(free)[0], ([], []))[1].append(order)
        for group_chains, group_orders in members.values():
            yield _Group(tuple(group_chains), tuple(group_orders))

    def _is_alone(self, group: _Group, known: Mapping[Point, float]) -> bool:
        """Whether a group is one behaviour, each of whose free points is free by itself."""
        if len(group.chains) != 1 or group.orders:
            return False
        chain = group.chains[0]
        free = [root for point in chain.points if (root := self._root(point)) not in known]
        return chain.is_rigid or len(set(free)) == len(free)

    def _alone(self, chain: SyncChain, known: Mapping[Point, float]) -> dict[Point, float]:
        if chain.is_rigid:
            return {chain.points[0]: 0.0}  # the root of a class that has no other chain
        names = [point.sync for point in chain.points]
        given = {
            point.sync: _time(point, self._potentials, known) for point in chain.points if self._root(point) in known
        }
        repeated = {name for name in names if is_repeated(chain.behaviour.action, name)}
        times = fit_behaviour(names, self._spans[chain.behaviour.id], given, repeated)
        found = {}
        for point, time in zip(chain.points, times, strict=True):
            root, gap = self._potentials.find(point)
            if root not in known:
                found[root] = time - gap
        return found

    def _afloat(self, group: _Group) -> dict[Point, float]:
        """Settles a group that hangs on nothing: around a speech where it has one; it starts at 0."""
        speech = next((chain for chain in group.chains if chain.is_rigid), None)
        if speech is None:
            times = TimingProgram(self._potentials, {}).times(group.chains, self._spans, group.orders)
        else:
            root, gap = self._potentials.find(speech.points[0])
            times = self.settled(group.chains, group.orders, {root: -gap})
        start = min(_time(chain.points[0], self._potentials, times) for chain in group.chains)
        return {root: time - start for root, time in times.items()}


def _points(group: _Group) -> Iterator[Point]:
    for chain in group.chains:
        yield from chain.points
    for order in group.orders:
        yield from (order.tail, order.head)


def _asks_for_less(chain: SyncChain, network: Network, times: Mapping[Point, float]) -> bool:
    """Whether a time before 0 is given to a behaviour."""
    root = network.potentials.find(network.start)[0]
    return any(times[point] < 0.0 and network.potentials.find(point)[0] == root for point in chain.points)


def _shorten_preparation(chain: SyncChain, times: dict[Point, float], spans: Mapping[str, float]) -> None:
    """Starts a behaviour nearer to 0 where it would start before: down to half its preparation."""
    start, after = chain.points[:2]
    if times[start] < 0.0 and not chain.is_rigid:
        half = times[after] - 0.5 * spans.get(after.sync, 0.0)
        times[start] = max(times[start], min(0.0, half))
