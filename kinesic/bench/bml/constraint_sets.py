"""Time constraints of a block, grouped as by the reference parser.

Classes of equal times and orders.

Construction: OpenBMLParser (BML 1.0, 2.5). Equalities with a sync point in common are merged with their offsets; the
    start of the block alone merges nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from kinesic.bml.block import Block, Precedence
from kinesic.bml.timing.constraints import Equality, Point, find_equalities, get_point
from kinesic.bml.timing.network import Potentials

TimeClass = Mapping[Point, float]  # sync point -> offset [s]; time(point) + offset is equal for all points


@dataclass(frozen=True)
class OrderConstraint:
    """Time order of sync points: time(point) <= time(target) + offset."""

    point: Point
    targets: tuple[tuple[Point, float], ...]


@dataclass(frozen=True)
class Constraints:
    """Time constraints of a block: fixed offsets between sync points, and orders.

    Those from `required` parts of the block are also listed separately.
    """

    block: str
    classes: tuple[TimeClass, ...]
    required_classes: tuple[TimeClass, ...]
    afters: tuple[OrderConstraint, ...]
    required_afters: tuple[OrderConstraint, ...]

    def directly_linked(self, one: str, other: str) -> bool:
        """Return whether a constraint links two behaviours' sync points at fixed offsets."""
        return other in self._neighbours(one)

    def connected(self, one: str, other: str) -> bool:
        """Return whether a chain of constraints connects two behaviours."""
        return other in self._connected_behaviours(one)

    def directly_grounded(self, behaviour: str) -> bool:
        """Return whether a behaviour has a sync point with fixed block time."""
        return any(self._start in self.classes[index] for index in self._classes_of.get(behaviour, ()))

    def directly_after_grounded(self, behaviour: str) -> bool:
        """Return whether a constraint keeps the behaviour after a fixed block time."""
        targets = (target for after in self.afters if after.point == self._start for target, _ in after.targets)
        return any((target.block, target.behaviour) == (self.block, behaviour) for target in targets)

    def grounded(self, behaviour: str) -> bool:
        """Return whether constraints connect the behaviour to the block's start."""
        return any(self.directly_grounded(other) for other in self._connected_behaviours(behaviour))

    def ungrounded_loops(self, behaviour: str) -> list[list[str]]:
        """Return shortest loops of constraints through a behaviour, without grounded behaviours.

        A grounded behaviour has a fixed block time. A loop is a list of behaviours.
        """
        loops: dict[frozenset[str], list[str]] = {}
        for index in self._classes_of.get(behaviour, ()):
            for other in self._members[index]:
                if (
                    other != behaviour
                    and (path := self._find_shortest_path(other, behaviour, excluded_class=index)) is not None
                ):
                    loops.setdefault(frozenset(path), path)
        return list(loops.values())

    def referenced_blocks(self) -> frozenset[str]:
        """Return the ids of other blocks that this block refers to."""
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

    def _connected_behaviours(self, behaviour: str) -> set[str]:
        reached, fringe = {behaviour}, [behaviour]
        while fringe:
            new = self._neighbours(fringe.pop()) - reached
            reached |= new
            fringe += new
        return reached

    def _find_shortest_path(self, start: str, goal: str, *, excluded_class: int) -> list[str] | None:
        """Find the shortest constraint path that avoids grounded behaviours and a class.

        A class is a set of sync points at fixed offsets; a grounded behaviour has a sync point with fixed block time.

        Returns:
            Behaviours of the path without the goal; None if there is no path.
        """
        before: dict[str, str | None] = {start: None}
        fringe = [start]
        for behaviour in fringe:  # grows during the iteration: breadth-first search
            if self.directly_grounded(behaviour):
                continue
            for index in self._classes_of[behaviour]:
                for other in self._members[index] if index != excluded_class else ():
                    if other == goal:
                        return _trace_back(behaviour, before)
                    if other not in before:
                        before[other] = behaviour
                        fringe.append(other)
        return None


def _trace_back(behaviour: str, before: Mapping[str, str | None]) -> list[str]:
    path = []
    step: str | None = behaviour
    while step is not None:
        path.append(step)
        step = before[step]
    return path[::-1]


def collect_constraints(block: Block) -> Constraints:
    """Collect the time constraints of a block.

    Equalities that contradict earlier ones are left to the schedule.
    """
    all_ties = list(find_equalities(block))
    orders = [constraint for constraint in block.constraints if isinstance(constraint, Precedence)]
    return Constraints(
        block=block.id,
        classes=_classes(block.id, all_ties),
        required_classes=_classes(block.id, [equality for equality in all_ties if equality.required]),
        afters=_afters(orders),
        required_afters=_afters([order for order in orders if order.required]),
    )


def _classes(block: str, all_ties: list[Equality]) -> tuple[TimeClass, ...]:
    potentials = Potentials()
    start = Point(block, "bml", "start")
    absolute: list[tuple[Point, float]] = []  # points with absolute block times
    for equality in all_ties:
        left, right = get_point(equality.left), get_point(equality.right)
        gap = equality.right.offset - equality.left.offset
        if right == start:
            potentials.find(left)
            absolute.append((left, gap))
        else:
            potentials.join(left, right, gap)
    classes = [{point: 0.0 - gap for point, gap in group.items()} for group in potentials.list_sets()]
    for point, time in absolute:
        for group in classes:
            if point in group:
                group.setdefault(start, group[point] + time)
    return tuple(classes)


def _afters(orders: list[Precedence]) -> tuple[OrderConstraint, ...]:
    targets: dict[Point, list[tuple[Point, float]]] = {}
    for order in orders:
        later = targets.setdefault(get_point(order.earlier), [])
        later += [(get_point(ref), ref.offset - order.earlier.offset) for ref in order.later]
    return tuple(OrderConstraint(point, tuple(later)) for point, later in targets.items())
