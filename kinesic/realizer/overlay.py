"""Lays one block's motion over a running one.

Movements of the trunk add up: a nod goes over a gaze, the lean of one reach over that of another. A hand does one
work after the other: it leaves a hold or a retraction for what comes next (co-articulation).
"""

from collections.abc import Sequence
from math import ceil, floor
from typing import Literal

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.limits import Limits
from kinesic.motion.trajectory import EARLY, STEP
from kinesic.motion.transition import FEWEST_PIECES, SAME_ANGLE, cross_over, keep_limits, largest_shares, lengthen
from kinesic.planning.setup import Setup
from kinesic.realizer.held import HELD_ROLES, held_ramps
from kinesic.realizer.occupancy import ARMS, MergeFailure, Occupancy, Overlay, Role, arm_hinges

AGAIN = 1.5  # times as long, when a way back to rest is too short
MOST_PIECES = 400  # pieces of a way back to rest
LEAST_BACK = 30  # pieces
LIMIT_TOLERANCE = 1.0 + 1e-6  # share of a limit


def add_motions(work: Overlay, alone: Flags, setup: Setup, limits: Limits) -> Floats | MergeFailure:
    """Adds both motions; where the sum exceeds a limit, the nearest one that does not.

    Args:
        work: the block and the running motion.
        alone: (n,) hinges of which only what runs counts.
        setup: the robot.
        limits: of all hinges.

    Returns:
        (k + 3, n) [rad] control points; a behaviour of the block where a hinge cannot do both.
    """
    names, ramps = setup.robot.skeleton.names, held_ramps(work, setup, limits)
    count = max([len(work.base), *(ceil(ramp.end / STEP) + 2 * FEWEST_PIECES for ramp in ramps)])
    base, coming = lengthen(work.base, count), lengthen(work.coming, count)
    change = coming - work.start
    change[:, alone] = 0.0
    for dropped in work.dropped:
        if not any(dropped.holds(role) for role in HELD_ROLES):
            _flatten(change, dropped, work, limits)
    for ramp in ramps:
        change += ramp.at(count, lead=FEWEST_PIECES)
    found = np.asarray(base + change)
    rows, moved = (
        np.flatnonzero(np.abs(change).max(axis=1) > SAME_ANGLE),
        np.flatnonzero(np.abs(change).max(axis=0) > SAME_ANGLE),
    )
    if not len(rows):
        return found
    first, last = max(work.cut, int(rows[0]) - FEWEST_PIECES), min(int(rows[-1]) + 1, len(found) - FEWEST_PIECES)
    if last - first < FEWEST_PIECES:
        return found
    over = largest_shares(found[first : last + FEWEST_PIECES, moved], limits.part(moved)) > 1.0
    for hinge in moved[over].tolist():
        desired = np.clip(found[:, hinge], limits.lower[hinge], limits.upper[hinge])
        column = keep_limits(desired, first, last, limits, hinge)
        if column is None:
            return work.trunk_failure(f"{names[hinge]} cannot do both within its limits")
        found[:, hinge] = column
    return found


def _flatten(change: Floats, dropped: Occupancy, work: Overlay, limits: Limits) -> None:
    """Takes the part of a behaviour that is left out away from what a block changes (k + 3, n) [rad]."""
    begin, end = max(0, floor(dropped.begin / STEP)), min(ceil(dropped.end / STEP), len(change) - FEWEST_PIECES)
    beside = [each for each in work.performed if each.begin < dropped.end and dropped.begin < each.end]
    own = dropped.hinges & ~np.any([each.hinges for each in beside], axis=0) if beside else np.ones_like(dropped.hinges)
    for hinge in np.flatnonzero(own).tolist() if begin < end else ():
        column = change[:, hinge]
        way = cross_over(column, np.full(len(column), column[end + 1]), (begin, end), limits, hinge)
        if way is not None:
            change[begin : end + 1, hinge] = way[begin : end + 1]


def join_hinge_motions(work: Overlay, role: Role, hinge: int, limits: Limits) -> Floats | MergeFailure:
    """Leads one hinge of an arm through all that its hand has to do.

    Args:
        work: the block and the running motion.
        role: of the hand.
        hinge: of its arm.
        limits: of all hinges.

    Returns:
        (k + 3,) [rad] control points, maybe of more pieces than both motions; the behaviour of the block for
        which there is no time between two works.
    """
    sources = {"base": work.base[:, hinge], "coming": work.coming[:, hinge]}
    column, source, left = sources["base"], "base", float(work.cut * STEP)
    done = None
    for stop, of in _stops(work, role):
        if stop.ready < work.cut * STEP - EARLY:
            column, source = sources[of], of  # it is there already
        elif of != source or (done and of == "coming" and _between(work.dropped, role, done, stop)):
            way = _led(column, sources[of], left, stop, limits, hinge)
            if way is None:
                name = stop.behaviour if of == "coming" or done is None else done.behaviour
                return MergeFailure(name, "its hand has not the time to come from one work to the next")
            column, source = way, of
        left, done = max(left, stop.relax), stop
    if source == "base" or done is None:
        return column
    return _return(column, done, work, role, limits, hinge)


