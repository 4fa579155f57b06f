"""Detection of contradicting time constraints: cycles with positive total gap.

Longest paths by Bellman-Ford with Yen's alternating sweeps; a cycle appears in the graph of predecessors.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from kinesic.bml.timing.constraints import Point

TIME_TOLERANCE = 1e-9  # [s] difference below which times count as equal


@dataclass(frozen=True)
class Edge:
    """Constraint time(head) - time(tail) >= gap between two sync points."""

    tail: Point
    head: Point
    gap: float  # [s] smallest time from tail to head
    owner: str | None = None  # id of the behaviour that requests the edge; None: a constraint of the block


def find_contradictions(edges: Sequence[Edge]) -> list[list[Edge]]:
    """Return cycles of edges that cannot hold together.

    Empty if all edges can. If there are contradictions, at least one of them is returned.
    """
    points = {point for edge in edges for point in (edge.tail, edge.head)}
    times = dict.fromkeys(points, 0.0)
    predecessor: dict[Point, Edge] = {}
    for sweep in range(len(points) + 1):
        changed = False
        for edge in edges if sweep % 2 == 0 else reversed(edges):
            earliest = times[edge.tail] + edge.gap
            if earliest > times[edge.head] + TIME_TOLERANCE:
                times[edge.head] = earliest
                predecessor[edge.head] = edge
                changed = True
        if not changed:
            return []
        if cycles := _find_cycles(predecessor):
            return cycles
    return []


def _find_cycles(predecessor: dict[Point, Edge]) -> list[list[Edge]]:
    """Return all cycles of a graph whose points have one predecessor each."""
    cycles: list[list[Edge]] = []
    walk_starts: dict[Point, Point] = {}  # point -> start of the first walk that reached it
    for start in predecessor:
        point = start
        while point in predecessor and point not in walk_starts:
            walk_starts[point] = start
            point = predecessor[point].tail
        if walk_starts.get(point) == start and point in predecessor:
            cycles.append(_trace_cycle(point, predecessor))
    return cycles


def _trace_cycle(point: Point, predecessor: dict[Point, Edge]) -> list[Edge]:
    cycle = [predecessor[point]]
    while cycle[-1].tail != point:
        cycle.append(predecessor[cycle[-1].tail])
    return cycle[::-1]
