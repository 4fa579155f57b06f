"""Benchmark of hand poses, directions, two hands and unreachable targets.

It measures full poses, both hands with the torso, unreachable targets.

The reference for unreachable targets is the best posture by IPOPT from many starts (CasADi). It is slow and independent
of the solver's springs, branches and closed forms.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from statistics import median
from time import perf_counter

import numpy as np
from numpy.random import default_rng

from kinesic.bench.ik.arms import random_arm
from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot
from kinesic.ik.pose import hold_reach, solve_pose
from kinesic.ik.solve import solve
from kinesic.ik.two_hands import reach_both

POSE_COUNT = 1000  # random hand poses
PAIR_COUNT = 150  # pairs of hand targets
UNREACHABLE_COUNT = 40  # targets out of reach
ARM_COUNT = 60  # arms with random joint orders and lengths
POSES_PER_ARM = 100  # hand poses of each random arm
MAX_POSITION_ERROR = 1e-3  # [m] position error below which a task counts as solved
MAX_ANGLE_ERROR = 1e-2  # [rad] direction error below which a task counts as solved
RESIDUAL_MARGIN = 5e-3  # [m] excess over the optimizer's residual up to which a task counts as solved
PERFECT_COST = 1e-12  # cost below which the optimizer tries no further start
DIRECTION_WEIGHT = 0.1  # cost weight of pointing and palm directions; the position has weight 1
# Options of IPOPT: no output, small tolerance, bounds kept exactly.
IPOPT_OPTIONS: Mapping[str, bool | int | float | str] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",  # no banner
    "ipopt.tol": 1e-11,
    "ipopt.max_iter": 300,
    "ipopt.bound_relax_factor": 0.0,
}


def bench() -> list[Metric]:
    """Measure the fraction of solved IK tasks by kind."""
    robot = Robot.load()
    return [
        _measure_poses(robot),
        *_measure_directions(robot),
        _poses_of_random_arms(),
        *_measure_pairs(robot),
        _measure_unreachable(robot),
    ]


def _measure_poses(robot: Robot) -> Metric:
    chain, rng, solved_count = robot.arms["l"], default_rng(11), 0
    for _ in range(POSE_COUNT):
        rotations, centres = chain.frames(rng.uniform(chain.lower, chain.upper))
        solved_count += solve_pose(chain, centres[-2], rotations[-1], start=chain.rest).reached
    return Metric(
        "ik.pose",
        solved_count / POSE_COUNT,
        "share",
        0.999,
        "higher",
        f"{POSE_COUNT} poses of postures inside the limits",
    )


def _measure_directions(robot: Robot) -> list[Metric]:
    """Measure IK success and time for hand position, pointing and palm together.

    The body's own forward kinematics judges the result.
    """
    chain, rng, seconds, solved_count = robot.arms["l"], default_rng(14), [], 0
    for _ in range(POSE_COUNT):
        requested = _compute_hand_state(chain, rng.uniform(chain.lower, chain.upper))
        began = perf_counter()
        solution = hold_reach(chain, requested, start=chain.rest)
        seconds.append(perf_counter() - began)
        actual = _compute_hand_state(chain, solution.angles)
        errors = _measure_angle(actual.pointing, requested.pointing), _measure_angle(actual.palm, requested.palm)
        solved_count += bool(
            np.linalg.norm(actual.position - requested.position) < MAX_POSITION_ERROR and max(errors) < MAX_ANGLE_ERROR
        )
    micro, why = 1e6 * np.array(seconds), f"{POSE_COUNT} poses of postures inside the limits"
    return [
        Metric("ik.hold", solved_count / POSE_COUNT, "share", 0.999, "higher", f"1 mm and 0.01 rad; {why}"),
        Metric("ik.hold_compiled", float(np.median(micro)), "us", 12.0, "lower", why),
        Metric("ik.hold_compiled_p90", float(np.percentile(micro, 90)), "us", None, "lower", why),
    ]


def _poses_of_random_arms() -> Metric:
    rng, success_rates = default_rng(15), []
    for _ in range(ARM_COUNT):
        chain, solved_count = random_arm(rng), 0
        for _ in range(POSES_PER_ARM):
            rotations, centres = chain.frames(rng.uniform(chain.lower, chain.upper))
            solved_count += solve_pose(chain, centres[-2], rotations[-1], start=chain.rest).reached
        success_rates.append(solved_count / POSES_PER_ARM)
    note = f"{ARM_COUNT} arms of every shape, {POSES_PER_ARM} poses each; the worst {min(success_rates):.3f}"
    return Metric("ik.pose_random_arms", float(np.mean(success_rates)), "share", 0.999, "higher", note)


def _compute_hand_state(chain: Chain, angles: Floats) -> Reach:
    """Return hand position, pointing and palm directions in the chain's base frame."""
    rotations, centres = chain.frames(angles)
    along = centres[-1] - centres[-2]
    return Reach(np.array(centres[-2]), along / np.linalg.norm(along), rotations[-1] @ chain.palm)


def _measure_pairs(robot: Robot) -> list[Metric]:
    skeleton, rng = robot.skeleton, default_rng(12)
    solved, seconds = [], []
    for _ in range(PAIR_COUNT):
        origins = skeleton.frames(rng.uniform(skeleton.lower, skeleton.upper)).origins
        hands = {side: origins[robot.arm(side).wrist] for side in SIDES}
        began = perf_counter()
        solved.append(reach_both(robot, hands, start=skeleton.rest))
        seconds.append(perf_counter() - began)
    success = float(np.mean([pair.reached for pair in solved]))
    travel = float(np.mean([pair.torso_travel for pair in solved]))
    return [
        Metric("ik.both_hands", success, "share", 0.97, "higher", f"{PAIR_COUNT} pairs with torso"),
        Metric("ik.both_hands_torso_travel", travel, "rad", None, "lower"),
        Metric("ik.both_hands_compiled", 1e6 * median(seconds), "us", None, "lower"),
    ]


