"""Time shift between a clip's stroke and its certified motion's stroke."""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side
from kinesic.capture.clip import ArmPath
from kinesic.capture.robot_motion import SAMPLE_RATE

HALF_WINDOW = 0.4  # [s] duration of the compared motion before and after the stroke marker
MAX_SHIFT = 0.6  # [s] largest shift that is searched
MIN_DEVIATION = 1e-3  # [arm lengths/s] standard deviation of the velocity below which a window has no stroke


def measure_stroke_shift(
    stroke: float, desired: Mapping[Side, ArmPath], reached: Mapping[Side, ArmPath], reached_times: Floats
) -> float | None:
    """Return the delay [s] of a motion's stroke relative to its clip.

    It is the lag at which the velocities of clip and motion correlate most, without use of any marker of the motion.

    Args:
        stroke: time of the marker in the clip [s].
        desired: paths of the clip at `SAMPLE_RATE`.
        reached: paths of the robot at `reached_times`.
        reached_times: (m,) performance times of the clip's samples [s].

    Returns:
        None if no wrist moves around the marker.
    """
    before = _wrist_velocity(desired)
    count = len(before)
    grid = reached_times[0] + np.arange(-_samples(MAX_SHIFT), count + _samples(MAX_SHIFT)) / SAMPLE_RATE
    after = np.interp(grid, reached_times, _wrist_velocity(reached) / np.gradient(reached_times) / SAMPLE_RATE)
    middle = min(max(round(stroke * SAMPLE_RATE), 0), count - 1)
    window = np.arange(max(middle - _samples(HALF_WINDOW), 0), min(middle + _samples(HALF_WINDOW) + 1, count))
    wanted = before[window]
    if wanted.std() < MIN_DEVIATION:
        return None
    lags = np.arange(2 * _samples(MAX_SHIFT) + 1)
    moved = after[window + lags[:, None]]
    centred = moved - moved.mean(axis=1, keepdims=True)
    likeness = centred @ (wanted - wanted.mean()) / np.maximum(centred.std(axis=1), MIN_DEVIATION)
    return float((int(likeness.argmax()) - _samples(MAX_SHIFT)) / SAMPLE_RATE)


def _wrist_velocity(arms: Mapping[Side, ArmPath]) -> Floats:
    """Return the velocity (m,) of the faster wrist [arm lengths/s], at `SAMPLE_RATE`."""
    wrists = [arm.wrist for arm in arms.values()]
    velocity: Floats = np.max([np.linalg.norm(np.gradient(w, axis=0), axis=1) for w in wrists], axis=0) * SAMPLE_RATE
    return velocity


def _samples(seconds: float) -> int:
    return round(seconds * SAMPLE_RATE)
