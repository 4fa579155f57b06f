"""What an arm is asked beside a position: a full pose, both hands with the torso, targets out of reach.

The reference of the last is the best posture for a reach, by IPOPT from many beginnings (CasADi). It is slow and knows
nothing of springs, branches or closed forms: what it finds is what the solver is measured by.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from statistics import median
from time import perf_counter

import numpy as np
from numpy.random import default_rng

from kinesic.bench.figure import Figure
from kinesic.bench.ik.arms import random_arm
from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot
from kinesic.ik import KERNEL
from kinesic.ik.pose import hold_reach, solve_pose
from kinesic.ik.solve import solve
from kinesic.ik.two_hands import reach_both

POSES, PAIRS, BEYOND = 1000, 150, 40
ARMS, POSES_OF_ARM = 60, 100
MM, LIKE = 1e-3, 1e-2  # [m], [rad]
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
    return [_poses(robot), *_directions(robot), _poses_of_random_arms(), *_pairs(robot), _beyond(robot)]


def _poses(robot: Robot) -> Figure:
    chain, chance, met = robot.arms["l"], default_rng(11), 0
    for _ in range(POSES):
        rotations, centres = chain.frames(chance.uniform(chain.lower, chain.upper))
        met += solve_pose(chain, centres[-2], rotations[-1], start=chain.rest).reached
    return Figure("ik.pose", met / POSES, "share", 0.999, "higher", f"{POSES} poses of postures inside the limits")


def _directions(robot: Robot) -> list[Figure]:
    """Place, pointing and palm of one hand, as one call; judged by the body's own forward kinematics."""
    chain, chance, seconds, met = robot.arms["l"], default_rng(14), [], 0
    for _ in range(POSES):
        asked = _held(chain, chance.uniform(chain.lower, chain.upper))
        began = perf_counter()
        found = hold_reach(chain, asked, start=chain.rest)
        seconds.append(perf_counter() - began)
        now = _held(chain, found.angles)
        errors = _between(now.pointing, asked.pointing), _between(now.palm, asked.palm)
        met += bool(np.linalg.norm(now.position - asked.position) < MM and max(errors) < LIKE)
    micro, why = 1e6 * np.array(seconds), f"{POSES} poses of postures inside the limits"
    return [
        Figure("ik.hold", met / POSES, "share", 0.999, "higher", f"1 mm and 0.01 rad; {why}"),
        Figure(f"ik.hold_{KERNEL}", float(np.median(micro)), "us", 12.0, "lower", why),
        Figure(f"ik.hold_{KERNEL}_p90", float(np.percentile(micro, 90)), "us", None, "lower", why),
    ]


def _poses_of_random_arms() -> Figure:
    chance, shares = default_rng(15), []
    for _ in range(ARMS):
        chain, met = random_arm(chance), 0
        for _ in range(POSES_OF_ARM):
            rotations, centres = chain.frames(chance.uniform(chain.lower, chain.upper))
            met += solve_pose(chain, centres[-2], rotations[-1], start=chain.rest).reached
        shares.append(met / POSES_OF_ARM)
    note = f"{ARMS} arms of every shape, {POSES_OF_ARM} poses each; the worst {min(shares):.3f}"
    return Figure("ik.pose_random_arms", float(np.mean(shares)), "share", 0.999, "higher", note)


def _held(chain: Chain, angles: Floats) -> Reach:
    """What the hand of a posture (k,) [rad] does."""
    rotations, centres = chain.frames(angles)
    along = centres[-1] - centres[-2]
    return Reach(np.array(centres[-2]), along / np.linalg.norm(along), rotations[-1] @ chain.palm)


def _pairs(robot: Robot) -> list[Figure]:
    skeleton, chance = robot.skeleton, default_rng(12)
    solved, seconds = [], []
    for _ in range(PAIRS):
        origins = skeleton.frames(chance.uniform(skeleton.lower, skeleton.upper)).origins
        hands = {side: origins[robot.arm(side).wrist] for side in SIDES}
        began = perf_counter()
        solved.append(reach_both(robot, hands, start=skeleton.rest))
        seconds.append(perf_counter() - began)
    share = float(np.mean([found.reached for found in solved]))
    travel = float(np.mean([found.torso_travel for found in solved]))
    return [
        Figure("ik.both_hands", share, "share", 0.97, "higher", f"{PAIRS} pairs with torso"),
        Figure("ik.both_hands_torso_travel", travel, "rad", None, "lower"),
        Figure(f"ik.both_hands_{KERNEL}", 1e6 * median(seconds), "us", None, "lower"),
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
        None if reach.pointing is None else _between(centres[-1] - centres[-2], reach.pointing),
        None if reach.palm is None else _between(rotations[-1] @ chain.palm, reach.palm),
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


def _between(present: Floats | None, wanted: Floats | None) -> float:
    """[rad] between two directions; 0 for what is not asked."""
    if present is None or wanted is None:
        return 0.0
    cosine = present @ wanted / (np.linalg.norm(present) * np.linalg.norm(wanted))
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)))
