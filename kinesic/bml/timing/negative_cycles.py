"""Finds contradictory time constraints: loops of edges whose least gaps add up to more than zero.

Bellman and Ford's longest paths, with Yen's alternating sweeps; a loop shows in the graph of predecessors.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from kinesic.bml.timing.constraints import Point

EQUAL = 1e-9  # [s] times closer than this are the same


@dataclass(frozen=True)
class Edge:
    """time(head) - time(tail) is at least gap."""

    tail: Point
    head: Point
    gap: float  # [s]
    owner: str | None = None  # behaviour that asks for it; None: a constraint


def contradictions(edges: Sequence[Edge]) -> list[list[Edge]]:
    """Finds loops that cannot hold; none: all edges hold together.

    Not every contradiction is found at once, but at least one when there is one.
    """
    points = {point for edge in edges for point in (edge.tail, edge.head)}
    times = dict.fromkeys(points, 0.0)
    via: dict[Point, Edge] = {}
    for sweep in range(len(points) + 1):
        changed = False
        for edge in edges if sweep % 2 == 0 else reversed(edges):
            earliest = times[edge.tail] + edge.gap
            if earliest > times[edge.head] + EQUAL:
                times[edge.head] = earliest
                via[edge.head] = edge
                changed = True
        if not changed:
            return []
        if found := _loops(via):
            return found
    return []


def _loops(via: dict[Point, Edge]) -> list[list[Edge]]:
    """Loops in a graph where each point has at most one predecessor."""
    loops: list[list[Edge]] = []
    walk_of: dict[Point, Point] = {}  # point -> where the walk started that reached it first
    for start in via:
        point = start
        while point in via and point not in walk_of:
            walk_of[point] = start
            point = via[point].tail
        if walk_of.get(point) == start and point in via:
            loops.append(_around(point, via))
    return loops


def _around(point: Point, via: dict[Point, Edge]) -> list[Edge]:
    loop = [via[point]]
    while loop[-1].tail != point:
        loop.append(via[loop[-1].tail])
    return loop[::-1]
