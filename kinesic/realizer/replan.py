"""Transition of a running block to a new plan."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.keys import Keys
from kinesic.motion.segments import NO_KNOT_POSITIONS
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.motion.transition import (
    MIN_TRANSITION,
    SAME_ANGLE,
    cross_over,
    delay_controls,
    extend_controls,
    keep_limits,
    knot_at,
    largest_limit_ratios,
    trim_final_rest,
    widen_limits,
)
from kinesic.planning.plan import Plan
from kinesic.planning.reduced_plan import plan_without
from kinesic.realizer.conflicts import find_conflict
from kinesic.realizer.held import add_step_to_held_posture, with_superseded_hinges
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import (
    ARM_ROLES,
    MergeFailure,
    Occupancy,
    Overlay,
    arm_hinges,
    occupancy_of,
    remaining_occupancy,
)
from kinesic.realizer.overlay import overlay_motions

MAX_JOIN_KEYS = 3  # number of keys of the new plan at which a hand may join its motion
MAX_JOIN_DEVIATION = 0.1  # [rad] largest deviation from the new motion after a hand has joined it
TRUNK_JOIN_KNOTS = (10, 20, 40, 80)  # [knots] durations tried for the trunk to join the new motion


def replan(
    running: Trajectory, time: float, playing: MergedMotion, new_plan: Plan, *, others: Sequence[Occupancy] = ()
) -> MergedMotion | None:
    """Continue a running block with a new plan, or return None.

    Hands change over within a gesture if no stroke is then repeated or skipped; otherwise they finish current
    behaviours.

    Args:
        running: running motion with all merged blocks.
        time: time [s] from which it may change, rounded up to a knot.
        playing: block as merged into the motion, from the same start on.
        new_plan: new plan, which keeps the block's zero.
        others: other occupancies of the running motion.

    Returns:
        None if a hinge cannot catch up or the transition would collide.
    """
    change = _PlanSwitch.of(running, time, playing, new_plan, others)
    in_progress = change.hands_in_progress
    ending = set() if change.keeps_strokes else in_progress
    while True:
        result = change.attempt(ending)
        if not isinstance(result, MergeFailure):
            return result
        more = ending | in_progress | {result.behaviour}
        if more == ending:
            return None
        ending = more


@dataclass(frozen=True, eq=False)
class _PlanSwitch:
    """Transition of a running block from its plan to another.

    Times [s] count from the running motion's start.
    """

    running: Trajectory
    knot: int  # first knot that may change
    playing: MergedMotion  # block as merged by the old plan, in global time
    playing_zero: float  # [s] time of the block's zero in the old plan
    playing_occupancy: Sequence[Occupancy]
    new_plan: Plan  # without behaviours that the merge has dropped
    others: Sequence[Occupancy]

    @classmethod
    def of(
        cls, running: Trajectory, time: float, playing: MergedMotion, new_plan: Plan, others: Sequence[Occupancy]
    ) -> "_PlanSwitch":
        start, knot = running.start, knot_at(time - running.start)
        playing_occupancy, others = (
            [entry.shifted(-start) for entry in needs] for needs in (playing.occupancy, others)
        )
        remaining_plan = plan_without(new_plan, playing.dropped)
        return cls(running, knot, playing, playing.zero - start, playing_occupancy, remaining_plan, others)

    @cached_property
    def offset(self) -> int:
        """Knot at which the new plan's motion begins."""
        return round((self.playing_zero - self.new_plan.trajectory.zero) / KNOT_INTERVAL)

    @cached_property
    def zero(self) -> float:
        """Time [s] of the new plan's block time 0."""
        return self.offset * KNOT_INTERVAL + self.new_plan.trajectory.zero

    @cached_property
    def new_occupancy(self) -> tuple[Occupancy, ...]:
        """Occupancies of the new plan's behaviours."""
        return tuple(entry.shifted(self.offset * KNOT_INTERVAL) for entry in occupancy_of(self.new_plan))

    @property
    def hands_in_progress(self) -> set[str]:
        """Ids of hand behaviours that have begun in either plan."""
        now = self.knot * KNOT_INTERVAL
        begun = (entry for entry in (*self.new_occupancy, *self.playing_occupancy) if entry.begin < now)
        return {entry.behaviour for entry in begun if entry.roles & set(ARM_ROLES)}

    @property
    def keeps_strokes(self) -> bool:
        """Whether the new plan neither repeats past strokes nor skips future ones."""
        now, soon = self.knot * KNOT_INTERVAL, (self.knot + MIN_TRANSITION) * KNOT_INTERVAL
        before = {(sync.behaviour, sync.sync): sync.planned + self.playing_zero for sync in self.playing.syncs}
        after = {(sync.behaviour, sync.sync): sync.planned + self.zero for sync in self.new_plan.syncs}
        strokes = [sync for sync in before.keys() & after.keys() if sync[1].startswith("stroke")]
        return all(after[sync] >= soon if before[sync] > now else after[sync] <= now for sync in strokes)

    def attempt(self, ending: Collection[str]) -> MergedMotion | MergeFailure:
        """Switch to the new plan, letting some old behaviours finish."""
        setup, count = self.new_plan.setup, self._count
        going_on = [
            entry
            for entry in self.playing_occupancy
            if entry.behaviour in ending and entry.relax > self.knot * KNOT_INTERVAL
        ]
        performed, finishing = _split(self.new_occupancy, ending)
        base = self._without_block(count)
        if base is None:
            return MergeFailure("", "the trunk cannot follow other blocks within its limits")
        work = Overlay(
            base,
            extend_controls(delay_controls(self.new_plan.trajectory.controls, self.offset), count),
            self.new_plan.trajectory.controls[0],
            self.knot,
            remaining_occupancy((*self.others, *going_on), self.knot * KNOT_INTERVAL),
            performed,
            finishing,
        )
        goal = overlay_motions(work, setup, widen_limits(setup.limits))
        if isinstance(goal, MergeFailure):
            return goal
        count = max(len(goal), self.knot + TRUNK_JOIN_KNOTS[-1] + MIN_TRANSITION)
        controls = self._catch_up(extend_controls(goal, count))
        if controls is None:
            return MergeFailure("", "a hinge cannot catch up")
        occupancy = (*going_on, *with_superseded_hinges(performed, self.others, setup.robot))
        return find_conflict(work, controls, setup) or self._result(controls, ending, occupancy)

    @property
    def _count(self) -> int:
        coming = self.offset + len(self.new_plan.trajectory.controls)
        return max(len(self.running.controls), len(self.playing.layer.controls), coming, self.knot + 2 * MIN_TRANSITION)

    def _without_block(self, count: int) -> Floats | None:
        """Return the running motion's control points without the block's trunk motion.

        Hands leave the running motion in any case. The sum with the block may have been projected onto the limits, so
        that the remainder can exceed them; None if it cannot be corrected.
        """
        robot, layer = self.new_plan.setup.robot, extend_controls(self.playing.layer.controls, count)
        controls = np.array(extend_controls(self.running.controls, count))
        trunk = [hinge for chain in ("torso", "neck") for hinge in robot.joints(chain)]
        controls[:, trunk] -= layer[:, trunk]
        controls = np.array(add_step_to_held_posture(controls, self.others, robot))
        limits = widen_limits(self.new_plan.setup.limits)
        over = largest_limit_ratios(controls[self.knot :, trunk], limits.part(np.array(trunk))) > 1.0
        for hinge in np.array(trunk)[over].tolist():
            column = keep_limits(controls[:, hinge], self.knot, len(controls) - MIN_TRANSITION, limits, hinge)
            if column is None:
                return None
            controls[:, hinge] = column
        return controls

    def _catch_up(self, goal: Floats) -> Floats | None:
        """Return control points that join the new motion, or return None.

        They are (k + 3, n) [rad].
        """
        setup, current = self.new_plan.setup, extend_controls(self.running.controls, len(goal))
        key_knots = (self.new_plan.motion.planned + self.zero) / KNOT_INTERVAL
        postures = self.new_plan.postures.postures  # empty if the new plan has no motion
        keys = Keys.of(postures, setup.limits).exact_rows if postures else [[]] * len(setup.limits.lower)
        arms = {hinge for role in ARM_ROLES for hinge in arm_hinges(role, setup.robot)}
        controls, limits = np.array(goal), widen_limits(setup.limits)
        for hinge in np.flatnonzero((np.abs(current - goal)[self.knot :] > SAME_ANGLE).any(axis=0)).tolist():
            coming = key_knots[keys[hinge]] if hinge in arms else NO_KNOT_POSITIONS
            coming = coming[coming >= self.knot + MIN_TRANSITION]
            joined = _join(current[:, hinge], goal[:, hinge], self.knot, coming, limits, hinge)
            if joined is None:
                return None
            controls[:, hinge] = joined
        controls[: self.knot + MIN_TRANSITION] = current[: self.knot + MIN_TRANSITION]
        return controls

    def _result(self, controls: Floats, ending: Collection[str], occupancy: Sequence[Occupancy]) -> MergedMotion:
        """Build the merged block, with old sync points for behaviours that finish."""
        zero_shift, playing, running = self.zero - self.playing_zero, self.playing, self.running
        layer = (
            controls
            - extend_controls(running.controls, len(controls))
            + extend_controls(playing.layer.controls, len(controls))
        )
        syncs = [sync for sync in playing.syncs if sync.behaviour in ending]
        syncs += [
            replace(sync, planned=sync.planned + zero_shift)
            for sync in self.new_plan.syncs
            if sync.behaviour not in ending
        ]
        return replace(
            playing,
            trajectory=replace(running, controls=sealed(trim_final_rest(controls))),
            layer=replace(running, controls=sealed(layer)),
            occupancy=tuple(entry.shifted(running.start) for entry in occupancy),
            syncs=tuple(sorted(syncs, key=lambda sync: (sync.planned, sync.behaviour))),
            notices=(),
        )


