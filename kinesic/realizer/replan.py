"""A block that runs is gone on with by another plan of it: a better one, or one in another manner."""

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
    LEAST,
    SAME,
    cross_over,
    delay_controls,
    knot_at,
    lengthen,
    roomy,
    shorten,
)
from kinesic.planning.plan import Plan
from kinesic.realizer.conflicts import find_conflict
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import ARMS, MergeFailure, Occupancy, Overlay, arm_hinges, occupancy_of, still_occupied
from kinesic.realizer.overlay import overlay

AHEAD = 3  # keys of the other plan that a hand may pass before it is on its way
SWING = 0.1  # [rad] from the other motion, once a hand has met it
SOON = (10, 20, 40, 80)  # knots in which the trunk is on its way


def replan(
    running: Trajectory, time: float, playing: MergedMotion, better: Plan, *, others: Sequence[Occupancy] = ()
) -> MergedMotion | None:
    """What is still to come of a block, by another plan of the same block.

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
    others, own = ([each.later(-running.start) for each in busy] for busy in (others, playing.busy))
    change = _Change(running, knot_at(time - running.start), playing, better, others, own)
    begun = change.begun
    ending = set() if change.keeps_strokes else begun
    while True:
        found = change.made(ending)
        if not isinstance(found, MergeFailure):
            return found
        more = ending | begun | {found.behaviour}
        if more == ending:
            return None
        ending = more


@dataclass(frozen=True, eq=False)
class _Change:
    """From one plan of a block to another."""

    running: Trajectory
    knot: int  # where it may begin
    playing: MergedMotion
    better: Plan
    others: Sequence[Occupancy]  # times of these and of the next ones are since the motion's start
    playing_busy: Sequence[Occupancy]  # of the plan so far

    @property
    def playing_zero(self) -> float:
        """[s] since the motion's start of the block's zero."""
        return self.playing.zero - self.running.start

    @cached_property
    def offset(self) -> int:
        """Knot at which the other plan's own motion begins."""
        return round((self.playing_zero - self.better.trajectory.zero) / STEP)

    @cached_property
    def zero(self) -> float:
        """[s] since the motion's start of the other plan's zero: the block's, but for the grid."""
        return self.offset * STEP + self.better.trajectory.zero

    @cached_property
    def own(self) -> tuple[Occupancy, ...]:
        """What the behaviours of the other plan need."""
        return tuple(each.later(self.offset * STEP) for each in occupancy_of(self.better))

    @property
    def begun(self) -> set[str]:
        """Behaviours whose hands are on their way."""
        now = self.knot * STEP
        return {each.behaviour for each in (*self.own, *self.playing_busy) if each.begin < now and _with_hands(each)}

    @property
    def keeps_strokes(self) -> bool:
        """Whether every stroke that is past is past in the other plan, and every one to come is to come."""
        now, soon = self.knot * STEP, (self.knot + LEAST) * STEP
        before = {(sync.behaviour, sync.sync): sync.planned + self.playing_zero for sync in self.playing.syncs}
        after = {(sync.behaviour, sync.sync): sync.planned + self.zero for sync in self.better.syncs}
        strokes = [sync for sync in before.keys() & after.keys() if sync[1].startswith("stroke")]
        return all(after[sync] >= soon if before[sync] > now else after[sync] <= now for sync in strokes)

    def made(self, ending: Collection[str]) -> MergedMotion | MergeFailure:
        """The block by the other plan, but for behaviours that end as they run."""
        gone, setup, count = {*self.playing.dropped, *ending}, self.better.setup, self._count
        going_on = [each for each in self.playing_busy if each.behaviour in ending and each.relax > self.knot * STEP]
        work = Overlay(
            self._without_it(count),
            lengthen(delay_controls(self.better.trajectory.controls, self.offset), count),
            self.knot,
            still_occupied((*self.others, *going_on), self.knot * STEP),
            [each for each in self.own if each.behaviour not in gone],
            [each for each in self.own if each.behaviour in gone],
        )
        goal = overlay(work, setup, roomy(setup.limits))
        if isinstance(goal, MergeFailure):
            return goal
        count = max(len(goal), self.knot + SOON[-1] + LEAST)
        found = self._caught_up(lengthen(goal, count))
        if found is None:
            return MergeFailure("", "a hinge cannot catch up")
        return find_conflict(work, found, setup) or self._told(found, gone, (*going_on, *work.performed))

    @property
    def _count(self) -> int:
        """Control points that are laid over one another."""
        coming = self.offset + len(self.better.trajectory.controls)
        return max(len(self.running.controls), len(self.playing.layer.controls), coming, self.knot + LEAST)

    def _without_it(self, count: int) -> Floats:
        """What goes on without the block on the trunk; hands leave and take up what runs in any case."""
        robot, layer = self.better.setup.robot, lengthen(self.playing.layer.controls, count)
        found = np.array(lengthen(self.running.controls, count))
        trunk = [hinge for chain in ("torso", "neck") for hinge in robot.joints(chain)]
        found[:, trunk] -= layer[:, trunk]
        return found

    def _caught_up(self, goal: Floats) -> Floats | None:
        """Control points (k + 3, n) that leave the running motion and are soon on another."""
        setup, own = self.better.setup, lengthen(self.running.controls, len(goal))
        places = (self.better.motion.planned + self.zero) / STEP
        keys = Keys.of(self.better.postures.postures, setup.limits).own
        arms = {hinge for role in ARMS for hinge in arm_hinges(role, setup.robot)}
        found, limits = np.array(goal), roomy(setup.limits)
        for hinge in np.flatnonzero((np.abs(own - goal)[self.knot :] > SAME).any(axis=0)).tolist():
            coming = places[keys[hinge]] if hinge in arms else NOWHERE
            coming = coming[coming >= self.knot + LEAST]
            way = _on_its_way(own[:, hinge], goal[:, hinge], self.knot, coming, limits, hinge)
            if way is None:
                return None
            found[:, hinge] = way
        found[: self.knot + LEAST] = own[: self.knot + LEAST]
        return found

    def _told(self, found: Floats, gone: Collection[str], needs: Sequence[Occupancy]) -> MergedMotion:
        """The block as it now is."""
        slip, playing, running = self.zero - self.playing_zero, self.playing, self.running
        layer = found - lengthen(running.controls, len(found)) + lengthen(playing.layer.controls, len(found))
        syncs = [sync for sync in playing.syncs if sync.behaviour in gone]
        syncs += [
            replace(sync, planned=sync.planned + slip) for sync in self.better.syncs if sync.behaviour not in gone
        ]
        return replace(
            playing,
            trajectory=replace(running, controls=sealed(shorten(found))),
            layer=replace(running, controls=sealed(layer)),
            busy=tuple(each.left(layer[-1]).later(running.start) for each in needs),
            syncs=tuple(sorted(syncs, key=lambda sync: (sync.planned, sync.behaviour))),
            notices=(),
        )


def _with_hands(each: Occupancy) -> bool:
    return bool(each.roles & set(ARMS))


def _on_its_way(own: Floats, goal: Floats, knot: int, coming: Floats, limits: Limits, hinge: int) -> Floats | None:
    """A hinge that is on the other motion by one of the keys to come, or soon where there are none."""
    lands = [(int(place), coming[:k]) for k, place in enumerate(coming[:AHEAD])]
    lands += [(knot + pieces, NOWHERE) for pieces in SOON if not len(coming)]
    for land, passing in lands:
        way = cross_over(own, goal, (knot, land), limits, hinge, passing=passing)
        if way is not None:
            first = ceil(passing[0]) if len(passing) else land
            return way if np.abs(way - goal)[first + LEAST :].max() < SWING else None
    return None
