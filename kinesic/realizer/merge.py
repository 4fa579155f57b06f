"""Lays the motion of a block over a running one, or puts it in its place, under all limits and clear of the body.

Movements of the trunk add up: a nod goes over a gaze, and the lean of one hand's reach over that of the other. A hand
does one work after the other: it leaves a hold or a retraction for what comes, and a work that meets another one of
the same hand, or one gaze another gaze, is left out by name.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.body.arrays import Floats, sealed
from kinesic.motion.trajectory import EARLY, STEP, Trajectory
from kinesic.motion.transition import delay_controls, knot_at, lengthen, roomy, shorten
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.realizer.conflicts import find_conflict
from kinesic.realizer.held import end_warnings, taking_over
from kinesic.realizer.occupancy import MergeFailure, Occupancy, Overlay, occupancy_of, still_occupied
from kinesic.realizer.overlay import overlay
from kinesic.realizer.release import release_motion

WAITS = (0, 10, 20, 40)  # knots from one attempt to the next
MOST_LATER = 60  # knots by which a block may come later


@dataclass(frozen=True, eq=False)
class MergedMotion:
    """A block that was laid over a running motion."""

    trajectory: Trajectory  # from the running motion's start on, the same before the cut
    zero: float  # [s] of the block's zero
    layer: Trajectory  # what the block adds to the running motion, from the same start on
    occupancy: tuple[Occupancy, ...]  # of its behaviours that move
    syncs: tuple[SyncTime, ...]  # as performed, in block time; of dropped behaviours none
    dropped: tuple[str, ...]  # behaviours that are left out
    notices: tuple[Notice, ...]

    def since(self, time: float) -> "MergedMotion":
        """Forgets what both motions did before a time [s]."""
        return replace(self, trajectory=self.trajectory.since(time), layer=self.layer.since(time))


def merge(
    running: Trajectory, time: float, coming: Plan, *, begin: float, occupied: Sequence[Occupancy] = ()
) -> MergedMotion:
    """Lays a block over a running motion.

    A silent block in which something has no place comes later by up to `MOST_LATER` where it then has; else, and in
    a block that speaks, what has none is left out.

    Args:
        running: the motion, within the limits and clear of the body.
        time: [s] from which it may change, at the next knot.
        coming: the block.
        begin: [s] at which the block's zero is desired.
        occupied: what the running motion does.
    """
    laid = _Merge.of(running, time, coming, occupied)
    return laid.merged(begin - running.start, waits=not coming.utterances)


def replace_motion(running: Trajectory, time: float, coming: Plan, *, begin: float | None = None) -> MergedMotion:
    """Puts a block in the place of all that runs.

    What the block does not move comes to rest. The block comes later where it has no way else.

    Args:
        running: the motion, within the limits and clear of the body.
        time: [s] from which it may be left, at the next knot.
        coming: the block.
        begin: [s] at which the block's zero is desired; at once by default.
    """
    every = np.ones(len(coming.setup.limits.lower), dtype=np.bool_)
    leaving = release_motion(running, time, every, coming.setup)
    desired = time + coming.trajectory.zero if begin is None else begin
    return _Merge.of(leaving, time, coming, ()).merged(desired - leaving.start, waits=True)


@dataclass(frozen=True, eq=False)
class _Attempt:
    """A block laid over what runs, beginning at one knot."""

    offset: int  # knot at which its own motion begins
    every: Sequence[Occupancy]  # of its behaviours
    base: Floats  # (k + 3, n) [rad] control points of what runs
    controls: Floats  # (k + 3, n) [rad] of both
    performed: Sequence[Occupancy]
    left_out: Mapping[str, str]  # behaviours that are left out, and why


@dataclass(frozen=True, eq=False)
class _Merge:
    """A plan that is laid over the running motion; times [s] are since that motion's start."""

    running: Trajectory
    coming: Plan
    cut: int  # knot until which nothing may change
    others: Sequence[Occupancy]  # what the running motion does, where it has not given way at the cut

    @classmethod
    def of(cls, running: Trajectory, time: float, coming: Plan, occupied: Sequence[Occupancy]) -> "_Merge":
        cut = knot_at(time - running.start)
        others = still_occupied([each.later(-running.start) for each in occupied], cut * STEP)
        return cls(running, coming, cut, others)

    @cached_property
    def own(self) -> tuple[Occupancy, ...]:
        """What the behaviours of the block need, in its plan's own time."""
        return occupancy_of(self.coming)

    def merged(self, desired: float, *, waits: bool) -> MergedMotion:
        """The block with its zero at a time [s]; later where it may wait and then nothing is left out."""
        soonest = max(ceil((desired - self.coming.trajectory.zero) / STEP - EARLY), self.cut)
        first = found = self.attempt(soonest)
        if first.left_out and waits:
            later = (self.attempt(soonest + more, whole=True) for more in _delays(first, self.others))
            found = next((attempt for attempt in later if not attempt.left_out), first)
        return self.result(found, desired)

    def attempt(self, offset: int, *, whole: bool = False) -> _Attempt:
        """Lays the block over what runs from a knot on, without behaviours that have no place there.

        If `whole`, the first that has none is enough to give up.
        """
        setup = self.coming.setup
        every = [each.later(offset * STEP) for each in self.own]
        left_out = _conflicts(every, self.others)
        delayed = delay_controls(self.coming.trajectory.controls, offset)
        count = max(len(delayed), len(self.running.controls))
        base, delayed = lengthen(self.running.controls, count), lengthen(delayed, count)
        while True:
            performed = [each for each in every if each.behaviour not in left_out]
            if (every and not performed) or (whole and left_out):
                return _Attempt(offset, every, base, base, performed, left_out)
            dropped = [each for each in every if each.behaviour in left_out]
            start = self.coming.trajectory.controls[0]
            work = Overlay(base, delayed, start, self.cut, self.others, performed, dropped)
            found = overlay(work, setup, roomy(setup.limits))
            failed = found if isinstance(found, MergeFailure) else find_conflict(work, found, setup)
            if failed is None and not isinstance(found, MergeFailure):
                return _Attempt(offset, every, base, found, performed, left_out)
            if not performed:  # idle motion alone, which gives way to whatever runs
                return _Attempt(offset, every, base, base, performed, left_out)
            if failed is not None:
                left_out[failed.behaviour] = failed.why

    def result(self, attempt: _Attempt, desired: float) -> MergedMotion:
        """The merged motion, with notices of what is left out or later than its zero was desired [s]."""
        robot, block = self.coming.setup.robot, self.coming.timeline.block
        zero = attempt.offset * STEP + self.coming.trajectory.zero
        syncs = tuple(sync for sync in self.coming.syncs if sync.behaviour not in attempt.left_out)
        texts = [(name, f"left out: {why}") for name, why in attempt.left_out.items()]
        if zero - desired > SHIFT_TO_WARN:
            late = f"comes {zero - desired:.3f} s later, with the block"
            texts += [(sync.behaviour, f"{sync.sync} {late}") for sync in syncs if sync.sync == "stroke"]
        texts += end_warnings(attempt.controls, attempt.performed, self.others, robot)
        performed = taking_over(attempt.performed, self.others, robot)
        running, layer = self.running, attempt.controls - lengthen(attempt.base, len(attempt.controls))
        return MergedMotion(
            trajectory=replace(running, controls=sealed(shorten(attempt.controls))) if np.any(layer) else running,
            zero=running.start + zero,
            layer=replace(running, controls=sealed(layer)),
            occupancy=tuple(each.later(running.start) for each in performed),
            syncs=syncs,
            dropped=tuple(attempt.left_out),
            notices=tuple(
                Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{name}", text) for name, text in texts
            ),
        )


def _delays(first: _Attempt, others: Sequence[Occupancy]) -> list[int]:
    """Lists the delays [knots] with which a block may come: the least that finds its parts free, and longer ones."""
    lacking = [
        other.relax - each.ready for each in first.every for other in others if each.meets(other) and not other.stays
    ]
    least = ceil(max(lacking, default=0.0) / STEP - EARLY)
    return [least + more for more in WAITS if 0 < least + more <= MOST_LATER]


def _conflicts(own: Sequence[Occupancy], others: Sequence[Occupancy]) -> dict[str, str]:
    found = {}
    for each in own:
        met = next((other for other in others if each.meets(other)), None)
        if met is not None:
            parts = " and ".join(sorted(each.roles & met.roles))
            found[each.behaviour] = f"{parts} busy with {met.behaviour} for {met.relax - each.ready:.2f} s more"
    return found
