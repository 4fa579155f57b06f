"""Brings a hand to a target by polish alone, from other postures where it stalls: no masses, no closed forms.

The shortest way where nothing but the position is asked: no elbow to place, no palm to turn.
"""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.ik.arm.compiled import KERNEL, arm_of
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain, mirror_place
from kinesic.ik.arm.polish import ROUNDS, Polished, polish
from kinesic.ik.arm.seeds import nearest_seeds
from kinesic.ik.scalar3 import Vector, vector
from kinesic.kernels import Kernel

STALLED = 2e-5  # [m] from the target: further away the arm begins again elsewhere
RESTARTS = 8


def approach(
    linkage: Linkage,
    target: Vector,
    angles: Sequence[float],
    *,
    posture: Sequence[float],
    mobility: Sequence[float],
) -> Polished:
    """Polishes, and begins again from the seeds nearest to the target while the hand is not there.

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
    if best.miss < STALLED:
        return best
    rounds = best.rounds
    for seed in nearest_seeds(linkage, target, RESTARTS):
        tried = polish(linkage, target, seed.angles, posture=posture, mobility=mobility)
        rounds += tried.rounds
        if tried.miss < best.miss:
            best = tried
        if best.miss < STALLED:
            break
    return Polished(best.angles, best.miss, rounds)


def reach(chain: Chain, target: Floats, angles: Floats, *, kernel: Kernel = KERNEL) -> float:
    """Moves angles until the hand is on a target.

    Args:
        chain: the arm.
        target: (3,) [m] of the hand, in the frame of the chain's base.
        angles: (k,) [rad] to begin with; overwritten by angles inside the ranges.
        kernel: which implementation answers.

    Returns:
        [m] left between hand and target.

    Raises:
        ValueError: the arrays are not float64 of these shapes, or not finite.
    """
    if kernel == "compiled":
        return arm_of(chain).reach(target, angles)
    if target.shape != (3,) or angles.shape != chain.rest.shape or not np.isfinite([*target, *angles]).all():
        raise ValueError("reach needs finite float64 arrays: a target of 3 numbers and an angle for each hinge")
    linkage, home = _packed(chain)
    angles[:] = np.clip(angles, chain.lower, chain.upper)
    place = vector(mirror_place(target) if is_right(chain) else target)
    found = approach(linkage, place, angles.tolist(), posture=home, mobility=linkage.mobility)
    angles[: len(found.angles)] = found.angles
    return found.miss


def reach_many(
    chain: Chain, targets: Floats, start: Floats, *, rounds: int = ROUNDS, kernel: Kernel = KERNEL
) -> tuple[Floats, Floats]:
    """Moves the hand to each of many targets from one start, by polish alone: no second attempts.

    Args:
        chain: the arm.
        targets: (m, 3) [m] of the hand, in the frame of the chain's base.
        start: (k,) [rad] to begin with, each time; clipped to the ranges.
        rounds: the most that a target gets.
        kernel: which implementation answers.

    Returns:
        (m, k) [rad] inside the ranges and (m,) [m] left between hand and target.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
    """
    targets, start = (np.ascontiguousarray(given, dtype=np.float64) for given in (targets, start))
    if targets.ndim != 2 or targets.shape[1] != 3 or start.shape != chain.rest.shape:
        raise ValueError(
            f"targets have shape {targets.shape} and start {start.shape}; they need (m, 3) and {chain.rest.shape}"
        )
    if not (np.isfinite(targets).all() and np.isfinite(start).all()):
        raise ValueError("targets and start: every number must be finite")
    angles, residuals = np.empty((len(targets), len(start))), np.empty(len(targets))
    if kernel == "compiled":
        arm_of(chain).reach_many(targets, start, rounds, angles, residuals)
        return angles, residuals
    linkage, home = _packed(chain)
    angles[:] = np.clip(start, chain.lower, chain.upper)
    near = angles[0].tolist() if len(angles) else []
    for row, target in enumerate(targets):
        place = vector(mirror_place(target) if is_right(chain) else target)
        found = polish(linkage, place, near, posture=home, mobility=linkage.mobility, rounds=rounds)
        angles[row, : len(found.angles)] = found.angles
        residuals[row] = found.miss
    return angles, residuals


def _packed(chain: Chain) -> tuple[Linkage, list[float]]:
    """A left arm's linkage, and its rest inside the ranges [rad]."""
    linkage = linkage_of(mirror_chain(chain) if is_right(chain) else chain)
    return linkage, np.clip(chain.rest, chain.lower, chain.upper).tolist()
