"""What an arm is asked beside a position: a full pose, both hands with the torso, targets out of reach."""

import numpy as np
from numpy.random import default_rng

from kinesic.bench.figure import Figure
from kinesic.bench.ik.best_posture import best_posture
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot
from kinesic.ik.pose import solve_pose
from kinesic.ik.solve import solve
from kinesic.ik.two_hands import reach_both

POSES, PAIRS, BEYOND = 1000, 150, 40
MM = 1e-3
NEAR_BEST = 5e-3  # [m]


def bench() -> list[Figure]:
    """Shares of tasks that are met."""
    robot = Robot.load()
    return [_poses(robot), *_pairs(robot), _beyond(robot)]


def _poses(robot: Robot) -> Figure:
    chain, chance, met = robot.arms["l"], default_rng(11), 0
    for _ in range(POSES):
        rotations, centres = chain.frames(chance.uniform(chain.lower, chain.upper))
        met += solve_pose(chain, centres[-2], rotations[-1], start=chain.rest).reached
    return Figure("ik.pose", met / POSES, "share", 0.999, "higher", f"{POSES} poses of postures inside the limits")


def _pairs(robot: Robot) -> list[Figure]:
    skeleton, chance = robot.skeleton, default_rng(12)
    solved = []
    for _ in range(PAIRS):
        origins = skeleton.frames(chance.uniform(skeleton.lower, skeleton.upper)).origins
        solved.append(reach_both(robot, {side: origins[robot.arm(side).wrist] for side in SIDES}, start=skeleton.rest))
    share = float(np.mean([found.reached for found in solved]))
    travel = float(np.mean([found.torso_travel for found in solved]))
    return [
        Figure("ik.both_hands", share, "share", 0.97, "higher", f"{PAIRS} pairs with torso"),
        Figure("ik.both_hands_torso_travel", travel, "rad", None, "lower"),
    ]


def _beyond(robot: Robot) -> Figure:
    """Targets out of reach, against the best of many starts by an interior-point method."""
    chain, chance, near = robot.arms["l"], default_rng(13), 0
    shoulder = chain.frames(chain.rest)[1][1]
    for _ in range(BEYOND):
        away = chance.normal(size=3)
        target = Reach(shoulder + chance.uniform(1.1, 1.8) * robot.arm_length * away / np.linalg.norm(away))
        best = best_posture(chain, target).residual
        near += solve(chain, target, start=chain.rest).residual - best <= NEAR_BEST
    return Figure(
        "ik.unreachable", near / BEYOND, "share", 0.95, "higher", f"{BEYOND} targets, within 5 mm of the best"
    )
