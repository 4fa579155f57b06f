"""Measures how surely, how exactly and how fast an arm reaches unseen targets, on upper22 and random arms."""

from statistics import median
from time import perf_counter

import numpy as np
from numpy.random import default_rng

from kinesic.bench.figure import Figure
from kinesic.bench.ik.arms import random_arm, targets
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.hinges import extract
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.solve import Solution, solve

TARGETS = {"compiled": 20_000, "numpy": 500}
ARMS, TARGETS_OF_ARM = 60, 200
POSTURES = {"compiled": 5_000, "numpy": 500}
SLOWEST = 20.0  # [us] goal of the 99th percentile
ALONE, PASSES = 4_000, 11  # targets that are timed so often each
BATCH, BATCH_ROUNDS = 100_000, 12
TENTH_MM, MM = 1e-4, 1e-3
NO_KERNEL = "the kernel is not compiled here"


def bench() -> list[Figure]:
    """Measures P1, random arms, extraction and batch."""
    chain = Robot.load().arms["l"]
    return [*_reach(chain), *_random_arms(), _extraction(chain), _batch(chain)]


def _reach(chain: Chain) -> list[Figure]:
    goals = targets(default_rng(1), chain, TARGETS[KERNEL])
    seconds: list[float] = []
    solved: list[Solution] = []
    for target in goals:
        reach = Reach(target)
        began = perf_counter()
        solved.append(solve(chain, reach, start=chain.rest))
        seconds.append(perf_counter() - began)
    misses = np.array([_miss(chain, found.angles, target) for found, target in zip(solved, goals, strict=True)])
    again = solve(chain, Reach(goals[0]), start=chain.rest)
    angles = np.array([found.angles for found in solved])
    outside = np.any((angles < chain.lower) | (angles > chain.upper), axis=1).sum()
    return [
        Figure("ik.success_tenth_mm", float((misses < TENTH_MM).mean()), "share", 0.9999, "higher"),
        Figure("ik.success_mm", float((misses < MM).mean()), "share", 1.0, "higher"),
        Figure("ik.violations", float(outside), "count", 0.0, "lower"),
        Figure("ik.repeatable", float(again.angles.tobytes() == solved[0].angles.tobytes()), "share", 1.0, "higher"),
        Figure(f"ik.reach_{KERNEL}", 1e6 * median(seconds), "us", None, "lower"),
        Figure(f"ik.reach_{KERNEL}_p99", 1e6 * float(np.percentile(seconds, 99)), "us", None, "lower"),
        *_percentiles(chain, goals),
        _buffers(chain, goals),
    ]


def _percentiles(chain: Chain, goals: Floats) -> list[Figure]:
    """How long solves take by themselves: the median of several passes over the targets, for each target.

    A single pass counts whatever interrupts it as the solver's time: beside other programs its 99th percentile is
    theirs. Between two solves of one target come all others, so no branch of it is remembered.
    """
    if KERNEL == "numpy":
        return [Figure("ik.solve_p99_alone", None, "us", SLOWEST, "lower", NO_KERNEL)]
    reaches = [Reach(target) for target in goals[:ALONE]]
    passes = [[_seconds(chain, reach) for reach in reaches] for _ in range(PASSES)]
    seconds = np.median(passes, axis=0)
    why = f"the median of {PASSES} passes, for each of {ALONE} targets"
    return [
        Figure(f"ik.solve_p{share}_alone", 1e6 * float(np.percentile(seconds, share)), "us", goal, "lower", why)
        for share, goal in ((50, None), (90, None), (99, SLOWEST))
    ]


def _seconds(chain: Chain, reach: Reach) -> float:
    began = perf_counter()
    solve(chain, reach, start=chain.rest)
    return perf_counter() - began


def _buffers(chain: Chain, goals: Floats) -> Figure:
    """The entry that writes into the caller's buffer."""
    if KERNEL == "numpy":
        return Figure("ik.reach_buffers", None, "us", None, "lower", NO_KERNEL)
    arm, seconds = arm_of(chain), []
    for target in goals:
        angles = chain.rest.copy()
        began = perf_counter()
        arm.reach(target, angles)
        seconds.append(perf_counter() - began)
    return Figure("ik.reach_buffers", 1e6 * median(seconds), "us", None, "lower")


def _random_arms() -> list[Figure]:
    chance = default_rng(60)
    shares = []
    for _ in range(ARMS if KERNEL == "compiled" else 6):
        chain = random_arm(chance)
        goals = targets(chance, chain, TARGETS_OF_ARM if KERNEL == "compiled" else 50)
        found = [solve(chain, Reach(target), start=chain.rest).angles for target in goals]
        misses = np.array([_miss(chain, angles, target) for angles, target in zip(found, goals, strict=True)])
        shares.append(float((misses < MM).mean()))
    return [
        Figure("ik.success_random_arms_worst", min(shares), "share", 0.998, "higher", f"{len(shares)} arms"),
        Figure("ik.success_random_arms_mean", float(np.mean(shares)), "share", None, "higher"),
    ]


def _extraction(chain: Chain) -> Figure:
    """Points of postures inside the limits, back to hinges: the points must be met."""
    chance, linkage = default_rng(5), linkage_of(chain)
    bones = len(linkage.links) - 1
    exact = 0
    for _ in range(POSTURES[KERNEL]):
        points = linkage.walk(chance.uniform(chain.lower, chain.upper).tolist(), bones)[1]
        found = extract(linkage, points[1:], chain.rest.tolist())
        met = linkage.walk(found.angles, bones)[1]
        exact += bool(np.abs(np.subtract(met, points)).max() < 1e-9)
    return Figure("ik.extraction", exact / POSTURES[KERNEL], "share", 1.0, "higher", f"{POSTURES[KERNEL]} postures")


def _batch(chain: Chain) -> Figure:
    if KERNEL == "numpy":
        return Figure("ik.batch", None, "targets/s", 0.7e6, "higher", NO_KERNEL)
    some = targets(default_rng(7), chain, 1000)
    goals = np.ascontiguousarray(np.tile(some, (BATCH // len(some), 1)))
    angles, residuals = np.empty((len(goals), len(chain.rest))), np.empty(len(goals))
    seconds = []
    for _ in range(3):
        began = perf_counter()
        arm_of(chain).reach_many(goals, chain.rest, BATCH_ROUNDS, angles, residuals)
        seconds.append(perf_counter() - began)
    reached = f"{BATCH_ROUNDS} rounds, {100 * float((residuals < MM).mean()):.1f} % below 1 mm"
    return Figure("ik.batch", len(goals) / median(seconds), "targets/s", 0.7e6, "higher", reached)


def _miss(chain: Chain, angles: Floats, target: Floats) -> float:
    """[m] by the body's own forward kinematics."""
    return float(np.linalg.norm(chain.hand(angles) - target))
