"""Hinge angles from joint positions in closed form, over all branches.

Depth-first over the chain, because a shoulder's branch can only be judged by what the elbow makes of it. One or two
hinges aim a bone by the subproblems of Paden and Kahan.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from kinesic.ik.arm.linkage import Link, Linkage, Pivot
from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.scalar3 import (
    IDENTITY_ROTATION,
    Rotation,
    Vector,
    after,
    distance,
    minus,
    plus,
    rotated,
    turned,
    unit,
    within,
)

MISS_COST = 1e3  # cost per arm length of a joint's distance from its point
TRAVEL_COST = 1e-3  # cost per radian of travel from the current angles


@dataclass(frozen=True)
class Extraction:
    """Hinge angles that put the joints near the given points."""

    angles: tuple[float, ...]  # [rad] angles of all hinges except those of the hand
    miss: float  # [m] sum of the distances of all joints from their points


class _Branch(NamedTuple):
    """Angles of the first links, in one of the possible combinations."""

    cost: float
    miss: float  # [m] sum of the distances of the first joints from their points
    frame: Rotation
    end: Vector  # [m]
    angles: tuple[float, ...]  # [rad]
    links: int


def extract(linkage: Linkage, points: Sequence[Vector], near: Sequence[float]) -> Extraction:
    """Return angles in range whose joints come nearest to given points.

    A hinge that is stopped leaves its bone off the point; the next bone is aimed from where the joint really is.

    Args:
        linkage: the arm.
        points: [m] in the base: ends of its first bones, from the base outward.
        near: [rad] angles to stay close to where there is a choice.

    Returns:
        The best of all branches; as many angles as the hinges of these bones.
    """
    size = sum(link.length for link in linkage.links[: len(points)])
    best = _Branch(inf, inf, IDENTITY_ROTATION, linkage.origin, (), 0)
    waiting = [_Branch(0.0, 0.0, IDENTITY_ROTATION, linkage.origin, (), 0)]
    while waiting:
        branch = waiting.pop()
        if branch.cost >= best.cost:
            continue
        if branch.links == len(points):
            best = branch
            continue
        link, point = linkage.links[branch.links], points[branch.links]
        grown = [_grow(branch, link, turns, point, near, size) for turns in _turns(branch, link, point, near)]
        waiting += sorted(grown, key=lambda child: -child.cost)
    return Extraction(best.angles, best.miss)


def _grow(
    branch: _Branch, link: Link, turns: tuple[float, ...], point: Vector, near: Sequence[float], size: float
) -> _Branch:
    frame, travel = branch.frame, 0.0
    for k, (pivot, turn) in enumerate(zip(link.pivots, turns, strict=True), link.first):
        frame = after(frame, pivot.axis, turn)
        travel += abs(turn - near[k])
    end = plus(branch.end, rotated(frame, link.bone))
    miss = distance(end, point)
    cost = branch.cost + MISS_COST * miss / size + TRAVEL_COST * travel
    return _Branch(cost, branch.miss + miss, frame, end, branch.angles + turns, branch.links + 1)


def _turns(branch: _Branch, link: Link, point: Vector, near: Sequence[float]) -> list[tuple[float, ...]]:
    """Return all angle pairs with which two hinges aim a bone."""
    now = tuple(near[link.first : link.first + len(link.pivots)])
    wanted = within(branch.frame, unit(minus(point, branch.end)))
    kept = now[:-2]
    for pivot, turn in zip(link.pivots, kept, strict=False):
        wanted = turned(wanted, pivot.axis, -turn)
    if not now:
        return [()]
    last = link.pivots[-1]
    if len(now) == 1:
        return [(_aimed(last, link.along, wanted, now[-1]),)]
    first = link.pivots[-2]
    ways = first_of_two(first.axis, last.axis, link.along, wanted) or (now[-2],)
    turns = []
    for way in ways:
        turn = first.bring_into_range(way, now[-2])
        aimed = _aimed(last, link.along, turned(wanted, first.axis, -turn), now[-1])
        turns.append((*kept, turn, aimed))
    return turns


def _aimed(pivot: Pivot, along: Vector, wanted: Vector, now: float) -> float:
    """Return the angle [rad] of the last hinge, clipped to its range."""
    turn = turn_towards(pivot.axis, along, wanted)
    return now if turn is None else pivot.bring_into_range(turn, now)
