"""A block's sync points as a network of time constraints: equalities, orders and fixed distances."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from kinesic.bml.block import Behaviour, Block, NoticeType, Precedence, Speech, Synchronize, SyncRef
from kinesic.bml.timing.constraints import Point, Tie, point_of, synchronize_equalities
from kinesic.bml.timing.negative_cycles import EQUAL, Edge
from kinesic.bml.timing.points import speech_offsets, sync_points
from kinesic.body.utterance import Utterance

SHORTEST_BEHAVIOUR = 1e-6  # [s] of a behaviour whose length is not asked for

Elsewhere = Mapping[tuple[str, str, str], float]


class Potentials:
    """Disjoint sets of points whose distances are known (Tarjan); in each, time(point) = time(root) + gap(point)."""

    def __init__(self) -> None:
        self._above: dict[Point, tuple[Point, float]] = {}

    def find(self, point: Point) -> tuple[Point, float]:
        """Finds the root of a point's class, and its gap to it [s]; an unknown point starts a class."""
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
        """Adds time(late) = time(early) + gap; without effect when both are in one class already."""
        late_root, late_gap = self.find(late)
        early_root, early_gap = self.find(early)
        if late_root != early_root:
            self._above[late_root] = (early_root, early_gap + gap - late_gap)

    def classes(self) -> Iterator[dict[Point, float]]:
        """Yields every class, as gaps to its root, in the order in which its points came."""
        members: dict[Point, dict[Point, float]] = {}
        for point in list(self._above):
            root, gap = self.find(point)
            members.setdefault(root, {})[point] = gap
        yield from members.values()


@dataclass(frozen=True)
class Distance:
    """time(late) = time(early) + gap."""

    late: Point
    early: Point
    gap: float  # [s]
    owner: str | None  # behaviour that asks for it; None: a constraint


@dataclass(frozen=True)
class SyncChain:
    """A behaviour's sync points in order."""

    behaviour: Behaviour
    points: tuple[Point, ...]

    @property
    def is_rigid(self) -> bool:
        """Whether all its distances are fixed."""
        return isinstance(self.behaviour.action, Speech)


@dataclass(frozen=True)
class Network:
    """Chains, equalities and orders; `start` is the block's own, time 0."""

    start: Point
    chains: tuple[SyncChain, ...]
    distances: tuple[Distance, ...]
    orders: tuple[Edge, ...]

    @cached_property
    def potentials(self) -> Potentials:
        """Classes of equal times; of contradictory distances the first counts."""
        potentials = Potentials()
        for distance in self.distances:
            potentials.join(distance.late, distance.early, distance.gap)
        return potentials

    def edges(self) -> list[Edge]:
        """All that must hold, as edges; a behaviour takes at least `SHORTEST_BEHAVIOUR` unless its length is fixed."""
        edges = list(self.orders)
        for chain in self.chains:
            owner = chain.behaviour.id
            pairs = pairwise(chain.points)
            edges += [Edge(early, late, 0.0, owner) for early, late in pairs]
            first, last = chain.points[0], chain.points[-1]
            if self.potentials.find(first)[0] != self.potentials.find(last)[0]:
                edges.append(Edge(first, last, SHORTEST_BEHAVIOUR, owner))
        for distance in self.distances:
            edges.append(Edge(distance.early, distance.late, distance.gap, distance.owner))
            edges.append(Edge(distance.late, distance.early, -distance.gap, distance.owner))
        return edges

    def clashes(self) -> list[list[Edge]]:
        """Loops inside behaviours whose sync points are tied in the wrong order: the direct contradictions."""
        loops = []
        for chain in self.chains:
            last: dict[Point, tuple[Point, float]] = {}  # root -> the latest point of its class so far
            for point in chain.points:
                root, gap = self.potentials.find(point)
                before, before_gap = last.get(root, (point, gap))
                if gap < before_gap - EQUAL:
                    owner = chain.behaviour.id
                    back = Edge(point, before, before_gap - gap, owner)
                    loops.append([Edge(before, point, 0.0, owner), back])
                    break
                last[root] = (point, gap)
        return loops


