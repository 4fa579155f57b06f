"""Numerical correction from several start postures, if the first one stalls."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.chain import Chain
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_place
from kinesic.ik.arm.multistart import STALL_DISTANCE
from kinesic.ik.arm.seeds import Seed, seeds
from kinesic.ik.scalar3 import Vector, distance, vector

from .polish import MAX_ITERATIONS, Polished, polish

MAX_RESTARTS = 8  # largest number of other start postures


def nearest_seeds(linkage: Linkage, target: Vector, count: int) -> list[Seed]:
    """Return the stored postures with hands nearest to a target, best first."""
    return sorted(seeds(linkage), key=lambda seed: distance(seed.hand, target))[:count]


def approach(
    linkage: Linkage,
    target: Vector,
    angles: Sequence[float],
    *,
    posture: Sequence[float],
    mobility: Sequence[float],
) -> Polished:
    """Correct a start posture numerically, then stored postures near the target.

    Args:
        linkage: the arm.
        target: [m] of the hand, in the base.
        angles: [rad] to begin with, inside the ranges.
        posture: [rad] to which springs pull what the hand does not need.
        mobility: how readily each hinge moves.

    Returns:
        The best of all attempts; its rounds are those of all together.
    """
    best = polish(linkage, target, angles, posture=posture, mobility=mobility)
    if best.miss < STALL_DISTANCE:
        return best
    rounds = best.rounds
    for seed in nearest_seeds(linkage, target, MAX_RESTARTS):
        tried = polish(linkage, target, seed.angles, posture=posture, mobility=mobility)
        rounds += tried.rounds
        if tried.miss < best.miss:
            best = tried
        if best.miss < STALL_DISTANCE:
            break
    return Polished(best.angles, best.miss, rounds)


def reach(chain: Chain, target, angles) -> float:
    """Change angles in place until the hand is at a target."""
    linkage, home = _packed(chain)
    angles[:] = np.clip(angles, chain.lower, chain.upper)
    place = vector(mirror_place(target) if is_right(chain) else target)
    solution = approach(linkage, place, angles.tolist(), posture=home, mobility=linkage.mobility)
    angles[: len(solution.angles)] = solution.angles
    return solution.miss


def reach_many(chain: Chain, targets, start, *, rounds: int = MAX_ITERATIONS):
    """Return angles and residuals after numerical correction from one start posture."""
    angles, residuals = np.empty((len(targets), len(start))), np.empty(len(targets))
    linkage, home = _packed(chain)
    angles[:] = np.clip(start, chain.lower, chain.upper)
    near = angles[0].tolist() if len(angles) else []
    for row, target in enumerate(targets):
        place = vector(mirror_place(target) if is_right(chain) else target)
        polished = polish(linkage, place, near, posture=home, mobility=linkage.mobility, rounds=rounds)
        angles[row, : len(polished.angles)] = polished.angles
        residuals[row] = polished.miss
    return angles, residuals


def _packed(chain: Chain) -> tuple[Linkage, list[float]]:
    """Return the linkage of a left arm, and its rest posture within the ranges."""
    linkage = linkage_of(mirror_chain(chain) if is_right(chain) else chain)
    return linkage, np.clip(chain.rest, chain.lower, chain.upper).tolist()
