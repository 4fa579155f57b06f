"""Superposition of a block's motion and a running motion.

Movements of the trunk add up: a nod is added to a gaze, the lean of one reach to that of another. A hand performs one
behaviour after the other: it leaves a hold or a retraction for the next one (co-articulation).
"""

from collections.abc import Sequence
from math import ceil, floor
from typing import Literal

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.limits import Limits
from kinesic.motion.trajectory import KNOT_INTERVAL, KNOT_TOLERANCE
from kinesic.motion.transition import (
    MIN_TRANSITION,
    SAME_ANGLE,
    cross_over,
    extend_controls,
    keep_limits,
    largest_limit_ratios,
)
from kinesic.planning.setup import Setup
from kinesic.realizer.held import held_ramps
from kinesic.realizer.occupancy import ARM_ROLES, MergeFailure, Occupancy, Overlay, Role, arm_hinges

RETURN_GROWTH_FACTOR = 1.5  # duration of a return to rest / that of the previous, infeasible attempt
MAX_RETURN_PIECES = 400  # spline pieces of the longest return to rest
MIN_RETURN_PIECES = 30  # spline pieces of the shortest return to rest
MAX_LIMIT_RATIO = 1.0 + 1e-6  # largest accepted ratio of velocity, acceleration or jerk to its limit


def add_motions(work: Overlay, alone: Flags, setup: Setup, limits: Limits) -> Floats | MergeFailure:
    """Add block and running motion, and project the sum onto joint limits.

    Args:
        work: block and running motion.
        alone: (n,) hinges that keep the running motion only.
        setup: setup with the robot.
        limits: limits of all hinges.

    Returns:
        (k + 3, n) [rad] control points, or the behaviour of the block whose hinge cannot perform both motions.
    """
    names, ramps = setup.robot.skeleton.names, held_ramps(work, setup, limits)
    count = max([len(work.base), *(ceil(ramp.end / KNOT_INTERVAL) + 2 * MIN_TRANSITION for ramp in ramps)])
    base, coming = extend_controls(work.base, count), extend_controls(work.coming, count)
    change = coming - work.start
    change[:, alone] = 0.0
    for ramp in ramps:
        change += ramp.at(count, lead=MIN_TRANSITION)
    controls = np.asarray(base + change)
    rows, moved = (
        np.flatnonzero(np.abs(change).max(axis=1) > SAME_ANGLE),
        np.flatnonzero(np.abs(change).max(axis=0) > SAME_ANGLE),
    )
    if not len(rows):
        return controls
    first, last = max(work.cut, int(rows[0]) - MIN_TRANSITION), min(int(rows[-1]) + 1, len(controls) - MIN_TRANSITION)
    if last - first < MIN_TRANSITION:
        return controls
    over = largest_limit_ratios(controls[first : last + MIN_TRANSITION, moved], limits.part(moved)) > 1.0
    for hinge in moved[over].tolist():
        desired = np.clip(controls[:, hinge], limits.lower[hinge], limits.upper[hinge])
        column = keep_limits(desired, first, last, limits, hinge)
        if column is None:
            return work.trunk_failure(f"{names[hinge]} cannot follow both motions within limits")
        controls[:, hinge] = column
    return controls


def join_hinge_motions(work: Overlay, role: Role, hinge: int, limits: Limits) -> Floats | MergeFailure:
    """Join all motions of one arm hinge in sequence.

    Args:
        work: block and running motion.
        role: role of the hand.
        hinge: index of the arm hinge.
        limits: limits of all hinges.

    Returns:
        (k + 3,) [rad] control points, possibly longer than both motions, or the behaviour of the block without enough
        time for a transition.
    """
    sources = {"base": work.base[:, hinge], "coming": work.coming[:, hinge]}
    column, source, left = sources["base"], "base", float(work.cut * KNOT_INTERVAL)
    done = None
    for stop, of in _stops(work, role):
        if stop.ready < work.cut * KNOT_INTERVAL - KNOT_TOLERANCE:
            column, source = sources[of], of  # the hand is there already
        elif of != source or (done and of == "coming" and _has_finishing_between(work.finishing, role, done, stop)):
            transition = _cross_over_to(column, sources[of], left, stop, limits, hinge)
            if transition is None:
                name = stop.behaviour if of == "coming" or done is None else done.behaviour
                return MergeFailure(name, "its hand has no time for the transition between two behaviours")
            column, source = transition, of
        left, done = max(left, stop.relax), stop
    if source == "base" or done is None:
        return column
    return _return_to_rest(column, done, work, role, limits, hinge)