def _stops(work: Overlay, role: Role) -> list[tuple[Occupancy, Literal["base", "coming"]]]:
    """What a hand has to do, in order; empty where the block does not need it."""
    own: list[tuple[Occupancy, Literal["base", "coming"]]] = [(b, "coming") for b in work.performed if role in b.roles]
    if not own:
        return []
    return sorted([*own, *((b, "base") for b in work.holding if role in b.roles)], key=lambda stop: stop[0].ready)


def _between(dropped: Sequence[Occupancy], role: Role, before: Occupancy, after: Occupancy) -> bool:
    return any(role in each.roles and before.ready <= each.ready <= after.ready for each in dropped)


def _led(own: Floats, after: Floats, left: float, stop: Occupancy, limits: Limits, hinge: int) -> Floats | None:
    """Goes over from one work to the next where both meet, else when the next begins, or once the one gives way."""
    land, soonest = floor(stop.ready / STEP + EARLY), ceil(left / STEP - EARLY)
    apart = np.abs(own[soonest : land + FEWEST_PIECES] - after[soonest : land + FEWEST_PIECES]) > SAME_ANGLE
    together = np.flatnonzero(~(apart[:-2] | apart[1:-1] | apart[2:]))
    leaves = (
        [soonest + int(together[-1])] if len(together) else [max(soonest, floor(stop.begin / STEP + EARLY)), soonest]
    )
    ways = (cross_over(own, after, (leave, land), limits, hinge) for leave in leaves)
    return next((way for way in ways if way is not None), None)


def _return(
    column: Floats, done: Occupancy, work: Overlay, role: Role, limits: Limits, hinge: int
) -> Floats | MergeFailure:
    """Brings a hand back to where it rested before its last work, unless the block ends elsewhere."""
    base, coming = work.base[:, hinge], work.coming[:, hinge]
    cleanly = not any(role in each.roles and each.ready >= done.ready for each in work.dropped)
    other_rest = abs(coming[-1] - work.start[hinge]) > SAME_ANGLE
    if cleanly and (other_rest or abs(base[-1] - coming[-1]) <= SAME_ANGLE):
        return column
    rest = np.full(len(base), base[-1])
    leave = ceil(done.relax / STEP - EARLY)
    pieces = max(LEAST_BACK, ceil((done.end - done.relax) / STEP))
    while pieces <= MOST_PIECES:
        short = max(0, leave + pieces + FEWEST_PIECES - len(column))
        own, after = (np.pad(each, (0, short), mode="edge") for each in (column, rest))
        way = cross_over(own, after, (leave, leave + pieces), limits, hinge)
        if way is not None:
            return way
        pieces = ceil(AGAIN * pieces)
    return MergeFailure(done.behaviour, "its hand has no way back to rest within its limits")


def overlay(work: Overlay, setup: Setup, limits: Limits) -> Floats | MergeFailure:
    """Lays a block's motion over a running one: sums for the trunk, one work after the other for each hand.

    Args:
        work: the block and the running motion.
        setup: the robot.
        limits: of its hinges.

    Returns:
        (k + 3, n) [rad] control points, until the cut those of what runs, and at rest in the end; or the behaviour that
        has no way.
    """
    arms = {hinge: role for role in ARMS for hinge in arm_hinges(role, setup.robot)}
    names = setup.robot.skeleton.names
    found = add_motions(work, np.isin(np.arange(len(names)), list(arms)), setup, limits)
    if isinstance(found, MergeFailure):
        return found
    columns = [found[:, hinge] for hinge in range(found.shape[1])]
    for hinge, role in arms.items():
        column = join_hinge_motions(work, role, hinge, limits)
        if isinstance(column, MergeFailure):
            return column
        columns[hinge] = column
    count = max(map(len, columns)) + 1
    whole = np.stack([np.pad(column, (0, count - len(column)), mode="edge") for column in columns], axis=1)
    changed = np.flatnonzero((np.abs(whole - lengthen(work.base, count)) > SAME_ANGLE).any(axis=0))
    over = changed[largest_shares(whole[work.cut :, changed], limits.part(changed)) > LIMIT_TOLERANCE]
    if len(over):
        return work.trunk_failure(f"{names[over[0]]} cannot do both within its limits")
    return whole
