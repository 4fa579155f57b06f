"""Drift: small movements of an arm that holds a pose."""

from collections.abc import Iterator
from itertools import pairwise
from math import radians

import numpy as np

from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.idle import Span
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.offset_bumps import OffsetBump, find_runs

MIN_HOLD_TIME = 0.4  # [s] shorter standstills of an arm do not count as holds
DRIFT_PERIOD = 1.6  # [s] duration of one drift movement in a long hold
FULL_DRIFT_TIME = 1.2  # [s] duration of a full drift movement; shorter ones are proportionally smaller
MAX_DRIFT = radians(0.9)  # [rad] largest drift of a hinge, about 5 mm at the hand
STILL_THRESHOLD = 2e-4  # [rad] change per knot below which an arm holds, even if the trunk turns
MIN_REST_DISTANCE = 0.05  # [rad] smallest distance from the rest pose at which a held arm drifts


def make_drifts(motion: Trajectory, amount: float, robot: Robot, chance: np.random.Generator) -> Iterator[OffsetBump]:
    """Yield small offsets of the arms during all holds away from rest.

    Args:
        motion: with the holds.
        amount: 0 none .. 1 like a person.
        robot: of the motion.
        chance: random generator of the directions.
    """
    for side in SIDES:
        joints = [joint for joint in robot.arm(side).joints if joint not in robot.arm(side).shoulder_lift_joints]
        for begin, end in find_held_spans(motion, side, robot):
            count = max(1, round((end - begin) / DRIFT_PERIOD))
            times = np.linspace(begin, end, count + 1).tolist()
            peak = amount * MAX_DRIFT * min(1.0, (end - begin) / count / FULL_DRIFT_TIME)
            for start, stop in pairwise(times):
                offsets = np.zeros(len(robot.skeleton.hinges))
                offsets[joints] = peak * chance.uniform(-1.0, 1.0, len(joints))
                yield OffsetBump(start, start + float(chance.uniform(0.4, 0.6)) * (stop - start), stop, offsets)


def find_held_spans(motion: Trajectory, side: Side, robot: Robot) -> Iterator[Span]:
    """Yield the spans of poses held away from rest [s].

    They last at least `MIN_HOLD_TIME`.
    """
    joints = list(robot.arm(side).joints)
    angles = motion.controls[:, joints]
    offsets = np.abs(angles - robot.skeleton.rest[joints]).max(axis=1) > MIN_REST_DISTANCE
    is_still = np.append(np.abs(np.diff(angles, axis=0)).max(axis=1) < STILL_THRESHOLD, False) & offsets
    for first, last in find_runs(is_still):
        begin, end = (
            motion.start + knot * KNOT_INTERVAL for knot in (first, last - 1)
        )  # a control point is one knot early
        if end - begin >= MIN_HOLD_TIME:
            yield begin, end
