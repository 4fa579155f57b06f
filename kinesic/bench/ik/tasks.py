"""What an arm is asked beside a position: a full pose, both hands with the torso, targets out of reach.

The reference of the last is the best posture for a reach, by IPOPT from many beginnings (CasADi). It is slow and knows
nothing of springs, branches or closed forms: what it finds is what the solver is measured by.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.random import default_rng

from kinesic.bench.figure import Figure
from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot
from kinesic.ik.pose import solve_pose
from kinesic.ik.solve import solve
from kinesic.ik.two_hands import reach_both

POSES, PAIRS, BEYOND = 1000, 150, 40
MM = 1e-3
NEAR_BEST = 5e-3  # [m]
PERFECT = 1e-12  # cost at which no further beginning is tried
DIRECTIONS = 0.1  # weight of pointing and palm, beside 1 for the position
OPTIONS: Mapping[str, bool | int | float | str] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",  # no banner
    "ipopt.tol": 1e-11,
    "ipopt.max_iter": 300,
    "ipopt.bound_relax_factor": 0.0,
}


def bench() -> list[Figure]:
    """Measures shares of tasks that are met."""
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


@dataclass(frozen=True, eq=False)
class BestPosture:
    """The best posture found from several starts, and what it still misses."""

    angles: Floats  # (k,) [rad] inside the ranges
    residual: float  # [m] from the hand to the position, measured on these angles
    pointing_error: float | None  # [rad]
    palm_error: float | None  # [rad]
    beginnings: int  # that were needed


def best_posture(chain: Chain, reach: Reach, *, beginnings: int = 20, seed: int = 0) -> BestPosture:
    """Minimises what is left of a reach over the box of the ranges.

    Args:
        chain: the arm.
        reach: of its hand, in the frame of the chain's base; a swivel is not heeded.
        beginnings: the rest posture and random ones, at most so many.
        seed: of the random ones.

    Returns:
        The posture with the least squares: the hand's miss in arm lengths, and the directions' (1 - cosine).
    """
    minimise, random = _minimiser(chain), np.random.default_rng(seed)
    wanted = np.concatenate([np.asarray(reach.position), _weighed(reach.pointing), _weighed(reach.palm)])
    best, least, tried = chain.rest, np.inf, 0
    while tried < beginnings and least > PERFECT:
        begin = random.uniform(chain.lower, chain.upper) if tried else chain.rest
        tried += 1
        found, cost = minimise(begin, wanted)
        if cost < least:
            best, least = found, cost
    angles = np.clip(best, chain.lower, chain.upper)
    rotations, centres = chain.frames(angles)
    return BestPosture(
        sealed(angles),
        float(np.linalg.norm(centres[-2] - reach.position)),
        _between(centres[-1] - centres[-2], reach.pointing),
        _between(rotations[-1] @ chain.palm, reach.palm),
        tried,
    )


@lru_cache(maxsize=8)
def _minimiser(chain: Chain) -> Callable[[Floats, Floats], tuple[Floats, float]]:
    """IPOPT on this chain: from a beginning (k,) and what is wanted (9,), the posture (k,) and its cost."""
    import casadi  # noqa: PLC0415 - offline only, and slow to import

    angles, wanted = casadi.SX.sym("angles", len(chain.rest)), casadi.SX.sym("wanted", 9)
    rotation, hand, k = casadi.SX.eye(3), casadi.SX(chain.origin_in_base), 0
    for joint in chain.joints:
        for hinge in joint.hinges:
            c, s, axis = casadi.cos(angles[k]), casadi.sin(angles[k]), hinge.axis
            k += 1
            rotation = rotation @ (c * casadi.SX.eye(3) + s * casadi.skew(axis) + (1 - c) * np.outer(axis, axis))
        if joint is not chain.joints[-1]:
            hand += rotation @ joint.bone
    size, bone = float(chain.lengths[:-1].sum()), chain.joints[-1].bone
    cost = casadi.sumsqr(hand - wanted[:3]) / size**2
    for own, wish in ((bone / np.linalg.norm(bone), wanted[3:6]), (chain.palm, wanted[6:])):
        cost += casadi.sumsqr(wish) / DIRECTIONS - casadi.dot(rotation @ own, wish)
    solver = casadi.nlpsol("optimum", "ipopt", {"x": angles, "p": wanted, "f": cost}, OPTIONS)

    def minimise(begin: Floats, asked: Floats) -> tuple[Floats, float]:
        found = solver(x0=begin, p=asked, lbx=chain.lower, ubx=chain.upper)
        return np.array(found["x"]).ravel(), float(found["f"])

    return minimise


def _weighed(direction: Floats | None) -> Floats:
    """(3,) of length `DIRECTIONS`; the null vector for what is not asked."""
    return np.zeros(3) if direction is None else DIRECTIONS * direction / np.linalg.norm(direction)


def _between(present: Floats, wanted: Floats | None) -> float | None:
    """[rad] between two directions; None for what is not asked."""
    if wanted is None:
        return None
    cosine = present @ wanted / (np.linalg.norm(present) * np.linalg.norm(wanted))
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)))
