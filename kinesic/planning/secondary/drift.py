"""Drift: an arm that holds a pose does not freeze, but strays from it a little and comes back before it leaves."""

from collections.abc import Iterator
from itertools import pairwise
from math import radians

import numpy as np

from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.idle import Span
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.secondary.swells import Swell, runs

LEAST_HOLD = 0.4  # [s] that is seen as one
ONCE = 1.6  # [s] that an arm takes to stray and come back, where it holds for long
WHOLE_DRIFT = 1.2  # [s] in which it strays as far as it may; in less time less far
LARGEST_DRIFT = radians(0.9)  # that one hinge strays at most: hands by some 5 mm
CARRIED_ARM = 2e-4  # [rad] from knot to knot: an arm whose hand waits goes along as the trunk turns beneath it
AWAY = 0.05  # [rad] from rest: an arm that hangs goes along with the trunk as it is


def drifts(motion: Trajectory, amount: float, robot: Robot, chance: np.random.Generator) -> Iterator[Swell]:
    """Lets arms stray in all poses that they hold away from their rest.

    Args:
        motion: in which they do.
        amount: 0 not at all .. 1 as people do.
        robot: of the motion.
        chance: where to.
    """
    for side in SIDES:
        joints = [joint for joint in robot.arm(side).joints if joint not in robot.arm(side).lifting]
        for begin, end in held_spans(motion, side, robot):
            count = max(1, round((end - begin) / ONCE))
            times = np.linspace(begin, end, count + 1).tolist()
            farthest = amount * LARGEST_DRIFT * min(1.0, (end - begin) / count / WHOLE_DRIFT)
            for one, other in pairwise(times):
                away = np.zeros(len(robot.skeleton.hinges))
                away[joints] = farthest * chance.uniform(-1.0, 1.0, len(joints))
                yield Swell(one, one + float(chance.uniform(0.4, 0.6)) * (other - one), other, away)


def held_spans(motion: Trajectory, side: Side, robot: Robot) -> Iterator[Span]:
    """Finds when an arm stands still away from its rest, for `LEAST_HOLD` or longer [s]."""
    joints = list(robot.arm(side).joints)
    angles = motion.controls[:, joints]
    away = np.abs(angles - robot.skeleton.rest[joints]).max(axis=1) > AWAY
    still = np.append(np.abs(np.diff(angles, axis=0)).max(axis=1) < CARRIED_ARM, False) & away
    for first, last in runs(still):
        begin, end = (motion.start + knot * STEP for knot in (first, last - 1))  # a control point lies a knot ahead
        if end - begin >= LEAST_HOLD:
            yield begin, end