def _split(new_occupancy: Sequence[Occupancy], ending: Collection[str]) -> tuple[list[Occupancy], list[Occupancy]]:
    """Divide occupied roles between the new motion and the old one.

    Of behaviours that finish in the old plan, only the arms do; their trunk moves to the new plan.
    """
    performed, finishing = [], []
    for entry in new_occupancy:
        arms = entry.roles & set(ARM_ROLES) if entry.behaviour in ending else frozenset()
        if entry.roles - arms:
            performed.append(replace(entry, roles=entry.roles - arms))
        if arms:
            finishing.append(replace(entry, roles=arms))
    return performed, finishing


def _join(current: Floats, goal: Floats, knot: int, coming: Floats, limits: Limits, hinge: int) -> Floats | None:
    """Return a hinge's control points that join its new motion, or None.

    The transition ends at one of the next keys; without keys, it has a fixed duration.
    """
    lands = [(int(place), coming[:k]) for k, place in enumerate(coming[:MAX_JOIN_KEYS])]
    lands += [(knot + pieces, NO_KNOT_POSITIONS) for pieces in TRUNK_JOIN_KNOTS if not len(coming)]
    for land, passing in lands:
        joined = cross_over(current, goal, (knot, land), limits, hinge, passing=passing)
        if joined is not None:
            first = ceil(passing[0]) if len(passing) else land
            deviation = np.abs(joined - goal)[first + MIN_TRANSITION :].max(initial=0.0)
            return joined if deviation < MAX_JOIN_DEVIATION else None
    return None
