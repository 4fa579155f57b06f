"""Takes back the motion of interrupted blocks."""

from collections.abc import Sequence
from math import ceil

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.motion.double_s import least_stop
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.motion.transition import (
    FEWEST_PIECES,
    cross_over,
    join_columns,
    keep_limits,
    knot_at,
    largest_shares,
    lengthen,
    roomy,
    shorten,
)
from kinesic.planning.clearance import LEAST_RESERVE, scan_clearance
from kinesic.planning.quick_plan import quintic_duration
from kinesic.planning.setup import Setup
from kinesic.realizer.held import lacking_change
from kinesic.realizer.occupancy import ARMS, Occupancy, arm_hinges

WAIT = 10  # knots that an interruption waits at least, when the way back is not clear
MOST_WAITS = 6  # each twice as long as the one before
RETURN_EASE = 1.5  # times the least time from rest to rest
LONGER = 1.25  # times as long, when a way back is too short
MOST_PIECES = 400  # pieces
FEWEST_RETURN_PIECES = 4  # pieces of a motion


def release_motion(
    running: Trajectory,
    time: float,
    hinges: Flags,
    setup: Setup,
    *,
    layer: Trajectory | None = None,
    others: Sequence[Occupancy] = (),
) -> Trajectory:
    """Takes back the motion of an interrupted block or behaviour; all else goes on as it runs.

    Args:
        running: the motion, within the limits and clear of the body.
        time: [s] from which it may change, at the next knot.
        hinges: (n,) that are given free: see `occupancy.freed_hinges`.
        setup: limits, rest pose and distances.
        layer: what the block adds to the running motion; without it the hinges come to the rest pose.
        others: what else the running motion does.

    Returns:
        The same until the cut, or a little longer where the way back is not clear of the body at once; the running
        motion itself where it never is.
    """
    knot = knot_at(time - running.start)
    local = [each.later(-running.start) for each in others]
    remaining = len(running.controls) - 3 - knot
    waits = [0, *(WAIT * 2**k for k in range(MOST_WAITS) if WAIT * 2**k < remaining)]
    tries = (_from(running, knot + wait, hinges, setup, layer, local) for wait in waits)
    return next((found for found in tries if found is not None), running)


def _from(
    running: Trajectory, knot: int, hinges: Flags, setup: Setup, layer: Trajectory | None, others: Sequence[Occupancy]
) -> Trajectory | None:
    """Takes the block back from a knot on; None where the way is not clear of the body."""
    limits, free = roomy(setup.limits), np.flatnonzero(hinges).tolist()
    if not free:
        return running
    own = lengthen(running.controls, knot + FEWEST_PIECES)
    after = _without(own, layer, others, setup.robot)
    pieces = max(FEWEST_PIECES, ceil(RETURN_EASE * _least(own, after, knot, setup.limits)[free].max() / STEP))
    while pieces <= MOST_PIECES:
        count = max(len(after), knot + pieces + FEWEST_PIECES)
        whole, goal = np.array(lengthen(own, count)), lengthen(after, count)
        land = knot + pieces
        found = join_columns(cross_over(whole[:, hinge], goal[:, hinge], (knot, land), limits, hinge) for hinge in free)
        if found is not None:
            back = np.array(whole)
            back[:, free] = found
            _take_up(back, whole, land, [each for each in others if each.ready > knot * STEP], setup)
            return _checked(back, running, knot, setup)
        pieces = ceil(LONGER * pieces)
    return None


def _least(own: Floats, after: Floats, knot: int, limits: Limits) -> Floats:
    """(n,) [s] least time of each hinge from one motion to another, as if that were at rest."""
    begin = own[knot : knot + FEWEST_PIECES]
    ways = np.abs(begin - after[knot : knot + FEWEST_PIECES]).max(axis=0)
    speed, acceleration = (begin[2] - begin[0]) / (2 * STEP), (begin[0] - 2 * begin[1] + begin[2]) / STEP**2
    stops = least_stop(speed, acceleration, limits.acceleration, limits.jerk)
    return np.maximum(stops, [quintic_duration(float(way), limits, hinge) for hinge, way in enumerate(ways)])


def _without(own: Floats, layer: Trajectory | None, others: Sequence[Occupancy], robot: Robot) -> Floats:
    """Return the motion without the block as controls (k + 3, n) [rad].

    Hands rest, and the trunk ends at the values that other behaviours hold.
    """
    if layer is None:
        return np.repeat(robot.skeleton.rest[None], len(own), axis=0)
    found = own - lengthen(layer.controls, len(own))[: len(own)]
    found = found + lacking_change(found, others, robot)
    found = np.clip(found, np.minimum(own, robot.skeleton.lower), np.maximum(own, robot.skeleton.upper))
    for role in ARMS:
        found[:, arm_hinges(role, robot)] = found[-1, arm_hinges(role, robot)]
    return found


def _take_up(back: Floats, own: Floats, knot: int, others: Sequence[Occupancy], setup: Setup) -> None:
    """Lets arms that came to rest take up what else runs, when that begins; where it is too soon, all goes on."""
    limits = roomy(setup.limits)
    for role in ARMS:
        stop = min((each for each in others if role in each.roles), key=lambda each: each.ready, default=None)
        if stop is None:
            continue
        leave, land = max(knot, int(stop.begin / STEP)), int(stop.ready / STEP)
        hinges = arm_hinges(role, setup.robot)
        ways = join_columns(cross_over(back[:, hinge], own[:, hinge], (leave, land), limits, hinge) for hinge in hinges)
        back[:, hinges] = own[:, hinges] if ways is None else ways


def _checked(found: Floats, running: Trajectory, knot: int, setup: Setup) -> Trajectory | None:
    """Makes control points a motion that keeps the limits; None where it cannot, or comes too near to the body."""
    limits = roomy(setup.limits)
    for hinge in np.flatnonzero(largest_shares(found[knot:], limits) > 1.0).tolist():
        column = keep_limits(found[:, hinge], knot, len(found) - 3, limits, hinge)
        if column is None:
            return None
        found[:, hinge] = column
    motion = Trajectory(sealed(shorten(found)), running.zero, running.start)
    _, clearance = scan_clearance(from_knot(motion.controls, knot), setup.distances)
    near = clearance.distances[clearance.worst] < setup.robot.least_clearance + LEAST_RESERVE
    return None if near else motion


def from_knot(controls: Floats, knot: int) -> Trajectory:
    """Returns the motion from a knot on, on a time that starts there, with at least `FEWEST_RETURN_PIECES` pieces.

    Args:
        controls: (k + 3, n) [rad].
        knot: of k.
    """
    return Trajectory(sealed(controls[max(0, min(knot, len(controls) - 3 - FEWEST_RETURN_PIECES)) :]), 0.0)
