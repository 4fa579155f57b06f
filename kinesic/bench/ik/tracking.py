"""Measures how an arm follows a path: time of a step, error, and whether it comes home after a lap.

The tracker is compared with plain damped least squares.
"""

from collections.abc import Callable
from statistics import median
from time import perf_counter

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.robot import Robot
from kinesic.ik import KERNEL
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.polish import columns
from kinesic.ik.track import Tracker

Path = Callable[[float], Floats]  # turn [rad] -> (3,) [m] in the chain's base

ROUNDS = 50
DAMPING = 1e-3
TOLERANCE = 1e-4  # [m]

RATE = 200  # [Hz]
LAP = 2.5  # [s]
LAPS = 3


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
    """Measures root mean square jerk [rad/s^3] of (laps, steps, h) [rad], once the arm has come to the path."""
    angles = np.concatenate(laps)[laps.shape[1] // 4 :]
    return float(np.sqrt((np.diff(angles, 3, axis=0) ** 2).sum(axis=1).mean()) * rate**3)


def ellipse(turn: float) -> Floats:
    """(3,) [m] 0.24 x 0.36 m in front of the left shoulder, in the frame of the chain's base."""
    return np.array([0.28, 0.1 + 0.12 * np.cos(turn), -0.05 + 0.18 * np.sin(turn)])


def tracking_paths(chain: Chain) -> dict[str, Path]:
    """The ellipse, out and back to 94 % of the reach, a circle about the T-pose, and up and down beside the body."""
    shoulder = chain.frames(chain.rest)[1][-4]
    length = float(chain.lengths[-3:-1].sum())
    return {
        "ellipse": ellipse,
        "stretch": lambda turn: shoulder + np.array([length * (0.70 - 0.24 * np.cos(turn)), 0.0, 0.0]),
        "t_pose": lambda turn: shoulder + np.array([0.06 * np.cos(turn), 0.38, 0.06 * np.sin(turn)]),
        "beside_body": lambda turn: shoulder + np.array([0.02, 0.08, -0.25 + 0.10 * np.sin(turn)]),
    }


def _followed(chain: Chain, path: Path) -> tuple[float, float]:
    """Largest error [m] of the last lap, and how far it is from the lap before [rad]."""
    tracker, steps = Tracker(chain, period=1 / RATE), round(LAP * RATE)
    goals = [path(2 * np.pi * step / steps) for step in range(steps)]
    laps = np.array([[tracker.step(target) for target in goals] for _ in range(LAPS)])
    errors = [float(np.linalg.norm(chain.hand(row) - target)) for row, target in zip(laps[-1], goals, strict=True)]
    return max(errors), float(np.abs(laps[-1] - laps[-2]).max())


def bench() -> list[Figure]:
    """Measures laps at 200 Hz: the ellipse is timed, error and drift are the worst over all paths."""
    chain = Robot.load().arms["l"]
    tracker = Tracker(chain, period=1 / RATE)
    steps = round(LAP * RATE)
    goals = [ellipse(2 * np.pi * step / steps) for step in range(steps)]
    seconds: list[float] = []
    laps = []
    for _ in range(LAPS):
        lap = []
        for target in goals:
            began = perf_counter()
            lap.append(tracker.step(target))
            seconds.append(perf_counter() - began)
        laps.append(lap)
    rows = np.array(laps)
    plain = damped_least_squares(chain, ellipse, steps, LAPS)
    followed = {name: _followed(chain, path) for name, path in tracking_paths(chain).items()}
    errors, drifts = ({name: pair[k] for name, pair in followed.items()} for k in range(2))
    return [
        Figure(f"ik.tracking_step_{KERNEL}", 1e6 * median(seconds), "us", 1.2, "lower"),
        Figure("ik.tracking_error", 1000 * max(errors.values()), "mm", 0.1, "lower", "worst of four paths"),
        Figure(
            "ik.tracking_drift", max(drifts.values()), "rad", 0.01, "lower", max(drifts, key=lambda name: drifts[name])
        ),
        Figure("ik.tracking_jerk_of_dls", jerk(plain, RATE) / jerk(rows, RATE), "x", 50.0, "higher", "DLS over ours"),
    ]
