"""Equality constraints between sync points, as given by a block's references."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from kinesic.bml.block import Behaviour, Block, Face, Place, Precedence, Synchronize, SyncRef


class Point(NamedTuple):
    """Sync point of a behaviour.

    The behaviour `bml` is the block itself; a repeated stroke is `stroke:2`.
    """

    block: str
    behaviour: str
    sync: str


@dataclass(frozen=True)
class Equality:
    """Equality constraint: time(left) + left.offset = time(right) + right.offset."""

    left: SyncRef
    right: SyncRef
    owner: str | None  # id of the behaviour with the sync attribute; None: a constraint of the block
    place: Place
    required: bool


def get_point(ref: SyncRef) -> Point:
    """Return the sync point of a reference, without its offset."""
    return Point(ref.block, ref.behaviour, ref.sync if ref.iteration in (None, 1) else f"{ref.sync}:{ref.iteration}")


def find_equalities(block: Block) -> Iterator[Equality]:
    """Yield the equality constraints of a block's sync attributes and <synchronize> elements."""
    for behaviour in block.behaviours:
        yield from find_attribute_equalities(behaviour, block.id)
    for constraint in block.constraints:
        if isinstance(constraint, Synchronize):
            yield from find_synchronize_equalities(constraint)


def find_attribute_equalities(behaviour: Behaviour, block: str) -> Iterator[Equality]:
    """Yield the equality constraints of a behaviour's sync attributes."""
    for sync, ref in behaviour.syncs.items():
        own_ref = SyncRef(block, behaviour.id, sync)
        yield Equality(own_ref, ref, behaviour.id, behaviour.place, behaviour.required)


def find_relax_equalities(
    behaviour: Behaviour, block: str, constrained_points: Collection[Point]
) -> Iterator[Equality]:
    """Yield relax = strokeEnd for a face with strokeEnd but unconstrained relax.

    Args:
        behaviour: behaviour of the block.
        block: id of the block.
        constrained_points: points in constraints of the block.
    """
    stroke_end = behaviour.syncs.get("strokeEnd")
    is_relax_placed = "relax" in behaviour.syncs or Point(block, behaviour.id, "relax") in constrained_points
    if isinstance(behaviour.action, Face) and stroke_end is not None and not is_relax_placed:
        yield Equality(
            SyncRef(block, behaviour.id, "relax"), stroke_end, behaviour.id, behaviour.place, behaviour.required
        )


def find_synchronize_equalities(constraint: Synchronize) -> Iterator[Equality]:
    """Yield equalities between a <synchronize>'s first movable point and its other points."""
    moving = (ref for ref in constraint.refs if (ref.behaviour, ref.sync) != ("bml", "start"))
    first = next(moving, None)
    for ref in constraint.refs:
        if first is not None and ref is not first:
            yield Equality(first, ref, None, constraint.place, constraint.required)


def find_constrained_points(block: Block) -> Mapping[str, frozenset[str]]:
    """Return the constrained sync points of each behaviour.

    Others have natural times.
    """
    refs = [ref for equality in find_equalities(block) for ref in (equality.left, equality.right)]
    for order in block.constraints:
        if isinstance(order, Precedence):
            refs += [order.earlier, *order.later]
    points_by_behaviour: dict[str, set[str]] = {behaviour.id: set() for behaviour in block.behaviours}
    for point in map(get_point, refs):
        if point.block == block.id and point.behaviour in points_by_behaviour:
            points_by_behaviour[point.behaviour].add(point.sync)
    return {id: frozenset(syncs) for id, syncs in points_by_behaviour.items()}
