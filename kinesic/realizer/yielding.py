"""Motion of the arms of a block that yields to a person.

The arms decelerate, hold and return.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.motion.bspline import at_knots
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.motion.transition import (
    MIN_TRANSITION,
    cross_over,
    extend_controls,
    join_columns,
    knot_at,
    widen_limits,
)
from kinesic.planning.setup import Setup
from kinesic.realizer.occupancy import ARM_ROLES, Occupancy, arm_hinges
from kinesic.realizer.release import certified_motion, motion_without_block, release_motion

DECELERATION_DURATION = 0.2  # [s] shortest duration of the deceleration
DECELERATION_GROWTH = 1.3  # duration of a deceleration / that of the previous, infeasible attempt
MAX_DECELERATION_DURATION = 0.7  # [s] longest duration of the deceleration; faster arms return to rest without a hold
MAX_YIELDING_RETRACTION = 0.3  # [s] longest remaining retraction that an arm completes without a hold
ARM_HOLD_DURATION = 0.3  # [s] hold of the arms between deceleration and return


def yield_motion(
    running: Trajectory,
    time: float,
    hinges: Flags,
    setup: Setup,
    *,
    layer: Trajectory | None = None,
    others: Sequence[Occupancy] = (),
) -> Trajectory:
    """Remove a block from a running motion after its arms hold still.

    The trunk returns at once. Arms that another behaviour uses later, or that would collide, return without a hold.

    Args:
        running: running motion, within limits and without collisions.
        time: time [s] from which it may change, rounded up to a knot.
        hinges: (n,) hinges to release; see `occupancy.freed_hinges`.
        setup: limits, rest pose and distances.
        layer: offsets that the block added to the running motion; without it, the hinges return to the rest pose.
        others: other occupancies of the running motion.
    """
    knot, arms = knot_at(time - running.start), hinges & _holding_arms(time, others, setup)
    stopping = [arms] if others else [arms, hinges]  # a hand near the head may need a trunk that stops with it
    for stopped in stopping if arms.any() else ():
        held = _hold_still(running, knot, np.flatnonzero(stopped).tolist(), setup)
        if held is None:
            continue
        holding, hold_end = held
        local = [entry.shifted(-running.start) for entry in others]
        current = extend_controls(running.controls, knot + MIN_TRANSITION)
        rest = motion_without_block(current, layer, local, setup.robot)[-1]
        holding = release_motion(holding, time, hinges & ~stopped, setup, layer=layer, others=others)
        to_rest = replace(holding, controls=sealed(np.where(stopped, holding.controls - rest, 0.0)))
        returning = release_motion(holding, hold_end, stopped, setup, layer=to_rest, others=others)
        if returning is not holding:  # otherwise, no return is free of collisions
            return returning
    return release_motion(running, time, hinges, setup, layer=layer, others=others)


def _holding_arms(time: float, others: Sequence[Occupancy], setup: Setup) -> Flags:
    """Flag the hinges (n,) of arms that no other behaviour uses later."""
    arms = np.zeros(len(setup.limits.lower), dtype=np.bool_)
    for role in ARM_ROLES:
        arms[list(arm_hinges(role, setup.robot))] = not any(
            role in entry.roles and entry.end > time for entry in others
        )
    return arms


def _hold_still(running: Trajectory, knot: int, hinges: Sequence[int], setup: Setup) -> tuple[Trajectory, float] | None:
    """Return the motion with stopped hinges, and the hold's end [s].

    None if they are too fast, or would collide.
    """
    limits, duration = widen_limits(setup.limits), DECELERATION_DURATION
    while duration <= MAX_DECELERATION_DURATION:
        pieces = ceil(duration / KNOT_INTERVAL)
        count = max(len(running.controls), knot + pieces + MIN_TRANSITION)
        whole = np.array(extend_controls(running.controls, count))
        stops = np.clip(_stop_angles(whole[knot : knot + 3], duration), limits.lower, limits.upper)
        columns = join_columns(
            cross_over(whole[:, hinge], np.full(count, stops[hinge]), (knot, knot + pieces), limits, hinge)
            for hinge in hinges
        )
        if columns is not None:
            whole[:, hinges] = columns
            motion = certified_motion(whole, running, knot, setup)
            end = (knot + pieces) * KNOT_INTERVAL + ARM_HOLD_DURATION
            return None if motion is None else (motion, running.start + end)
        duration *= DECELERATION_GROWTH
    return None


def _stop_angles(controls: Floats, duration: float) -> Floats:
    """Return the final angles (n,) [rad] of a least-jerk deceleration.

    Args:
        controls: (3, n) [rad] control points at its start.
        duration: duration [s] of the deceleration.
    """
    velocity = (controls[2] - controls[0]) / (2 * KNOT_INTERVAL)
    acceleration = (controls[0] - 2 * controls[1] + controls[2]) / KNOT_INTERVAL**2
    return np.asarray(at_knots(controls)[0] + velocity * duration / 2 + acceleration * duration**2 / 12)
