"""Breathing: periodic motion of trunk and collar bones.

The neck compensates, so that the face stays level.
"""

from collections.abc import Iterator
from math import radians

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.idle import BREATH_PERIOD, IDLE_MARGIN, MIN_PAUSE, RISE_ANGLE, Span
from kinesic.planning.secondary.offset_bumps import OffsetBump
from kinesic.planning.torso import set_turn

MAX_COLLAR_BONE_LIFT = radians(0.5)  # [rad] rise of the collar bones in the deepest breath
INHALATION_FRACTION = 0.4  # fraction of a breath spent inhaling
MIN_BREATH_DEPTH = 0.7  # depth of the shallowest breath, relative to the deepest
PERIOD_VARIATION = 0.15  # relative variation of the breath duration


def make_breaths(span: Span, amount: float, robot: Robot, chance: np.random.Generator) -> Iterator[OffsetBump]:
    """Yield the breathing offsets of trunk and collar bones.

    Args:
        span: [s] of the motion; short spans have no breath.
        amount: 0 none .. 1 like a person.
        robot: parts that it lacks are left out.
        chance: random generator of lengths and depths.
    """
    begin, end = span[0] + IDLE_MARGIN, span[1] - IDLE_MARGIN
    if end - begin < MIN_PAUSE:
        return
    parts = [_trunk(robot), *(_collar_bone(robot.arm(side).shoulder_lift_joints, robot) for side in SIDES)]
    count = max(1, round((end - begin) / BREATH_PERIOD))
    lengths = 1.0 + PERIOD_VARIATION * chance.uniform(-1.0, 1.0, count)
    times = begin + (end - begin) * np.append(0.0, np.cumsum(lengths)) / lengths.sum()
    for start, stop in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
        depth = amount * float(chance.uniform(MIN_BREATH_DEPTH, 1.0))
        for offsets in parts:
            if offsets.any():
                yield OffsetBump(start, start + INHALATION_FRACTION * (stop - start), stop, depth * offsets)


def _trunk(robot: Robot) -> Floats:
    offsets = np.zeros(len(robot.skeleton.hinges))
    if robot.joints("torso"):
        set_turn(robot, "torso", np.array([0.0, -RISE_ANGLE, 0.0]), offsets)
        set_turn(robot, "neck", np.array([0.0, RISE_ANGLE, 0.0]), offsets)
    return offsets


def _collar_bone(lifting: tuple[int, ...], robot: Robot) -> Floats:
    offsets = np.zeros(len(robot.skeleton.hinges))
    offsets[list(lifting)] = MAX_COLLAR_BONE_LIFT
    return offsets
