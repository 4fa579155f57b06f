"""Plain damped least squares along a path: what the tracker is compared with."""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.polish import columns

ROUNDS = 50
DAMPING = 1e-3
TOLERANCE = 1e-4  # [m]


def damped_least_squares(chain: Chain, path: Callable[[float], Floats], steps: int, laps: int) -> Floats:
    """Follows a closed path, each target from the posture before; angles are clipped to the ranges.

    Args:
        chain: a left arm.
        path: turn [rad] -> (3,) [m].
        steps: of one lap.
        laps: how many.

    Returns:
        (laps, steps, h) [rad] of the hinges before the hand's own.
    """
    linkage = linkage_of(chain)
    count = linkage.links[-1].first
    angles, lower, upper = chain.rest[:count], chain.lower[:count], chain.upper[:count]
    rows = []
    for step in range(laps * steps):
        target = path(2 * np.pi * step / steps)
        for _ in range(ROUNDS):
            hand, moves = columns(linkage, angles.tolist())
            error, jacobian = target - np.array(hand), np.array(moves).T
            if np.linalg.norm(error) < TOLERANCE:
                break
            push = np.linalg.solve(jacobian @ jacobian.T + DAMPING * np.eye(3), error)
            angles = np.clip(angles + jacobian.T @ push, lower, upper)
        rows.append(angles)
    return np.array(rows).reshape(laps, steps, count)


def jerk(laps: Floats, rate: int) -> float:
    """Root mean square [rad/s^3] of (laps, steps, h) [rad], once the arm has come to the path."""
    angles = np.concatenate(laps)[laps.shape[1] // 4 :]
    return float(np.sqrt((np.diff(angles, 3, axis=0) ** 2).sum(axis=1).mean()) * rate**3)
