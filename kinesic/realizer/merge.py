"""Lays the motion of a block over a running one, or puts it in its place, under all limits and clear of the body.

Movements of the trunk add up: a nod goes over a gaze, and the lean of one hand's reach over that of the other. A hand
does one work after the other: it leaves a hold or a retraction for what comes, and a work that meets another one of
the same hand, or one gaze another gaze, is left out by name.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.body.arrays import Floats, sealed
from kinesic.motion.trajectory import EARLY, STEP, Trajectory
from kinesic.motion.transition import LEAST, delay_controls, knot_at, lengthen, roomy, shorten
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.realizer.conflicts import find_conflict
from kinesic.realizer.occupancy import MergeFailure, Occupancy, Overlay, occupancy_of, still_occupied
from kinesic.realizer.overlay import overlay
from kinesic.realizer.release import release_motion

WAITS = (0, 10, 20, 40)  # knots from one attempt to the next
MOST_LATER = 60  # knots by which a block may come later


@dataclass(frozen=True, eq=False)
class MergedMotion:
    """A block among what runs."""

    trajectory: Trajectory  # from the running motion's start on, the same before the cut
    zero: float  # [s] of the block's zero
    layer: Trajectory  # what the block adds to the running motion, from the same start on
    busy: tuple[Occupancy, ...]  # its behaviours that move
    syncs: tuple[SyncTime, ...]  # as performed, in block time; of dropped behaviours none
    dropped: tuple[str, ...]  # behaviours that are left out
    notices: tuple[Notice, ...]

    def since(self, time: float) -> "MergedMotion":
        """The same without what both motions did before a time [s]."""
        return replace(self, trajectory=self.trajectory.since(time), layer=self.layer.since(time))


def merge(
    running: Trajectory, time: float, coming: Plan, *, begin: float, busy: Sequence[Occupancy] = ()
) -> MergedMotion:
    """Lays a block over a running motion.

    A silent block in which something has no place comes later by up to `MOST_LATER` where it then has; else, and in
    a block that speaks, what has none is left out.

    Args:
        running: the motion, within the limits and clear of the body.
        time: [s] from which it may change, at the next knot.
        coming: the block.
        begin: [s] at which the block's zero is wished.
        busy: what the running motion does.
    """
    return _laid_over(running, time, coming, begin, busy, waits=not coming.utterances)


def replace_motion(running: Trajectory, time: float, coming: Plan, *, begin: float | None = None) -> MergedMotion:
    """Puts a block in the place of all that runs: from how the body moves at the cut, over into the block.

    What the block does not move comes to rest. The block comes later where it has no way else.

    Args:
        running: the motion, within the limits and clear of the body.
        time: [s] from which it may be left, at the next knot.
        coming: the block.
        begin: [s] at which the block's zero is wished; at once by default.
    """
    every = np.ones(len(coming.setup.limits.lower), dtype=np.bool_)
    leaving = release_motion(running, time, every, coming.setup)
    wished = time + coming.trajectory.zero if begin is None else begin
    return _laid_over(leaving, time, coming, wished, (), waits=True)


def _laid_over(
    running: Trajectory, time: float, coming: Plan, begin: float, busy: Sequence[Occupancy], *, waits: bool
) -> MergedMotion:
    """A block over what runs, later where it may wait and then has a place for everything."""
    knot, wished = knot_at(time - running.start), begin - running.start
    soonest = max(ceil((wished - coming.trajectory.zero) / STEP - EARLY), knot)
    own = occupancy_of(coming)
    others = still_occupied([each.later(-running.start) for each in busy], knot * STEP)
    first = found = _tried(running, coming, knot, soonest, own, others)
    if first.gone and waits:
        tries = (
            _tried(running, coming, knot, soonest + more, own, others, whole=True) for more in _later(first, others)
        )
        found = next((each for each in tries if not each.gone), first)
    return _told(running, found, coming, wished)


@dataclass(frozen=True, eq=False)
class _Tried:
    """A block at one time."""

    offset: int  # knot at which its own motion begins
    every: Sequence[Occupancy]  # of the block
    base: Floats  # (k + 3, n) [rad] control points of what ran
    controls: Floats  # (k + 3, n) [rad] of both
    performed: Sequence[Occupancy]
    gone: Mapping[str, str]  # what is left out, and why


def _later(first: _Tried, others: Sequence[Occupancy]) -> list[int]:
    """By how many knots a block may come later, so that nothing it needs is busy: that, and a little more."""
    lacking = [
        other.relax - each.ready for each in first.every for other in others if each.meets(other) and not other.stays
    ]
    least = ceil(max(lacking, default=0.0) / STEP - EARLY)
    return [least + more for more in WAITS if 0 < least + more <= MOST_LATER]


def _tried(
    running: Trajectory,
    coming: Plan,
    knot: int,
    offset: int,
    own: Sequence[Occupancy],
    others: Sequence[Occupancy],
    *,
    whole: bool = False,
) -> _Tried:
    """A block that begins at a knot, without what has no place there; whether anything has none, if `whole`."""
    every = [each.later(offset * STEP) for each in own]
    gone = _conflicts(every, others)
    limits = roomy(coming.setup.limits)
    begun = delay_controls(coming.trajectory.controls, offset)
    count = max(len(begun), len(running.controls), knot + LEAST)
    base, begun = lengthen(running.controls, count), lengthen(begun, count)
    while True:
        performed = [each for each in every if each.behaviour not in gone]
        if not performed or (whole and gone):
            return _Tried(offset, every, base, base, performed, gone)
        dropped = [each for each in every if each.behaviour in gone]
        work = Overlay(base, begun, knot, others, performed, dropped)
        found = overlay(work, coming.setup, limits)
        failed = found if isinstance(found, MergeFailure) else find_conflict(work, found, coming.setup)
        if failed is None and not isinstance(found, MergeFailure):
            return _Tried(offset, every, base, found, performed, gone)
        if failed is not None:
            gone[failed.behaviour] = failed.why


def _conflicts(own: Sequence[Occupancy], others: Sequence[Occupancy]) -> dict[str, str]:
    """Behaviours that meet what runs, and why."""
    found = {}
    for each in own:
        met = next((other for other in others if each.meets(other)), None)
        if met is not None:
            parts = " and ".join(sorted(each.roles & met.roles))
            found[each.behaviour] = f"{parts} busy with {met.behaviour} for {met.relax - each.ready:.2f} s more"
    return found


def _told(running: Trajectory, tried: _Tried, coming: Plan, wished: float) -> MergedMotion:
    """A block as it was laid, with what the sender should know; its zero was wished some time [s] after the start."""
    block, zero = coming.timeline.block, tried.offset * STEP + coming.trajectory.zero
    syncs = tuple(sync for sync in coming.syncs if sync.behaviour not in tried.gone)
    notices = [(name, f"left out: {why}") for name, why in tried.gone.items()]
    if zero - wished > SHIFT_TO_WARN:
        late = f"comes {zero - wished:.3f} s later, with the block"
        notices += [(sync.behaviour, f"{sync.sync} {late}") for sync in syncs if sync.sync == "stroke"]
    layer = tried.controls - lengthen(tried.base, len(tried.controls))
    return MergedMotion(
        trajectory=replace(running, controls=sealed(shorten(tried.controls))) if np.any(layer) else running,
        zero=running.start + zero,
        layer=replace(running, controls=sealed(layer)),
        busy=tuple(each.left(layer[-1]).later(running.start) for each in tried.performed),
        syncs=syncs,
        dropped=tuple(tried.gone),
        notices=tuple(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{name}", text) for name, text in notices),
    )