def _measure_unreachable(robot: Robot) -> Metric:
    chain, rng, near_count = robot.arms["l"], default_rng(13), 0
    shoulder = chain.frames(chain.rest)[1][1]
    for _ in range(UNREACHABLE_COUNT):
        direction = rng.normal(size=3)
        target = Reach(shoulder + rng.uniform(1.1, 1.8) * robot.arm_length * direction / np.linalg.norm(direction))
        best = best_posture(chain, target).residual
        near_count += solve(chain, target, start=chain.rest).residual - best <= RESIDUAL_MARGIN
    return Metric(
        "ik.unreachable",
        near_count / UNREACHABLE_COUNT,
        "share",
        0.95,
        "higher",
        f"{UNREACHABLE_COUNT} targets, within 5 mm of the best",
    )


@dataclass(frozen=True, eq=False)
class BestPosture:
    """Best arm posture found from several starts, with its errors."""

    angles: Floats  # (k,) [rad] within the ranges
    residual: float  # [m] distance of the hand from the position
    pointing_error: float | None  # [rad] angle between hand and requested pointing direction
    palm_error: float | None  # [rad] angle between palm normal and requested normal
    starts: int  # number of starts used


def best_posture(chain: Chain, reach: Reach, *, starts: int = 20, seed: int = 0) -> BestPosture:
    """Minimise the hand's pose error within the joint ranges by IPOPT.

    Args:
        chain: arm to solve for.
        reach: target of its hand in the frame of the chain's base; a swivel is ignored.
        starts: maximum number of starts: the rest posture, then random ones.
        seed: seed of the random starts.

    Returns:
        The posture of least cost: squared error in arm lengths, plus `DIRECTION_WEIGHT` (1 - cosine) per direction.
    """
    minimise, random = _make_minimiser(chain), np.random.default_rng(seed)
    target_vector = np.concatenate(
        [np.asarray(reach.position), _weigh_direction(reach.pointing), _weigh_direction(reach.palm)]
    )
    best, least, tried = chain.rest, np.inf, 0
    while tried < starts and least > PERFECT_COST:
        begin = random.uniform(chain.lower, chain.upper) if tried else chain.rest
        tried += 1
        posture, cost = minimise(begin, target_vector)
        if cost < least:
            best, least = posture, cost
    angles = np.clip(best, chain.lower, chain.upper)
    rotations, centres = chain.frames(angles)
    return BestPosture(
        sealed(angles),
        float(np.linalg.norm(centres[-2] - reach.position)),
        None if reach.pointing is None else _measure_angle(centres[-1] - centres[-2], reach.pointing),
        None if reach.palm is None else _measure_angle(rotations[-1] @ chain.palm, reach.palm),
        tried,
    )


@lru_cache(maxsize=8)
def _make_minimiser(chain: Chain) -> Callable[[Floats, Floats], tuple[Floats, float]]:
    """Return an IPOPT solver for the arm's pose error.

    It maps a start (k,) and a target (9,) to the posture (k,) and its cost.
    """
    import casadi  # noqa: PLC0415 - slow import, used offline only

    angles, target_vector = casadi.SX.sym("angles", len(chain.rest)), casadi.SX.sym("wanted", 9)
    rotation, hand, k = casadi.SX.eye(3), casadi.SX(chain.origin_in_base), 0
    for joint in chain.joints:
        for hinge in joint.hinges:
            c, s, axis = casadi.cos(angles[k]), casadi.sin(angles[k]), hinge.axis
            k += 1
            rotation = rotation @ (c * casadi.SX.eye(3) + s * casadi.skew(axis) + (1 - c) * np.outer(axis, axis))
        if joint is not chain.joints[-1]:
            hand += rotation @ joint.bone
    size, bone = float(chain.lengths[:-1].sum()), chain.joints[-1].bone
    cost = casadi.sumsqr(hand - target_vector[:3]) / size**2
    for direction, wish in ((bone / np.linalg.norm(bone), target_vector[3:6]), (chain.palm, target_vector[6:])):
        cost += casadi.sumsqr(wish) / DIRECTION_WEIGHT - casadi.dot(rotation @ direction, wish)
    solver = casadi.nlpsol("optimum", "ipopt", {"x": angles, "p": target_vector, "f": cost}, IPOPT_OPTIONS)

    def minimise(begin: Floats, target: Floats) -> tuple[Floats, float]:
        solution = solver(x0=begin, p=target, lbx=chain.lower, ubx=chain.upper)
        return np.array(solution["x"]).ravel(), float(solution["f"])

    return minimise


def _weigh_direction(direction: Floats | None) -> Floats:
    """Return a direction (3,) scaled to `DIRECTION_WEIGHT`.

    The result is zero if it is not requested.
    """
    return np.zeros(3) if direction is None else DIRECTION_WEIGHT * direction / np.linalg.norm(direction)


def _measure_angle(present: Floats | None, target_vector: Floats | None) -> float:
    """Return the angle [rad] between two directions.

    The result is 0 if one is not requested.
    """
    if present is None or target_vector is None:
        return 0.0
    cosine = present @ target_vector / (np.linalg.norm(present) * np.linalg.norm(target_vector))
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)))
