"""Collision-free merging of a block's motion with a running motion.

Movements of the trunk add up: a nod is added to a gaze, the lean of one reach to that of the other. A hand performs one
behaviour after the other: it leaves a hold or a retraction for the next one. A behaviour that overlaps another one of
the same hand, or a gaze that overlaps another gaze, is dropped and reported.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from kinesic.bml.block import Notice, NoticeType
from kinesic.body.arrays import Floats, sealed
from kinesic.motion.trajectory import KNOT_INTERVAL, KNOT_TOLERANCE, Trajectory
from kinesic.motion.transition import delay_controls, extend_controls, knot_at, trim_final_rest, widen_limits
from kinesic.planning.plan import Plan
from kinesic.planning.reduced_plan import plan_without
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.realizer.conflicts import find_conflict
from kinesic.realizer.held import end_warnings, with_superseded_hinges
from kinesic.realizer.occupancy import MergeFailure, Occupancy, Overlay, occupancy_of, remaining_occupancy
from kinesic.realizer.overlay import overlay_motions
from kinesic.realizer.release import release_motion

DELAY_STEPS = (0, 10, 20, 40)  # [knots] delays tried in addition to the shortest delay that ends all conflicts
MAX_BLOCK_DELAY = 60  # [knots] maximum delay of a block without speech, to avoid conflicts


@dataclass(frozen=True, eq=False)
class MergedMotion:
    """Result of merging a block with a running motion."""

    trajectory: Trajectory  # starts with the running motion, equal to it before the cut
    zero: float  # [s] block time 0, on the clock of the motion
    layer: Trajectory  # offsets that the block adds to the running motion
    occupancy: tuple[Occupancy, ...]  # occupancies of the block's moving behaviours
    syncs: tuple[SyncTime, ...]  # sync points as performed, in block time, without dropped behaviours
    dropped: tuple[str, ...]  # names of dropped behaviours
    notices: tuple[Notice, ...]

    def since(self, time: float) -> "MergedMotion":
        """Return a copy without motion and block offsets before a time [s]."""
        return replace(self, trajectory=self.trajectory.since(time), layer=self.layer.since(time))


def merge(
    running: Trajectory, time: float, coming: Plan, *, begin: float, occupied: Sequence[Occupancy] = ()
) -> MergedMotion:
    """Merge a block with a running motion.

    A silent block with a conflicting behaviour is delayed by up to `MAX_BLOCK_DELAY` knots if that resolves all
    conflicts. Otherwise, and in a block with speech, conflicting behaviours are dropped.

    Args:
        running: running motion, within limits and without collisions.
        time: time [s] from which it may change, rounded up to a knot.
        coming: plan of the block.
        begin: desired time [s] of the block's zero.
        occupied: occupancies of the running motion.
    """
    return _Merge.of(running, time, coming, occupied, begin).merged(waits=not coming.utterances)


def replace_motion(running: Trajectory, time: float, coming: Plan, *, begin: float | None = None) -> MergedMotion:
    """Replace the running motion by a block's motion.

    Hinges that the block does not move come to rest. The block is delayed if necessary.

    Args:
        running: running motion, within limits and without collisions.
        time: time [s] from which it may change, rounded up to a knot.
        coming: plan of the block.
        begin: desired time [s] of the block's zero; immediately by default.
    """
    all_hinges = np.ones(len(coming.setup.limits.lower), dtype=np.bool_)
    leaving = release_motion(running, time, all_hinges, coming.setup)
    desired = time + coming.trajectory.zero if begin is None else begin
    return _Merge.of(leaving, time, coming, (), desired).merged(waits=True)


@dataclass(frozen=True, eq=False)
class _Attempt:
    """Result of merging a block that begins at a given knot."""

    coming: Plan  # plan of the block without dropped behaviours
    offset: int  # knot at which the block's motion begins
    base: Floats  # (k + 3, n) [rad] control points of the running motion
    controls: Floats  # (k + 3, n) [rad] control points of the merged motion
    performed: Sequence[Occupancy]
    left_out: Mapping[str, str]  # dropped behaviours with reasons

    @property
    def zero(self) -> float:
        """Time [s] in the running motion at which block time is 0."""
        return self.offset * KNOT_INTERVAL + self.coming.trajectory.zero


@dataclass(frozen=True, eq=False)
class _Merge:
    """Merge of a planned block with a running motion.

    Times [s] count from the start of the running motion.
    """

    running: Trajectory
    coming: Plan
    cut: int  # first knot that may change
    others: Sequence[Occupancy]  # occupancies of the running motion after the cut
    desired: float  # [s] desired time of block time 0

    @classmethod
    def of(
        cls, running: Trajectory, time: float, coming: Plan, occupied: Sequence[Occupancy], desired: float
    ) -> "_Merge":
        cut = knot_at(time - running.start)
        others = remaining_occupancy([entry.shifted(-running.start) for entry in occupied], cut * KNOT_INTERVAL)
        return cls(running, coming, cut, others, desired - running.start)

    @cached_property
    def block_occupancy(self) -> tuple[Occupancy, ...]:
        """Occupancies of all behaviours of the block, in plan time."""
        return occupancy_of(self.coming)

    def merged(self, *, waits: bool) -> MergedMotion:
        """Merge the block, with its time 0 at the desired time.

        If it may wait, it is delayed where that avoids dropped behaviours.
        """
        first = attempt = self.attempt()
        if first.left_out and waits:
            later = (self.attempt(delay, whole=True) for delay in self._delays)
            attempt = next((attempt for attempt in later if not attempt.left_out), first)
        return self.result(attempt)

    @property
    def _delays(self) -> list[int]:
        """Candidate delays [knots]: the shortest without conflicts, and longer ones."""
        offset = self._soonest(self.coming) * KNOT_INTERVAL
        lacking = [
            other.relax - entry.ready
            for entry in (entry.shifted(offset) for entry in self.block_occupancy)
            for other in self.others
            if entry.conflicts_with(other) and not other.is_held
        ]
        least = ceil(max(lacking, default=0.0) / KNOT_INTERVAL - KNOT_TOLERANCE)
        return [least + more for more in DELAY_STEPS if 0 < least + more <= MAX_BLOCK_DELAY]

    def _soonest(self, coming: Plan) -> int:
        """Return the first knot at which a plan's motion may begin."""
        return max(ceil((self.desired - coming.trajectory.zero) / KNOT_INTERVAL - KNOT_TOLERANCE), self.cut)

    def attempt(self, delay: int = 0, *, whole: bool = False) -> _Attempt:
        """Merge the block and drop conflicting behaviours.

        The rest of the block is planned again after each drop: a dropped behaviour leaves nothing in the motion.

        Args:
            delay: [knots] after the soonest begin.
            whole: whether to stop at the first conflict.
        """
        setup, names = self.coming.setup, [entry.behaviour for entry in self.block_occupancy]
        left_out: dict[str, str] = {}
        while True:
            is_over = (names and len(left_out) == len(names)) or (whole and left_out)
            coming = self.coming if is_over else plan_without(self.coming, left_out)
            offset = self._soonest(coming) + delay
            delayed = delay_controls(coming.trajectory.controls, offset)
            count = max(len(delayed), len(self.running.controls))
            base, delayed = extend_controls(self.running.controls, count), extend_controls(delayed, count)
            performed = [entry.shifted(offset * KNOT_INTERVAL) for entry in occupancy_of(coming)]
            unchanged = _Attempt(coming, offset, base, base, [], left_out)
            if is_over:
                return unchanged
            present = {entry.behaviour for entry in performed}
            new_drops = _conflicts(performed, self.others) | {
                name: coming.keyframes.outcomes[name].why for name in names if name not in present | left_out.keys()
            }
            if new_drops:
                left_out |= new_drops
                continue
            work = Overlay(base, delayed, coming.trajectory.controls[0], self.cut, self.others, performed)
            controls = overlay_motions(work, setup, widen_limits(setup.limits))
            failed = controls if isinstance(controls, MergeFailure) else find_conflict(work, controls, setup)
            if failed is None and not isinstance(controls, MergeFailure):
                return replace(unchanged, controls=controls, performed=performed)
            if failed is None or not performed:  # only idle motion, which has the lowest priority
                return unchanged
            left_out[failed.behaviour] = failed.why

    def result(self, attempt: _Attempt) -> MergedMotion:
        """Build the merged motion with notices on dropped and delayed behaviours."""
        robot, block, desired = self.coming.setup.robot, self.coming.timeline.block, self.desired
        zero, syncs = (
            attempt.zero,
            tuple(sync for sync in attempt.coming.syncs if sync.behaviour not in attempt.left_out),
        )
        texts = [(name, f"left out: {why}") for name, why in attempt.left_out.items()]
        if zero - desired > SHIFT_TO_WARN:
            late = f"is delayed by {zero - desired:.3f} s with the block"
            texts += [(sync.behaviour, f"{sync.sync} {late}") for sync in syncs if sync.sync == "stroke"]
        texts += end_warnings(attempt.controls, attempt.performed, self.others, robot)
        performed = with_superseded_hinges(attempt.performed, self.others, robot)
        running, layer = self.running, attempt.controls - extend_controls(attempt.base, len(attempt.controls))
        return MergedMotion(
            trajectory=replace(running, controls=sealed(trim_final_rest(attempt.controls)))
            if np.any(layer)
            else running,
            zero=running.start + zero,
            layer=replace(running, controls=sealed(layer)),
            occupancy=tuple(entry.shifted(running.start) for entry in performed),
            syncs=syncs,
            dropped=tuple(attempt.left_out),
            notices=tuple(
                Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"{block.id}:{name}", text) for name, text in texts
            ),
        )


def _conflicts(block_occupancy: Sequence[Occupancy], others: Sequence[Occupancy]) -> dict[str, str]:
    reasons = {}
    for entry in block_occupancy:
        met = next((other for other in others if entry.conflicts_with(other)), None)
        if met is not None:
            parts = " and ".join(sorted(entry.roles & met.roles))
            reasons[entry.behaviour] = f"{parts} busy with {met.behaviour} for {met.relax - entry.ready:.2f} s more"
    return reasons
