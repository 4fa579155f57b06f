"""Benchmark of hand path tracking: step time, error and lap drift.

The tracker is compared with plain damped least squares.
"""

from collections.abc import Callable
from statistics import median
from time import perf_counter

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.scalar3 import cross, minus
from kinesic.ik.track import Tracker

Path = Callable[[float], Floats]  # lap phase [rad] -> hand position (3,) [m] in the chain's base

DLS_ITERATIONS = 50  # iterations per target of the damped least squares
DLS_DAMPING = 1e-3  # damping of the damped least squares
DLS_TOLERANCE = 1e-4  # [m] position error below which the damped least squares stop

TRACKING_RATE = 200  # [Hz] sample rate of the tracked path
LAP_DURATION = 2.5  # [s] duration of one lap of the closed path
LAP_COUNT = 3  # laps of the closed path


def damped_least_squares(chain: Chain, path: Callable[[float], Floats], steps: int, laps: int) -> Floats:
    """Follow a closed path by damped least squares.

    Angles are clipped to the ranges.

    Each target starts from the previous posture.

    Args:
        chain: a left arm.
        path: function from lap phase [rad] to position (3,) [m].
        steps: number of steps of one lap.
        laps: number of laps.

    Returns:
        Joint angles (laps, steps, h) [rad] of the joints before the hand's own.
    """
    linkage = linkage_of(chain)
    count = linkage.links[-1].first
    angles, lower, upper = chain.rest[:count], chain.lower[:count], chain.upper[:count]
    rows = []
    for step in range(laps * steps):
        target = path(2 * np.pi * step / steps)
        for _ in range(DLS_ITERATIONS):
            hand, lines = linkage.hinge_lines(angles.tolist())
            jacobian_rows = [cross(axis, minus(hand, pole)) for axis, pole in lines]
            error, jacobian = target - np.array(hand), np.array(jacobian_rows).T
            if np.linalg.norm(error) < DLS_TOLERANCE:
                break
            correction = np.linalg.solve(jacobian @ jacobian.T + DLS_DAMPING * np.eye(3), error)
            angles = np.clip(angles + jacobian.T @ correction, lower, upper)
        rows.append(angles)
    return np.array(rows).reshape(laps, steps, count)


def jerk(laps: Floats, rate: int) -> float:
    """Return the RMS joint jerk [rad/s^3] of laps (laps, steps, h) [rad].

    The first quarter of the first lap, while the arm moves to the path, is left out.
    """
    angles = np.concatenate(laps)[laps.shape[1] // 4 :]
    return float(np.sqrt((np.diff(angles, 3, axis=0) ** 2).sum(axis=1).mean()) * rate**3)


def ellipse(turn: float) -> Floats:
    """Return the elliptic hand path's point (3,) [m] at a phase [rad].

    The frame is that of the chain's base.
    """
    return np.array([0.28, 0.1 + 0.12 * np.cos(turn), -0.05 + 0.18 * np.sin(turn)])


def tracking_paths(chain: Chain) -> dict[str, Path]:
    """Return the test paths of the hand by name.

    They are the ellipse, a line to 94 % of the reach and back, a circle around the T-pose, and a vertical line next to
    the body.
    """
    shoulder = chain.frames(chain.rest)[1][-4]
    length = float(chain.lengths[-3:-1].sum())
    return {
        "ellipse": ellipse,
        "stretch": lambda turn: shoulder + np.array([length * (0.70 - 0.24 * np.cos(turn)), 0.0, 0.0]),
        "t_pose": lambda turn: shoulder + np.array([0.06 * np.cos(turn), 0.38, 0.06 * np.sin(turn)]),
        "beside_body": lambda turn: shoulder + np.array([0.02, 0.08, -0.25 + 0.10 * np.sin(turn)]),
    }


def _follow(chain: Chain, path: Path) -> tuple[float, float]:
    """Return the last lap's largest hand error [m] and joint drift [rad]."""
    tracker, steps = Tracker(chain, period=1 / TRACKING_RATE), round(LAP_DURATION * TRACKING_RATE)
    goals = [path(2 * np.pi * step / steps) for step in range(steps)]
    laps = np.array([[tracker.step(target) for target in goals] for _ in range(LAP_COUNT)])
    errors = [float(np.linalg.norm(chain.hand(row) - target)) for row, target in zip(laps[-1], goals, strict=True)]
    return max(errors), float(np.abs(laps[-1] - laps[-2]).max())


def bench() -> list[Metric]:
    """Measure step time, error and drift of path tracking at 200 Hz."""
    chain = Robot.load().arms["l"]
    tracker = Tracker(chain, period=1 / TRACKING_RATE)
    steps = round(LAP_DURATION * TRACKING_RATE)
    goals = [ellipse(2 * np.pi * step / steps) for step in range(steps)]
    seconds: list[float] = []
    laps = []
    for _ in range(LAP_COUNT):
        lap = []
        for target in goals:
            began = perf_counter()
            lap.append(tracker.step(target))
            seconds.append(perf_counter() - began)
        laps.append(lap)
    rows = np.array(laps)
    plain = damped_least_squares(chain, ellipse, steps, LAP_COUNT)
    followed = {name: _follow(chain, path) for name, path in tracking_paths(chain).items()}
    errors, drifts = ({name: pair[k] for name, pair in followed.items()} for k in range(2))
    return [
        Metric("ik.tracking_step_compiled", 1e6 * median(seconds), "us", 1.2, "lower"),
        Metric("ik.tracking_error", 1000 * max(errors.values()), "mm", 0.1, "lower", "worst of four paths"),
        Metric(
            "ik.tracking_drift", max(drifts.values()), "rad", 0.01, "lower", max(drifts, key=lambda name: drifts[name])
        ),
        Metric(
            "ik.tracking_jerk_of_dls",
            jerk(plain, TRACKING_RATE) / jerk(rows, TRACKING_RATE),
            "x",
            50.0,
            "higher",
            "DLS over ours",
        ),
    ]
