"""Removal of interrupted behaviours from a running motion."""

from collections.abc import Sequence
from math import ceil

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.motion.double_s import least_stop
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.motion.transition import (
    MIN_TRANSITION,
    cross_over,
    extend_controls,
    join_columns,
    keep_limits,
    knot_at,
    largest_limit_ratios,
    trim_final_rest,
    widen_limits,
)
from kinesic.planning.clearance import MIN_LAG_RESERVE, scan_clearance
from kinesic.planning.impact_limits import find_worst_excess
from kinesic.planning.quick_plan import compute_quintic_duration
from kinesic.planning.setup import Setup
from kinesic.realizer.held import offset_to_held_posture
from kinesic.realizer.occupancy import ARM_ROLES, Occupancy, arm_hinges

MIN_RELEASE_DELAY = 10  # [knots] first delay tried for a return to rest that would collide
MAX_DELAY_DOUBLINGS = 6  # largest number of tried delays of a return to rest, each twice the previous one
RETURN_DURATION_FACTOR = 1.5  # return duration relative to the minimum-time rest-to-rest profile
RETURN_GROWTH_FACTOR = 1.25  # duration of a return to rest / that of the previous, infeasible attempt
MAX_RETURN_PIECES = 400  # spline pieces of the longest return
MIN_MOTION_PIECES = 4  # spline pieces of the shortest motion


def release_motion(
    running: Trajectory,
    time: float,
    hinges: Flags,
    setup: Setup,
    *,
    layer: Trajectory | None = None,
    others: Sequence[Occupancy] = (),
) -> Trajectory:
    """Remove an interrupted block or behaviour from a running motion.

    Args:
        running: running motion, within limits and without collisions.
        time: time [s] from which it may change, rounded up to a knot.
        hinges: (n,) hinges to release; see `occupancy.freed_hinges`.
        setup: limits, rest pose and distances.
        layer: offsets that the block added to the running motion; without it, the hinges return to the rest pose.
        others: other occupancies of the running motion.

    Returns:
        The running motion up to the cut, or longer if the return path would collide; the whole running motion if there
        is no collision-free return.
    """
    knot = knot_at(time - running.start)
    local = [entry.shifted(-running.start) for entry in others]
    remaining = len(running.controls) - 3 - knot
    waits = [0, *(MIN_RELEASE_DELAY * 2**k for k in range(MAX_DELAY_DOUBLINGS) if MIN_RELEASE_DELAY * 2**k < remaining)]
    motions = (_release_from(running, knot + wait, hinges, setup, layer, local) for wait in waits)
    return next((motion for motion in motions if motion is not None), running)


def _release_from(
    running: Trajectory, knot: int, hinges: Flags, setup: Setup, layer: Trajectory | None, others: Sequence[Occupancy]
) -> Trajectory | None:
    """Return the motion with hinges released from a knot on, or None.

    None if no tried path avoids collisions and keeps the policy of contacts with people.
    """
    limits, free = widen_limits(setup.limits), np.flatnonzero(hinges).tolist()
    if not free:
        return running
    current = extend_controls(running.controls, knot + MIN_TRANSITION)
    after = motion_without_block(current, layer, others, setup.robot)
    slowest = _minimum_times(current, after, knot, setup.limits)[free].max()
    pieces = max(MIN_TRANSITION, ceil(RETURN_DURATION_FACTOR * slowest / KNOT_INTERVAL))
    while pieces <= MAX_RETURN_PIECES:
        count = max(len(after), knot + pieces + MIN_TRANSITION)
        whole, goal = np.array(extend_controls(current, count)), extend_controls(after, count)
        land = knot + pieces
        columns = join_columns(
            cross_over(whole[:, hinge], goal[:, hinge], (knot, land), limits, hinge) for hinge in free
        )
        if columns is not None:
            back = np.array(whole)
            back[:, free] = columns
            _rejoin_arms(back, whole, land, [entry for entry in others if entry.ready > knot * KNOT_INTERVAL], setup)
            motion = certified_motion(back, running, knot, setup)
            excess = None if motion is None else find_worst_excess(motion, running, setup)
            if excess is None:
                return motion
            pieces = ceil(excess[1] * pieces)  # forces are inversely proportional to the duration
        pieces = ceil(RETURN_GROWTH_FACTOR * pieces)
    return None