@dataclass(frozen=True)
class Unresolved:
    """A reference that leads nowhere."""

    culprit: str | Synchronize | Precedence  # the behaviour's id, or the constraint
    kind: NoticeType
    why: str
    sync: str = ""  # the behaviour's own point whose attribute it is


class ReferenceResolver:
    """Resolves references of a block among behaviours that are still performed."""

    def __init__(
        self,
        block: Block,
        behaviours: Mapping[str, Behaviour],
        utterances: Mapping[str, Utterance],
        known: Elsewhere,
        spans: Mapping[str, Mapping[str, float]],
    ) -> None:
        self._block, self._utterances, self._elsewhere, self._spans = block, utterances, known, spans
        self._start = Point(block.id, "bml", "start")
        self.chains = {behaviour.id: self._chain(behaviour) for behaviour in behaviours.values()}
        self.unresolved: list[Unresolved] = []

    def _chain(self, behaviour: Behaviour) -> SyncChain:
        names = sync_points(behaviour.action, self._block.dialect, self._spans.get(behaviour.id, ()))
        if isinstance(behaviour.action, Speech):
            offsets = speech_offsets(self._utterances[behaviour.id])
            names = tuple(sorted((name for name in names if name in offsets), key=lambda name: offsets[name]))
        return SyncChain(behaviour, tuple(Point(self._block.id, behaviour.id, name) for name in names))

    def network(self, ties: list[Tie], constraints: list[Synchronize | Precedence]) -> Network:
        """Builds the network; what cannot be resolved is left out, and listed in `unresolved`.

        Args:
            ties: those of behaviours' attributes.
            constraints: of the block.
        """
        distances = [distance for chain in self.chains.values() for distance in self._speech(chain)]
        orders: list[Edge] = []
        for tie in ties:
            distances += self._distances(tie, tie.owner or "")
        for constraint in constraints:
            if isinstance(constraint, Synchronize):
                for tie in synchronize_equalities(constraint):
                    distances += self._distances(tie, constraint)
            else:
                orders += self._orders(constraint)
        used = {distance.early for distance in distances} | {edge.head for edge in orders}
        used |= {edge.tail for edge in orders}
        end = Point(self._block.id, "bml", "end")
        if end in used:
            orders += [Edge(chain.points[-1], end, 0.0) for chain in self.chains.values()]
        return Network(self._start, tuple(self.chains.values()), tuple(distances), tuple(orders))

    def _speech(self, chain: SyncChain) -> Iterator[Distance]:
        if chain.is_rigid:
            owner, first = chain.behaviour.id, chain.points[0]
            offsets = speech_offsets(self._utterances[owner])
            for point in chain.points[1:]:
                yield Distance(point, first, offsets[point.sync], owner)

    def _distances(self, tie: Tie, culprit: str | Synchronize) -> Iterator[Distance]:
        left, right = (self._point(ref, culprit, tie.left.sync) for ref in (tie.left, tie.right))
        if left is not None and right is not None:
            yield Distance(left[0], right[0], right[1] - left[1], tie.owner)

    def _orders(self, order: Precedence) -> Iterator[Edge]:
        earlier = self._point(order.earlier, order)
        for ref in order.later:
            later = self._point(ref, order)
            if earlier is not None and later is not None:
                yield Edge(earlier[0], later[0], earlier[1] - later[1])

    def _point(
        self, ref: SyncRef, culprit: str | Synchronize | Precedence, sync: str = ""
    ) -> tuple[Point, float] | None:
        """Point of a reference and the offset to it; None and an entry in `unresolved` when there is none."""
        point = point_of(ref)
        if point.block != self._block.id:
            time = self._elsewhere.get(point)
            if time is not None:
                return self._start, time + ref.offset
            why = f"{':'.join(point)} is not known here"
        elif point.behaviour == "bml":
            if point.sync in ("start", "end"):
                return point, ref.offset
            why = f"the block has no sync point '{point.sync}', only start and end"
        else:
            chain = self.chains[point.behaviour]
            if point in chain.points:
                return point, ref.offset
            known = ", ".join(own.sync for own in chain.points)
            why = f"{point.behaviour} has no sync point '{point.sync}', but {known}"
        self.unresolved.append(Unresolved(culprit, NoticeType.IMPOSSIBLE_TO_SCHEDULE, why, sync))
        return None