def _stops(work: Overlay, role: Role) -> list[tuple[Occupancy, Literal["base", "coming"]]]:
    """Return running and new behaviours of a hand, sorted by ready time.

    Empty if the block does not use it.
    """
    block_stops: list[tuple[Occupancy, Literal["base", "coming"]]] = [
        (b, "coming") for b in work.performed if role in b.roles
    ]
    if not block_stops:
        return []
    return sorted(
        [*block_stops, *((b, "base") for b in work.holding if role in b.roles)], key=lambda stop: stop[0].ready
    )


def _has_finishing_between(finishing: Sequence[Occupancy], role: Role, before: Occupancy, after: Occupancy) -> bool:
    return any(role in entry.roles and before.ready <= entry.ready <= after.ready for entry in finishing)


def _cross_over_to(
    current: Floats, after: Floats, left: float, stop: Occupancy, limits: Limits, hinge: int
) -> Floats | None:
    """Blend a hinge's control points into the next stroke, or return None.

    The transition starts where both motions coincide, or otherwise before the next stroke.
    """
    land, soonest = floor(stop.ready / KNOT_INTERVAL + KNOT_TOLERANCE), ceil(left / KNOT_INTERVAL - KNOT_TOLERANCE)
    apart = np.abs(current[soonest : land + MIN_TRANSITION] - after[soonest : land + MIN_TRANSITION]) > SAME_ANGLE
    together = np.flatnonzero(~(apart[:-2] | apart[1:-1] | apart[2:]))
    leaves = (
        [soonest + int(together[-1])]
        if len(together)
        else [max(soonest, floor(stop.begin / KNOT_INTERVAL + KNOT_TOLERANCE)), soonest]
    )
    transitions = (cross_over(current, after, (leave, land), limits, hinge) for leave in leaves)
    return next((transition for transition in transitions if transition is not None), None)


def _return_to_rest(
    column: Floats, done: Occupancy, work: Overlay, role: Role, limits: Limits, hinge: int
) -> Floats | MergeFailure:
    """Return a hinge's control points (m,) [rad] with a return to rest.

    It returns to the rest pose of the running motion, but stays if the block ends in another pose.
    """
    base, start = work.base[:, hinge], work.start[hinge]
    cleanly = not any(role in entry.roles and entry.ready >= done.ready for entry in work.finishing)
    has_other_rest = abs(work.coming[-1, hinge] - start) > SAME_ANGLE
    if cleanly and (has_other_rest or abs(base[-1] - start) <= SAME_ANGLE):
        return column
    rest = np.full(len(base), base[-1])
    leave = ceil(done.relax / KNOT_INTERVAL - KNOT_TOLERANCE)
    pieces = max(MIN_RETURN_PIECES, ceil((done.end - done.relax) / KNOT_INTERVAL))
    while pieces <= MAX_RETURN_PIECES:
        short = max(0, leave + pieces + MIN_TRANSITION - len(column))
        current, after = (np.pad(entry, (0, short), mode="edge") for entry in (column, rest))
        transition = cross_over(current, after, (leave, leave + pieces), limits, hinge)
        if transition is not None:
            return transition
        pieces = ceil(RETURN_GROWTH_FACTOR * pieces)
    return MergeFailure(done.behaviour, "its hand cannot return to rest within its limits")


def overlay_motions(work: Overlay, setup: Setup, limits: Limits) -> Floats | MergeFailure:
    """Combine a block's motion with a running motion.

    Trunk motions are added; motions of each hand are joined in sequence.

    Args:
        work: block and running motion.
        setup: setup with the robot.
        limits: limits of its hinges.

    Returns:
        (k + 3, n) [rad] control points, equal to the running motion before the cut and at rest in the end; or the
        behaviour that cannot be merged.
    """
    is_idle = not work.performed and not work.finishing  # idle motion is added to resting arms
    held_roles = {role for entry in work.holding for role in entry.roles}
    arms = {
        hinge: role
        for role in ARM_ROLES
        if not is_idle or role in held_roles
        for hinge in arm_hinges(role, setup.robot)
    }
    names = setup.robot.skeleton.names
    controls = add_motions(work, np.isin(np.arange(len(names)), list(arms)), setup, limits)
    if isinstance(controls, MergeFailure):
        return controls
    columns = [controls[:, hinge] for hinge in range(controls.shape[1])]
    for hinge, role in arms.items():
        column = join_hinge_motions(work, role, hinge, limits)
        if isinstance(column, MergeFailure):
            return column
        columns[hinge] = column
    count = max(map(len, columns)) + 1
    whole = np.stack([np.pad(column, (0, count - len(column)), mode="edge") for column in columns], axis=1)
    changed = np.flatnonzero((np.abs(whole - extend_controls(work.base, count)) > SAME_ANGLE).any(axis=0))
    over = changed[largest_limit_ratios(whole[work.cut :, changed], limits.part(changed)) > MAX_LIMIT_RATIO]
    if len(over):
        return work.trunk_failure(f"{names[over[0]]} cannot follow both motions within limits")
    return whole
