"""What BML ties between behaviours, kept when sync points must move."""

from collections.abc import Iterator

from kinesic.bml.block import Precedence, SyncRef, Timeline
from kinesic.bml.timing.constraints import point_of, ties
from kinesic.motion.keys import Bond, Sync


def bonds(timeline: Timeline) -> tuple[Bond, ...]:
    """The bonds between different behaviours of a block: both ways for points that coincide, one for an order.

    What a behaviour asks of its own points is no bond: its own time gives way.
    """
    block = timeline.block
    known = {(timed.behaviour.id, sync): time for timed in timeline.timed for sync, time in timed.times.items()}
    found = [bond for tie in ties(block) for bond in _coincide(tie.left, tie.right)]
    for constraint in block.constraints:
        if isinstance(constraint, Precedence):
            found += [_after(constraint.earlier, later) for later in constraint.later]
    return tuple(
        bond
        for bond in dict.fromkeys(found)
        if bond.earlier in known and bond.later in known and bond.earlier[0] != bond.later[0]
    )


def _coincide(one: SyncRef, other: SyncRef) -> Iterator[Bond]:
    yield _after(one, other)
    yield _after(other, one)


def _after(earlier: SyncRef, later: SyncRef) -> Bond:
    """time(earlier) + its offset <= time(later) + its offset."""
    return Bond(_sync(earlier), _sync(later), earlier.offset - later.offset)


def _sync(ref: SyncRef) -> Sync:
    point = point_of(ref)
    return point.behaviour, point.sync
