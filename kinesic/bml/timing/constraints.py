"""What the references of a block say, before any number is chosen: which sync points are at equal times."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from kinesic.bml.block import Behaviour, Block, Face, Place, Precedence, Synchronize, SyncRef


class Point(NamedTuple):
    """A sync point; behaviour `bml` is the block itself, a repeated stroke is `stroke:2`."""

    block: str
    behaviour: str
    sync: str


@dataclass(frozen=True)
class Tie:
    """time(left) + left.offset = time(right) + right.offset."""

    left: SyncRef
    right: SyncRef
    owner: str | None  # behaviour whose attribute says so; None: a constraint
    place: Place
    required: bool


def point_of(ref: SyncRef) -> Point:
    """Finds the sync point of a reference, without its offset."""
    return Point(ref.block, ref.behaviour, ref.sync if ref.iteration in (None, 1) else f"{ref.sync}:{ref.iteration}")


def ties(block: Block) -> Iterator[Tie]:
    """Yields all equalities that a block asks for, in document order."""
    for behaviour in block.behaviours:
        yield from own_ties(behaviour, block.id)
    for constraint in block.constraints:
        if isinstance(constraint, Synchronize):
            yield from synchronize_equalities(constraint)


def own_ties(behaviour: Behaviour, block: str) -> Iterator[Tie]:
    """Yields the equalities that the sync attributes of a behaviour ask for."""
    for sync, ref in behaviour.syncs.items():
        own = SyncRef(block, behaviour.id, sync)
        yield Tie(own, ref, behaviour.id, behaviour.place, behaviour.required)


def relaxing_ties(behaviour: Behaviour, block: str, named: Collection[Point]) -> Iterator[Tie]:
    """Lets an expression of the face relax where its stroke is to end, unless the document places that otherwise.

    Args:
        behaviour: of the block.
        block: its id.
        named: points that constraints of the block name.
    """
    ended = behaviour.syncs.get("strokeEnd")
    placed = "relax" in behaviour.syncs or Point(block, behaviour.id, "relax") in named
    if isinstance(behaviour.action, Face) and ended is not None and not placed:
        yield Tie(SyncRef(block, behaviour.id, "relax"), ended, behaviour.id, behaviour.place, behaviour.required)


def synchronize_equalities(constraint: Synchronize) -> Iterator[Tie]:
    """Yields the equalities of a <synchronize>, all with its first point that moves."""
    moving = (ref for ref in constraint.refs if (ref.behaviour, ref.sync) != ("bml", "start"))
    first = next(moving, None)
    for ref in constraint.refs:
        if first is not None and ref is not first:
            yield Tie(first, ref, None, constraint.place, constraint.required)


def placed_points(block: Block) -> Mapping[str, frozenset[str]]:
    """Finds each behaviour's sync points that the document's constraints name; the others have natural times."""
    refs = [ref for tie in ties(block) for ref in (tie.left, tie.right)]
    for order in block.constraints:
        if isinstance(order, Precedence):
            refs += [order.earlier, *order.later]
    found: dict[str, set[str]] = {behaviour.id: set() for behaviour in block.behaviours}
    for point in map(point_of, refs):
        if point.block == block.id and point.behaviour in found:
            found[point.behaviour].add(point.sync)
    return {id: frozenset(syncs) for id, syncs in found.items()}
