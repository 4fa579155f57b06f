"""Continues a running block by another plan of it: a better one, or one in another style."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.keys import Keys
from kinesic.motion.segments import NOWHERE
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.motion.transition import (
    FEWEST_PIECES,
    SAME_ANGLE,
    cross_over,
    delay_controls,
    keep_limits,
    knot_at,
    largest_shares,
    lengthen,
    roomy,
    shorten,
)
from kinesic.planning.plan import Plan
from kinesic.realizer.conflicts import find_conflict
from kinesic.realizer.held import HELD_ROLES, lead_to_held, taking_over
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import ARMS, MergeFailure, Occupancy, Overlay, arm_hinges, occupancy_of, still_occupied
from kinesic.realizer.overlay import overlay

KEYS_AHEAD = 3  # keys of the other plan that a hand may pass before it has joined its motion
MEETING_SWING = 0.1  # [rad] from the other motion, once a hand has met it
SOON = (10, 20, 40, 80)  # knots in which the trunk joins it


def replan(
    running: Trajectory, time: float, playing: MergedMotion, better: Plan, *, others: Sequence[Occupancy] = ()
) -> MergedMotion | None:
    """Performs what is still to come of a block by another plan of it.

    Hands go over in the midst of a gesture where no stroke is then performed twice or left out; else they first end
    what they have begun.

    Args:
        running: the motion, whatever else was merged into it.
        time: [s] from which it may change, at the next knot.
        playing: the block as it was merged into the motion, from the same start on.
        better: the other plan, which keeps the block's zero.
        others: what else the running motion does.

    Returns:
        None when a hinge cannot catch up, or the way is not clear of the body.
    """
    change = _PlanChange.of(running, time, playing, better, others)
    in_progress = change.hands_in_progress
    ending = set() if change.keeps_strokes else in_progress
    while True:
        found = change.attempt(ending)
        if not isinstance(found, MergeFailure):
            return found
        more = ending | in_progress | {found.behaviour}
        if more == ending:
            return None
        ending = more


@dataclass(frozen=True, eq=False)
class _PlanChange:
    """The change from one plan of a block to another; times [s] are since the running motion's start."""

    running: Trajectory
    knot: int  # where it may begin
    playing: MergedMotion  # by the plan so far; its own times are on the clock
    playing_zero: float
    playing_occupancy: Sequence[Occupancy]
    better: Plan
    others: Sequence[Occupancy]

    @classmethod
    def of(
        cls, running: Trajectory, time: float, playing: MergedMotion, better: Plan, others: Sequence[Occupancy]
    ) -> "_PlanChange":
        start, knot = running.start, knot_at(time - running.start)
        own, others = ([each.later(-start) for each in needs] for needs in (playing.occupancy, others))
        return cls(running, knot, playing, playing.zero - start, own, better, others)

    @cached_property
    def offset(self) -> int:
        """Knot at which the other plan's own motion begins."""
        return round((self.playing_zero - self.better.trajectory.zero) / STEP)

    @cached_property
    def zero(self) -> float:
        """[s] of the other plan's zero: the block's, but for the grid."""
        return self.offset * STEP + self.better.trajectory.zero

    @cached_property
    def own(self) -> tuple[Occupancy, ...]:
        """What the behaviours of the other plan occupy."""
        return tuple(each.later(self.offset * STEP) for each in occupancy_of(self.better))

    @property
    def hands_in_progress(self) -> set[str]:
        """Behaviours of hands that have begun."""
        now = self.knot * STEP
        begun = (each for each in (*self.own, *self.playing_occupancy) if each.begin < now)
        return {each.behaviour for each in begun if each.roles & set(ARMS)}

    @property
    def keeps_strokes(self) -> bool:
        """Whether the other plan repeats no stroke that is past, and leaves out none that is to come."""
        now, soon = self.knot * STEP, (self.knot + FEWEST_PIECES) * STEP
        before = {(sync.behaviour, sync.sync): sync.planned + self.playing_zero for sync in self.playing.syncs}
        after = {(sync.behaviour, sync.sync): sync.planned + self.zero for sync in self.better.syncs}
        strokes = [sync for sync in before.keys() & after.keys() if sync[1].startswith("stroke")]
        return all(after[sync] >= soon if before[sync] > now else after[sync] <= now for sync in strokes)

    def attempt(self, ending: Collection[str]) -> MergedMotion | MergeFailure:
        """Performs the block by the other plan, but for behaviours that end as they run."""
        kept, setup, count = {*self.playing.dropped, *ending}, self.better.setup, self._count
        going_on = [
            each for each in self.playing_occupancy if each.behaviour in ending and each.relax > self.knot * STEP
        ]
        performed, left_out = _split(self.own, kept, ending)
        base = self._without_block(count)
        if base is None:
            return MergeFailure("", "the trunk cannot do what other blocks ask of it")
        work = Overlay(
            base,
            lengthen(delay_controls(self.better.trajectory.controls, self.offset), count),
            self.better.trajectory.controls[0],
            self.knot,
            still_occupied((*self.others, *going_on), self.knot * STEP),
            performed,
            left_out,
        )
        goal = overlay(work, setup, roomy(setup.limits))
        if isinstance(goal, MergeFailure):
            return goal
        count = max(len(goal), self.knot + SOON[-1] + FEWEST_PIECES)
        found = self._catch_up(lengthen(goal, count))
        if found is None:
            return MergeFailure("", "a hinge cannot catch up")
        occupancy = (*going_on, *taking_over(performed, self.others, setup.robot))
        return find_conflict(work, found, setup) or self._result(found, kept, occupancy)

    @property
    def _count(self) -> int:
        coming = self.offset + len(self.better.trajectory.controls)
        return max(len(self.running.controls), len(self.playing.layer.controls), coming, self.knot + FEWEST_PIECES)

    def _without_block(self, count: int) -> Floats | None:
        """Return the running motion without the block's trunk motion.

        Hands leave the running motion in any case.

        The sum with the block may have been brought within the limits, so that what is left is not; None where it
        cannot be.
        """
        robot, layer = self.better.setup.robot, lengthen(self.playing.layer.controls, count)
        found = np.array(lengthen(self.running.controls, count))
        trunk = [hinge for chain in ("torso", "neck") for hinge in robot.joints(chain)]
        found[:, trunk] -= layer[:, trunk]
        found, limits = np.array(lead_to_held(found, self.others, robot)), roomy(self.better.setup.limits)
        over = largest_shares(found[self.knot :, trunk], limits.part(np.array(trunk))) > 1.0
        for hinge in np.array(trunk)[over].tolist():
            column = keep_limits(found[:, hinge], self.knot, len(found) - FEWEST_PIECES, limits, hinge)
            if column is None:
                return None
            found[:, hinge] = column
        return found

    def _catch_up(self, goal: Floats) -> Floats | None:
        """Control points (k + 3, n) that leave the running motion and soon join another."""
        setup, own = self.better.setup, lengthen(self.running.controls, len(goal))
        places = (self.better.motion.planned + self.zero) / STEP
        postures = self.better.postures.postures  # none where the other plan does not move
        keys = Keys.of(postures, setup.limits).own if postures else [[]] * len(setup.limits.lower)
        arms = {hinge for role in ARMS for hinge in arm_hinges(role, setup.robot)}
        found, limits = np.array(goal), roomy(setup.limits)
        for hinge in np.flatnonzero((np.abs(own - goal)[self.knot :] > SAME_ANGLE).any(axis=0)).tolist():
            coming = places[keys[hinge]] if hinge in arms else NOWHERE
            coming = coming[coming >= self.knot + FEWEST_PIECES]
            way = _join(own[:, hinge], goal[:, hinge], self.knot, coming, limits, hinge)
            if way is None:
                return None
            found[:, hinge] = way
        found[: self.knot + FEWEST_PIECES] = own[: self.knot + FEWEST_PIECES]
        return found

    def _result(self, found: Floats, kept: Collection[str], occupancy: Sequence[Occupancy]) -> MergedMotion:
        """The merged block, with sync points of the plan so far for behaviours that are kept."""
        slip, playing, running = self.zero - self.playing_zero, self.playing, self.running
        layer = found - lengthen(running.controls, len(found)) + lengthen(playing.layer.controls, len(found))
        syncs = [sync for sync in playing.syncs if sync.behaviour in kept]
        syncs += [
            replace(sync, planned=sync.planned + slip) for sync in self.better.syncs if sync.behaviour not in kept
        ]
        return replace(
            playing,
            trajectory=replace(running, controls=sealed(shorten(found))),
            layer=replace(running, controls=sealed(layer)),
            occupancy=tuple(each.later(running.start) for each in occupancy),
            syncs=tuple(sorted(syncs, key=lambda sync: (sync.planned, sync.behaviour))),
            notices=(),
        )


