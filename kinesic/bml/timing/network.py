"""Network of a block's sync points: fixed time differences and precedence constraints."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from kinesic.bml.block import Behaviour, Block, NoticeType, Precedence, Speech, Synchronize, SyncRef
from kinesic.bml.timing.constraints import Equality, Point, find_synchronize_equalities, get_point
from kinesic.bml.timing.negative_cycles import TIME_TOLERANCE, Edge
from kinesic.bml.timing.points import find_speech_offsets, list_sync_points
from kinesic.body.utterance import Utterance

MIN_BEHAVIOUR_DURATION = 1e-6  # [s] shortest duration of behaviours whose points are not all fixed

ExternalTimes = Mapping[tuple[str, str, str], float]


class Potentials:
    """Disjoint sets of points with fixed time differences (weighted union-find).

    In each set, time(point) = time(root) + gap(point). Source: Tarjan.
    """

    def __init__(self) -> None:
        self._above: dict[Point, tuple[Point, float]] = {}

    def find(self, point: Point) -> tuple[Point, float]:
        """Return the root of a point's set, and the gap between both.

        The gap is time(point) - time(root). An unknown point becomes the root of a new set.
        """
        path: list[Point] = []
        above = self._above.setdefault(point, (point, 0.0))[0]
        while above != point:
            path.append(point)
            point = above
            above = self._above[point][0]
        total = 0.0
        for below in reversed(path):
            total += self._above[below][1]
            self._above[below] = (point, total)
        return point, total

    def join(self, late: Point, early: Point, gap: float) -> None:
        """Add time(late) = time(early) + gap unless both are linked already."""
        late_root, late_gap = self.find(late)
        early_root, early_gap = self.find(early)
        if late_root != early_root:
            self._above[late_root] = (early_root, early_gap + gap - late_gap)

    def list_sets(self) -> Iterator[dict[Point, float]]:
        """Yield each set as {point: gap to the set's root [s]}.

        Points keep the order in which they were added.
        """
        members: dict[Point, dict[Point, float]] = {}
        for point in list(self._above):
            root, gap = self.find(point)
            members.setdefault(root, {})[point] = gap
        yield from members.values()


@dataclass(frozen=True)
class Distance:
    """Fixed time difference: time(late) = time(early) + gap."""

    late: Point
    early: Point
    gap: float  # [s] fixed time from the early to the late point
    owner: str | None  # id of the behaviour that requests this distance; None: a constraint of the block


@dataclass(frozen=True)
class SyncChain:
    """Sync points of a behaviour in order."""

    behaviour: Behaviour
    points: tuple[Point, ...]

    @property
    def is_rigid(self) -> bool:
        """Whether all time differences within the behaviour are fixed."""
        return isinstance(self.behaviour.action, Speech)


@dataclass(frozen=True)
class Network:
    """A block's sync points with fixed time differences and precedence constraints.

    `start` is the start of the block, time 0.
    """

    start: Point
    chains: tuple[SyncChain, ...]
    distances: tuple[Distance, ...]
    orders: tuple[Edge, ...]

    @cached_property
    def potentials(self) -> Potentials:
        """Sets of sync points with fixed time differences.

        Of contradicting distances the first counts.
        """
        potentials = Potentials()
        for distance in self.distances:
            potentials.join(distance.late, distance.early, distance.gap)
        return potentials

    def edges(self) -> list[Edge]:
        """Return all time constraints of the block as graph edges.

        A behaviour takes at least `MIN_BEHAVIOUR_DURATION` unless its length is fixed.
        """
        edges = list(self.orders)
        for chain in self.chains:
            owner = chain.behaviour.id
            pairs = pairwise(chain.points)
            edges += [Edge(early, late, 0.0, owner) for early, late in pairs]
            first, last = chain.points[0], chain.points[-1]
            if self.potentials.find(first)[0] != self.potentials.find(last)[0]:
                edges.append(Edge(first, last, MIN_BEHAVIOUR_DURATION, owner))
        for distance in self.distances:
            edges.append(Edge(distance.early, distance.late, distance.gap, distance.owner))
            edges.append(Edge(distance.late, distance.early, -distance.gap, distance.owner))
        return edges

    def find_order_conflicts(self) -> list[list[Edge]]:
        """Return contradictions between a behaviour's sync point order and fixed time differences."""
        loops = []
        for chain in self.chains:
            last: dict[Point, tuple[Point, float]] = {}  # root -> last visited point of its set
            for point in chain.points:
                root, gap = self.potentials.find(point)
                before, before_gap = last.get(root, (point, gap))
                if gap < before_gap - TIME_TOLERANCE:
                    owner = chain.behaviour.id
                    back = Edge(point, before, before_gap - gap, owner)
                    loops.append([Edge(before, point, 0.0, owner), back])
                    break
                last[root] = (point, gap)
        return loops


@dataclass(frozen=True)
class Unresolved:
    """Reference to a missing sync point."""

    culprit: str | Synchronize | Precedence  # id of the behaviour, or the constraint
    kind: NoticeType
    reason: str
    sync: str = ""  # name of the sync attribute with the reference; empty: no attribute


class ReferenceResolver:
    """Resolver of a block's references among the active behaviours."""

    def __init__(
        self,
        block: Block,
        behaviours: Mapping[str, Behaviour],
        utterances: Mapping[str, Utterance],
        external_times: ExternalTimes,
        spans: Mapping[str, Mapping[str, float]],
    ) -> None:
        self._block, self._utterances, self._elsewhere, self._spans = block, utterances, external_times, spans
        self._start = Point(block.id, "bml", "start")
        self.chains = {behaviour.id: self._make_chain(behaviour) for behaviour in behaviours.values()}
        self.unresolved: list[Unresolved] = []

    def _make_chain(self, behaviour: Behaviour) -> SyncChain:
        names = list_sync_points(behaviour.action, self._block.dialect, self._spans.get(behaviour.id, ()))
        if isinstance(behaviour.action, Speech):
            offsets = find_speech_offsets(self._utterances[behaviour.id])
            names = tuple(sorted((name for name in names if name in offsets), key=lambda name: offsets[name]))
        return SyncChain(behaviour, tuple(Point(self._block.id, behaviour.id, name) for name in names))

    def build_network(self, equalities: list[Equality], constraints: list[Synchronize | Precedence]) -> Network:
        """Build the network of a block's time constraints.

        Unresolved references go to `unresolved`.

        Args:
            equalities: equalities of sync attributes.
            constraints: constraints of the block.
        """
        distances = [distance for chain in self.chains.values() for distance in self._find_speech_distances(chain)]
        orders: list[Edge] = []
        for equality in equalities:
            distances += self._find_distances(equality, equality.owner or "")
        for constraint in constraints:
            if isinstance(constraint, Synchronize):
                for equality in find_synchronize_equalities(constraint):
                    distances += self._find_distances(equality, constraint)
            else:
                orders += self._find_orders(constraint)
        used = {distance.early for distance in distances} | {edge.head for edge in orders}
        used |= {edge.tail for edge in orders}
        end = Point(self._block.id, "bml", "end")
        if end in used:
            orders += [Edge(chain.points[-1], end, 0.0) for chain in self.chains.values()]
        return Network(self._start, tuple(self.chains.values()), tuple(distances), tuple(orders))

    def _find_speech_distances(self, chain: SyncChain) -> Iterator[Distance]:
        if chain.is_rigid:
            owner, first = chain.behaviour.id, chain.points[0]
            offsets = find_speech_offsets(self._utterances[owner])
            for point in chain.points[1:]:
                yield Distance(point, first, offsets[point.sync], owner)

    def _find_distances(self, equality: Equality, culprit: str | Synchronize) -> Iterator[Distance]:
        left, right = (self._resolve_point(ref, culprit, equality.left.sync) for ref in (equality.left, equality.right))
        if left is not None and right is not None:
            yield Distance(left[0], right[0], right[1] - left[1], equality.owner)

    def _find_orders(self, order: Precedence) -> Iterator[Edge]:
        earlier = self._resolve_point(order.earlier, order)
        for ref in order.later:
            later = self._resolve_point(ref, order)
            if earlier is not None and later is not None:
                yield Edge(earlier[0], later[0], earlier[1] - later[1])

    def _resolve_point(
        self, ref: SyncRef, culprit: str | Synchronize | Precedence, sync: str = ""
    ) -> tuple[Point, float] | None:
        """Return the sync point and time offset [s] that a reference means.

        An unresolved reference is added to `unresolved` and gives None.
        """
        point = get_point(ref)
        if point.block != self._block.id:
            time = self._elsewhere.get(point)
            if time is not None:
                return self._start, time + ref.offset
            reason = f"{':'.join(point)} is unknown"
        elif point.behaviour == "bml":
            if point.sync in ("start", "end"):
                return point, ref.offset
            reason = f"the block has no sync point '{point.sync}', only start and end"
        else:
            chain = self.chains[point.behaviour]
            if point in chain.points:
                return point, ref.offset
            names = ", ".join(own_point.sync for own_point in chain.points)
            reason = f"{point.behaviour} has no sync point '{point.sync}', but {names}"
        self.unresolved.append(Unresolved(culprit, NoticeType.IMPOSSIBLE_TO_SCHEDULE, reason, sync))
        return None
