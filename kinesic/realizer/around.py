"""What plays and what waits, as a block that is asked meanwhile has to know it; plain data."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from kinesic.bml.block import Behaviour, Block, Order, Synchronize, SyncRef
from kinesic.bml.composition import State, awaited
from kinesic.bml.timing.constraints import Point, point_of

LEAD = 0.15  # [s] from the asking to the beginning of a block that refers to others: time to plan it


@dataclass(frozen=True)
class Around:
    """Other blocks, in global time [s]."""

    now: float = 0.0
    states: Mapping[str, State] = field(
        default_factory=dict
    )  # of blocks that are not over, in the order of their coming
    relaxes: Mapping[str, float] = field(default_factory=dict)  # id -> when it will have subsided
    ends: Mapping[str, float] = field(default_factory=dict)  # id -> when it will be over
    times: Mapping[Point, float] = field(default_factory=dict)  # sync points, of blocks that are over too

    def begin(self, block: Block) -> float:
        """When a block will begin, as far as one can tell before it is planned."""
        turns = [
            (self.relaxes if until == "relax" else self.ends).get(id, self.now)
            for id, until in awaited(block, self.states).items()
        ]
        return max([self.now + (LEAD if refers_elsewhere(block) else 0.0), *turns])

    def free(self, name: str) -> str:
        """A block's id that is not in use: the name, or the name with a number."""
        count, found = 1, name
        while found in self.states:
            count += 1
            found = f"{name}.{count}"
        return found


def refers_elsewhere(block: Block) -> bool:
    """Whether a block refers to sync points of others."""
    return any(ref.block != block.id for ref in _refs(block))


def anchored(block: Block, around: Around, zero: float) -> Block:
    """The block with references to other blocks turned into times of its own; unknown ones stay.

    Args:
        block: as written.
        around: what plays.
        zero: [s] global time of the block's time 0.
    """

    def own(ref: SyncRef) -> SyncRef:
        time = around.times.get(point_of(ref)) if ref.block != block.id else None
        return ref if time is None else SyncRef(block.id, "bml", "start", offset=time - zero + ref.offset)

    def behaviour(one: Behaviour) -> Behaviour:
        return replace(one, syncs={sync: own(ref) for sync, ref in one.syncs.items()})

    def constraint(one: Synchronize | Order) -> Synchronize | Order:
        if isinstance(one, Synchronize):
            return replace(one, refs=tuple(map(own, one.refs)))
        return replace(one, earlier=own(one.earlier), later=tuple(map(own, one.later)))

    if not refers_elsewhere(block):
        return block
    return replace(
        block, behaviours=tuple(map(behaviour, block.behaviours)), constraints=tuple(map(constraint, block.constraints))
    )


def _refs(block: Block) -> list[SyncRef]:
    refs = [ref for behaviour in block.behaviours for ref in behaviour.syncs.values()]
    for one in block.constraints:
        refs += one.refs if isinstance(one, Synchronize) else (one.earlier, *one.later)
    return refs
