"""Breath: the trunk goes back and the collar bones rise with every breath, from the first moment to the last.

The neck turns back by as much, so that the face stays level.
"""

from collections.abc import Iterator
from math import radians

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.idle import BREATH, IDLE_MARGIN, LEAST_PAUSE, RISE, Span
from kinesic.planning.secondary.swells import Swell
from kinesic.planning.torso import set_turn

LIFT = radians(0.5)  # that collar bones rise with a breath at most
IN = 0.4  # share of a breath that goes in
SHALLOW = 0.7  # of the deepest breath
UNEVEN = 0.15  # by which breaths differ in time at most


def breaths(span: Span, amount: float, robot: Robot, chance: np.random.Generator) -> Iterator[Swell]:
    """Breathes through a span; trunk and collar bones each have their own swells.

    Args:
        span: [s] of the motion; no breath is worth it where there is too little.
        amount: 0 none .. 1 as people do.
        robot: whose trunk breathes; what it lacks of trunk and collar bones stays still.
        chance: how long and how deep each breath is.
    """
    begin, end = span[0] + IDLE_MARGIN, span[1] - IDLE_MARGIN
    if end - begin < LEAST_PAUSE:
        return
    parts = [_trunk(robot), *(_collar_bone(robot.arm(side).lifting, robot) for side in SIDES)]
    count = max(1, round((end - begin) / BREATH))
    shares = 1.0 + UNEVEN * chance.uniform(-1.0, 1.0, count)
    times = begin + (end - begin) * np.append(0.0, np.cumsum(shares)) / shares.sum()
    for one, other in zip(times[:-1].tolist(), times[1:].tolist(), strict=True):
        depth = amount * float(chance.uniform(SHALLOW, 1.0))
        for away in parts:
            if away.any():
                yield Swell(one, one + IN * (other - one), other, depth * away)


def _trunk(robot: Robot) -> Floats:
    away = np.zeros(len(robot.skeleton.hinges))
    if robot.joints("torso"):
        set_turn(robot, "torso", np.array([0.0, -RISE, 0.0]), away)
        set_turn(robot, "neck", np.array([0.0, RISE, 0.0]), away)
    return away


def _collar_bone(lifting: tuple[int, ...], robot: Robot) -> Floats:
    away = np.zeros(len(robot.skeleton.hinges))
    away[list(lifting)] = LIFT
    return away