def _split(
    own: Sequence[Occupancy], kept: Collection[str], ending: Collection[str]
) -> tuple[list[Occupancy], list[Occupancy]]:
    """Split the behaviours of the new plan into performed and dropped ones.

    What the trunk holds of a posture goes over to the other plan, while the arms of that posture end as they run.
    """
    performed, left_out = [], []
    for each in own:
        held = frozenset(role for role in HELD_ROLES if each.holds(role))
        if each.behaviour not in kept:
            performed.append(each)
        elif each.behaviour in ending and held:
            performed.append(replace(each, roles=held))
            left_out.append(replace(each, roles=each.roles - held))
        else:
            left_out.append(each)
    return performed, left_out


def _join(own: Floats, goal: Floats, knot: int, coming: Floats, limits: Limits, hinge: int) -> Floats | None:
    """Has a hinge join the other motion by one of the keys to come, or soon where there are none."""
    lands = [(int(place), coming[:k]) for k, place in enumerate(coming[:KEYS_AHEAD])]
    lands += [(knot + pieces, NOWHERE) for pieces in SOON if not len(coming)]
    for land, passing in lands:
        way = cross_over(own, goal, (knot, land), limits, hinge, passing=passing)
        if way is not None:
            first = ceil(passing[0]) if len(passing) else land
            return way if np.abs(way - goal)[first + FEWEST_PIECES :].max(initial=0.0) < MEETING_SWING else None
    return None
