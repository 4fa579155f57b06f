"""What a block asks for in the form of the reference parser: classes of equal times, and orders.

Construction: OpenBMLParser (facts: BML 1.0, 2.5). Equalities are united over shared points of behaviours, with their
offsets; the start of the block alone unites nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from kinesic.bml.block import Block, Precedence
from kinesic.bml.timing.constraints import Point, Tie, point_of, ties
from kinesic.bml.timing.network import Potentials

Equals = Mapping[Point, float]  # time(point) + offset is one time for all


@dataclass(frozen=True)
class After:
    """time(point) is at most time(target) + offset, for each target."""

    point: Point
    targets: tuple[tuple[Point, float], ...]


@dataclass(frozen=True)
class Constraints:
    """Classes and orders of a block, those from `required` parts apart as well."""

    block: str
    classes: tuple[Equals, ...]
    required_classes: tuple[Equals, ...]
    afters: tuple[After, ...]
    required_afters: tuple[After, ...]

    def directly_linked(self, one: str, other: str) -> bool:
        """Whether two behaviours share a class."""
        return other in self._neighbours(one)

    def connected(self, one: str, other: str) -> bool:
        """Whether a chain of classes leads from one behaviour to the other."""
        return other in self._reached(one)

    def directly_grounded(self, behaviour: str) -> bool:
        """Whether a class of the behaviour contains the start of the block."""
        return any(self._start in self.classes[index] for index in self._classes_of.get(behaviour, ()))

    def directly_after_grounded(self, behaviour: str) -> bool:
        """Whether the behaviour must come after a time of the block."""
        targets = (target for after in self.afters if after.point == self._start for target, _ in after.targets)
        return any((target.block, target.behaviour) == (self.block, behaviour) for target in targets)

    def grounded(self, behaviour: str) -> bool:
        """Whether the behaviour is connected to one that is directly grounded."""
        return any(self.directly_grounded(other) for other in self._reached(behaviour))

    def ungrounded_loops(self, behaviour: str) -> list[list[str]]:
        """Shortest ways from a behaviour over several classes back to it, where no other behaviour is grounded."""
        found: dict[frozenset[str], list[str]] = {}
        for index in self._classes_of.get(behaviour, ()):
            for other in self._members[index]:
                if other != behaviour and (way := self._way(other, behaviour, without=index)) is not None:
                    found.setdefault(frozenset(way), way)
        return list(found.values())

    def blocks(self) -> frozenset[str]:
        """Other blocks that are referred to."""
        points = [point for group in self.classes for point in group]
        points += [point for after in self.afters for point in (after.point, *(target for target, _ in after.targets))]
        return frozenset(point.block for point in points) - {self.block}

    @property
    def _start(self) -> Point:
        return Point(self.block, "bml", "start")

    @cached_property
    def _members(self) -> list[list[str]]:
        return [
            list(dict.fromkeys(p.behaviour for p in group if p.block == self.block and p.behaviour != "bml"))
            for group in self.classes
        ]

    @cached_property
    def _classes_of(self) -> dict[str, list[int]]:
        of: dict[str, list[int]] = {}
        for index, behaviours in enumerate(self._members):
            for behaviour in behaviours:
                of.setdefault(behaviour, []).append(index)
        return of

    def _neighbours(self, behaviour: str) -> set[str]:
        return {other for index in self._classes_of.get(behaviour, ()) for other in self._members[index]}

    def _reached(self, behaviour: str) -> set[str]:
        reached, fringe = {behaviour}, [behaviour]
        while fringe:
            new = self._neighbours(fringe.pop()) - reached
            reached |= new
            fringe += new
        return reached

    def _way(self, start: str, goal: str, *, without: int) -> list[str] | None:
        """Behaviours on a shortest way that avoids a class and grounded behaviours, the goal left out."""
        before: dict[str, str | None] = {start: None}
        fringe = [start]
        for behaviour in fringe:  # grows while it is walked: breadth first
            if self.directly_grounded(behaviour):
                continue
            for index in self._classes_of[behaviour]:
                for other in self._members[index] if index != without else ():
                    if other == goal:
                        return _back(behaviour, before)
                    if other not in before:
                        before[other] = behaviour
                        fringe.append(other)
        return None


def _back(behaviour: str, before: Mapping[str, str | None]) -> list[str]:
    way = []
    step: str | None = behaviour
    while step is not None:
        way.append(step)
        step = before[step]
    return way[::-1]


def constraints_of(block: Block) -> Constraints:
    """Collects what a block asks for. Equalities that contradict earlier ones are left to the schedule."""
    every = list(ties(block))
    orders = [constraint for constraint in block.constraints if isinstance(constraint, Precedence)]
    return Constraints(
        block=block.id,
        classes=_classes(block.id, every),
        required_classes=_classes(block.id, [tie for tie in every if tie.required]),
        afters=_afters(orders),
        required_afters=_afters([order for order in orders if order.required]),
    )


def _classes(block: str, every: list[Tie]) -> tuple[Equals, ...]:
    potentials = Potentials()
    start = Point(block, "bml", "start")
    absolute: list[tuple[Point, float]] = []  # (point, its time)
    for tie in every:
        left, right = point_of(tie.left), point_of(tie.right)
        gap = tie.right.offset - tie.left.offset
        if right == start:
            potentials.find(left)
            absolute.append((left, gap))
        else:
            potentials.join(left, right, gap)
    classes = [{point: 0.0 - gap for point, gap in group.items()} for group in potentials.classes()]
    for point, time in absolute:
        for group in classes:
            if point in group:
                group.setdefault(start, group[point] + time)
    return tuple(classes)


def _afters(orders: list[Precedence]) -> tuple[After, ...]:
    targets: dict[Point, list[tuple[Point, float]]] = {}
    for order in orders:
        later = targets.setdefault(point_of(order.earlier), [])
        later += [(point_of(ref), ref.offset - order.earlier.offset) for ref in order.later]
    return tuple(After(point, tuple(later)) for point, later in targets.items())