def _minimum_times(current: Floats, after: Floats, knot: int, limits: Limits) -> Floats:
    """Return the minimum transition time (n,) [s] of each hinge.

    The goal motion is assumed to rest.
    """
    begin = current[knot : knot + MIN_TRANSITION]
    distances = np.abs(begin - after[knot : knot + MIN_TRANSITION]).max(axis=0)
    speed, acceleration = (
        (begin[2] - begin[0]) / (2 * KNOT_INTERVAL),
        (begin[0] - 2 * begin[1] + begin[2]) / KNOT_INTERVAL**2,
    )
    stops = least_stop(speed, acceleration, limits.acceleration, limits.jerk)
    return np.maximum(
        stops, [compute_quintic_duration(float(distance), limits, hinge) for hinge, distance in enumerate(distances)]
    )


def motion_without_block(
    current: Floats, layer: Trajectory | None, others: Sequence[Occupancy], robot: Robot
) -> Floats:
    """Return the control points (k + 3, n) [rad] without the block.

    Hands rest, and the trunk ends at the values that other behaviours hold.

    Args:
        current: (k + 3, n) [rad] control points of the running motion.
        layer: offsets that the block added to it; without it, all hinges rest.
        others: other occupancies, in times since the start of the motion.
        robot: robot of the motion.
    """
    if layer is None:
        return np.repeat(robot.skeleton.rest[None], len(current), axis=0)
    controls = current - extend_controls(layer.controls, len(current))[: len(current)]
    controls = controls + offset_to_held_posture(controls, others, robot)
    controls = np.clip(controls, np.minimum(current, robot.skeleton.lower), np.maximum(current, robot.skeleton.upper))
    for role in ARM_ROLES:
        controls[:, arm_hinges(role, robot)] = controls[-1, arm_hinges(role, robot)]
    return controls


def _rejoin_arms(back: Floats, current: Floats, knot: int, others: Sequence[Occupancy], setup: Setup) -> None:
    """Blend resting arms back into the running motion before their next behaviour.

    Without enough time for that, the arm keeps the running motion.
    """
    limits = widen_limits(setup.limits)
    for role in ARM_ROLES:
        stop = min((entry for entry in others if role in entry.roles), key=lambda entry: entry.ready, default=None)
        if stop is None:
            continue
        leave, land = max(knot, int(stop.begin / KNOT_INTERVAL)), int(stop.ready / KNOT_INTERVAL)
        hinges = arm_hinges(role, setup.robot)
        columns = join_columns(
            cross_over(back[:, hinge], current[:, hinge], (leave, land), limits, hinge) for hinge in hinges
        )
        back[:, hinges] = current[:, hinges] if columns is None else columns


def certified_motion(controls: Floats, running: Trajectory, knot: int, setup: Setup) -> Trajectory | None:
    """Return a feasible, collision-free motion for given control points, or None.

    Args:
        controls: (k + 3, n) [rad]; hinges beyond their limits are corrected in place.
        running: motion with the same start.
        knot: first knot that may change.
        setup: limits and distances.
    """
    limits = widen_limits(setup.limits)
    for hinge in np.flatnonzero(largest_limit_ratios(controls[knot:], limits) > 1.0).tolist():
        column = keep_limits(controls[:, hinge], knot, len(controls) - 3, limits, hinge)
        if column is None:
            return None
        controls[:, hinge] = column
    motion = Trajectory(sealed(trim_final_rest(controls)), running.zero, running.start)
    _, clearance = scan_clearance(motion_from_knot(motion.controls, knot), setup.distances)
    near = clearance.distances[clearance.worst] < setup.robot.min_clearance + MIN_LAG_RESERVE
    return None if near else motion


def motion_from_knot(controls: Floats, knot: int) -> Trajectory:
    """Return the motion from a knot on, with time starting at zero.

    It has at least `MIN_MOTION_PIECES` pieces.

    Args:
        controls: (k + 3, n) [rad] control points.
        knot: index of the knot, 0..k.
    """
    return Trajectory(sealed(controls[max(0, min(knot, len(controls) - 3 - MIN_MOTION_PIECES)) :]), 0.0)
