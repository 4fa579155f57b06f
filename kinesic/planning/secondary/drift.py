"""Small random movements (drift) of an arm that holds a pose."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from math import radians
from types import MappingProxyType

import numpy as np

from kinesic.body.arrays import Floats, find_runs
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.idle import Span
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.offset_bumps import OffsetBump

MIN_HOLD_TIME = 0.3  # [s] shorter standstills of an arm do not count as holds
DRIFT_PERIOD = 1.0  # [s] duration of one drift movement in a long hold
FULL_DRIFT_TIME = 0.9  # [s] duration of a full drift movement; shorter movements are proportionally smaller
MAX_DRIFT = radians(5.0)  # [rad] largest drift of an arm hinge if the hand is free, about 30 mm at the hand
MAX_TOUCH_DRIFT = radians(0.9)  # [rad] largest drift of an arm hinge if the hand touches or points, about 5 mm
STILL_THRESHOLD = 2e-4  # [rad] angle change per knot interval below which an arm holds, even if the trunk turns
TOUCH_MARGIN = 0.3  # [s] time between a hold and a touch up to which the hand counts as touching
RANGE_MARGIN = 1e-3  # [rad] smallest distance of a drifting arm from the joint limits
NO_TOUCHES: Mapping[Side, Sequence[float]] = MappingProxyType({})  # default: no touch times [s], empty
MIN_REST_DISTANCE = 0.05  # [rad] smallest distance from the rest pose at which a held arm drifts


def make_drifts(
    motion: Trajectory,
    amount: float,
    robot: Robot,
    chance: np.random.Generator,
    touching: Mapping[Side, Sequence[float]] = NO_TOUCHES,
) -> Iterator[OffsetBump]:
    """Yield small offsets of the arms during all holds away from rest.

    A person's held hand never stops: it sinks, rises and turns a little.

    Args:
        motion: with the holds.
        amount: 0 none .. 1 like a person.
        robot: of the motion.
        chance: random generator of the directions.
        touching: [s] performance times at which a hand touches the body or points at a place.
    """
    for side in robot.sides:
        joints = [joint for joint in robot.arm(side).joints if joint not in robot.arm(side).shoulder_lift_joints]
        for begin, end in find_held_spans(motion, side, robot):
            count = max(1, round((end - begin) / DRIFT_PERIOD))
            times = np.linspace(begin, end, count + 1).tolist()
            is_touching = any(begin - TOUCH_MARGIN <= time <= end + TOUCH_MARGIN for time in touching.get(side, ()))
            peak = (
                amount
                * (MAX_TOUCH_DRIFT if is_touching else MAX_DRIFT)
                * min(1.0, (end - begin) / count / FULL_DRIFT_TIME)
            )
            for start, stop in pairwise(times):
                offsets = np.zeros(len(robot.skeleton.hinges))
                offsets[joints] = peak * chance.uniform(-1.0, 1.0, len(joints))
                offsets = _turn_inside(offsets, motion.sample(np.array([start]))[0][0], robot)
                yield OffsetBump(start, start + float(chance.uniform(0.4, 0.6)) * (stop - start), stop, offsets)


def _turn_inside(offsets: Floats, angles: Floats, robot: Robot) -> Floats:
    """Reverse and clip offsets (n,) [rad] that would leave the joint ranges."""
    lower, upper = robot.skeleton.lower + RANGE_MARGIN, robot.skeleton.upper - RANGE_MARGIN
    is_outside = (angles + offsets < lower) | (angles + offsets > upper)
    turned = np.where(is_outside, -offsets, offsets)
    inside = np.clip(angles + turned, np.minimum(lower, angles), np.maximum(upper, angles)) - angles
    return np.where(offsets == 0.0, 0.0, inside)


def find_held_spans(motion: Trajectory, side: Side, robot: Robot) -> Iterator[Span]:
    """Yield the spans of poses held away from rest [s].

    They last at least `MIN_HOLD_TIME`.
    """
    joints = list(robot.arm(side).joints)
    angles = motion.controls[:, joints]
    offsets = np.abs(angles - robot.skeleton.rest[joints]).max(axis=1) > MIN_REST_DISTANCE
    is_still = np.append(np.abs(np.diff(angles, axis=0)).max(axis=1) < STILL_THRESHOLD, False) & offsets
    for first, after in find_runs(is_still):
        begin, end = (
            motion.start + knot * KNOT_INTERVAL for knot in (first, after - 2)
        )  # a control point is one knot early
        if end - begin >= MIN_HOLD_TIME:
            yield begin, end
