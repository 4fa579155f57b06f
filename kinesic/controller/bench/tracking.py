"""How an arm follows a path: time of a step, error, and whether it comes home after a lap."""

from statistics import median
from time import perf_counter

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.controller.bench.figure import Figure
from kinesic.controller.bench.plain import damped_least_squares, jerk
from kinesic.ik import KERNEL
from kinesic.ik.track import Tracker

RATE = 200  # [Hz]
LAP = 2.5  # [s]
LAPS = 3


def ellipse(turn: float) -> Floats:
    """(3,) [m] 0.24 x 0.36 m in front of the left shoulder, in the frame of the chain's base."""
    return np.array([0.28, 0.1 + 0.12 * np.cos(turn), -0.05 + 0.18 * np.sin(turn)])


def bench() -> list[Figure]:
    """Laps of an ellipse at 200 Hz."""
    chain = Robot.load().arms["l"]
    tracker = Tracker(chain, period=1 / RATE)
    steps = round(LAP * RATE)
    path = [ellipse(2 * np.pi * step / steps) for step in range(steps)]
    seconds: list[float] = []
    laps = []
    for _ in range(LAPS):
        lap = []
        for target in path:
            began = perf_counter()
            lap.append(tracker.step(target))
            seconds.append(perf_counter() - began)
        laps.append(lap)
    rows = np.array(laps)
    plain = damped_least_squares(chain, ellipse, steps, LAPS)
    errors = [float(np.linalg.norm(chain.hand(row) - target)) for row, target in zip(rows[-1], path, strict=True)]
    return [
        Figure(f"ik.tracking_step_{KERNEL}", 1e6 * median(seconds), "us", 1.2, "lower"),
        Figure("ik.tracking_error", 1000 * max(errors), "mm", 0.1, "lower"),
        Figure("ik.tracking_drift", float(np.abs(rows[-1] - rows[-2]).max()), "rad", 0.01, "lower"),
        Figure("ik.tracking_jerk_of_dls", jerk(plain, RATE) / jerk(rows, RATE), "x", 50.0, "higher", "DLS over ours"),
    ]
