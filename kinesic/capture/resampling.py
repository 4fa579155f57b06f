"""Resampling and low-pass filtering of captured samples."""

from collections.abc import Sequence
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from kinesic.body.arrays import Floats, sealed
from kinesic.capture.robot_motion import SAMPLE_RATE

CUTOFF_FREQUENCY = 6.0  # [Hz] default low-pass cut-off of captured motion, above gesture frequencies
FILTER_ORDER = 2  # order of the Butterworth filter, applied forward and backward
MAX_PADDING = 1.0  # [s] longest padding at each end of a filtered signal


def resample_times(times: Floats) -> Floats:
    """Return times [s] from 0 at `SAMPLE_RATE`, spanning the original times."""
    count = int(np.floor((times[-1] - times[0]) * SAMPLE_RATE + 1e-6)) + 1
    resampled: Floats = np.arange(max(count, 2)) / SAMPLE_RATE
    return resampled


def resample(times: Floats, values: Floats, new_times: Floats) -> Floats:
    """Interpolate samples (m, k) by cubic splines, holding the last sample."""
    curve = CubicSpline(times, values)
    sampled: Floats = curve(np.minimum(new_times, times[-1]))
    return sampled


def smooth_paths(times: Floats, paths: Sequence[Floats], new_times: Floats) -> list[Floats]:
    """Resample and low-pass filter several paths (m, 3) together."""
    smoothed = low_pass(resample(times, np.concatenate(paths, axis=1), new_times))
    return [sealed(path) for path in np.split(smoothed, len(paths), axis=1)]


def low_pass(values: Floats, cutoff: float = CUTOFF_FREQUENCY) -> Floats:
    """Low-pass filter samples (m, k) at `SAMPLE_RATE` without phase shift.

    Args:
        values: samples.
        cutoff: [Hz] frequency of half power, in each of both directions.
    """
    from scipy.signal import sosfiltfilt  # noqa: PLC0415 - slow import, not needed to read or judge motion

    padding = min(len(values) - 1, round(MAX_PADDING * SAMPLE_RATE))
    filtered: Floats = sosfiltfilt(_design_filter(cutoff), values, axis=0, padlen=padding)
    return filtered


@cache
def _design_filter(cutoff: float) -> Floats:
    """Return the second-order sections of a low-pass filter."""
    from scipy.signal import butter  # noqa: PLC0415 - likewise

    sections: Floats = butter(FILTER_ORDER, cutoff, fs=SAMPLE_RATE, output="sos")
    return sections
