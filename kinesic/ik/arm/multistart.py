"""Numerical inverse kinematics for hand positions, from several start postures.

They meet positions only: swivel, pointing and palm direction are ignored.
"""

from collections.abc import Sequence

import numpy as np

from kinesic._kernel import ik as kernel
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.seeds import Seed
from kinesic.ik.scalar3 import Vector

MAX_ROUNDS = 24  # default of the largest number of iterations per target in `reach_many`
STALL_DISTANCE = 2e-5  # [m] distance left to the target above which other start postures are tried


def approach(
    arm: kernel.Arm,
    seeds: Sequence[Seed],
    target: Vector,
    angles: Sequence[float],
    *,
    posture: Sequence[float],
    mobility: Sequence[float],
) -> tuple[list[float], int]:
    """Solve for a hand position from several start postures.

    Args:
        arm: on the left or in the middle.
        seeds: of the arm, in the order in which it was packed.
        target: [m] of the hand, in the base.
        angles: [rad] initial angles, inside the ranges.
        posture: [rad] preferred angles for redundant hinges.
        mobility: of each hinge, from 0 (fixed) to 1.

    Returns:
        The best angles [rad] of all attempts, and the total number of iterations.
    """
    best, miss, rounds = arm.polish(target, angles, posture, mobility)
    for k in arm.nearest(target):
        if miss < STALL_DISTANCE:
            break
        corrected, left, more = arm.polish(target, seeds[k].angles, posture, mobility)
        rounds += more
        if left < miss:
            best, miss = corrected, left
    return best, rounds


def reach(chain: Chain, target: Floats, angles: Floats) -> float:
    """Solve joint angles in place and return the hand-target distance [m].

    Args:
        chain: the arm.
        target: (3,) [m] of the hand, in the frame of the chain's base.
        angles: (k,) [rad] initial angles; overwritten by the solution, inside the ranges.

    Returns:
        [m] left between hand and target.

    Raises:
        ValueError: the arrays are not float64 of these shapes, or not finite.
    """
    return arm_of(chain).reach(target, angles)


def reach_many(chain: Chain, targets: Floats, start: Floats, *, rounds: int = MAX_ROUNDS) -> tuple[Floats, Floats]:
    """Solve for many hand positions, all from the same start posture.

    Args:
        chain: the arm.
        targets: (m, 3) [m] of the hand, in the frame of the chain's base.
        start: (k,) [rad] initial angles of each solution; clipped to the ranges.
        rounds: largest number of iterations per target.

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
    arm_of(chain).reach_many(targets, start, rounds, angles, residuals)
    return angles, residuals
