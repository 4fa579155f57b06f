"""Points in time whose distances are known: union-find with offsets (Tarjan's disjoint sets with potentials)."""

from collections.abc import Hashable, Iterator
from typing import Generic, TypeVar

P = TypeVar("P", bound=Hashable)


class Potentials(Generic[P]):
    """Classes of points; within a class, time(point) = time(root) + gap(point)."""

    def __init__(self) -> None:
        self._above: dict[P, tuple[P, float]] = {}

    def find(self, point: P) -> tuple[P, float]:
        """Root of a point's class, and the point's gap to it [s]; an unknown point starts a class."""
        path: list[P] = []
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

    def join(self, late: P, early: P, gap: float) -> None:
        """Adds time(late) = time(early) + gap; without effect when both are in one class already."""
        late_root, late_gap = self.find(late)
        early_root, early_gap = self.find(early)
        if late_root != early_root:
            self._above[late_root] = (early_root, early_gap + gap - late_gap)

    def classes(self) -> Iterator[dict[P, float]]:
        """Every class, as gaps to its root, in the order in which its points came."""
        members: dict[P, dict[P, float]] = {}
        for point in list(self._above):
            root, gap = self.find(point)
            members.setdefault(root, {})[point] = gap
        yield from members.values()
