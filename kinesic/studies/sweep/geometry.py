"""Measures of hand paths: speed, length, volume, curvature, jerk and visits."""

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from kinesic.body.arrays import Floats

MIN_THICKNESS = 1e-4  # [m] RMS thickness below which a path counts as flat
CURVATURE_OFFSET_COUNT = 16  # start offsets of the resampled path over which its curvature is averaged
JERK_CUTOFF = 10.0  # [Hz] cutoff frequency: intended motion is slower, servo steps are faster


def peak_speed(path: Floats, *, period: float) -> float:
    """Return the largest speed [m/s] along a path (m, 3) [m].

    `period` [s] is the time between samples; the result is 0 for fewer than two.
    """
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).max(initial=0.0) / period)


def length(path: Floats) -> float:
    """Return the length [m] of a path (m, d)."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def hull_volume(path: Floats) -> float:
    """Return the volume [m^3] of a path's convex hull.

    The result is 0 for flat paths.
    """
    if len(path) < 4:
        return 0.0
    thickness = np.linalg.svd(path - path.mean(axis=0), compute_uv=False)[-1] / np.sqrt(len(path))
    if thickness < MIN_THICKNESS:
        return 0.0
    try:
        return float(ConvexHull(path).volume)
    except QhullError:
        return 0.0


def mean_curvature(path: Floats, *, step: float) -> float | None:
    """Return the mean curvature of a path, its rotation per length [1/m].

    The path is resampled at equal arc lengths, so that neither speed nor stops count: a waiting hand adds nothing, and
    a hand that stops and reverses adds a half turn. A short reversal counts fully or not at all, depending on where the
    first sample lies. The result is therefore the mean over several first samples.

    Args:
        path: positions (m, 3) [m].
        step: arc length over which bends are measured [m]; smaller bends count as noise.

    Returns:
        The curvature, None for a path shorter than four steps.
    """
    distances = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    if distances[-1] < 4 * step:
        return None
    has_moved = np.concatenate([[True], np.diff(distances) > 0.0])
    distances, path = distances[has_moved], path[has_moved]
    offsets = step * np.arange(CURVATURE_OFFSET_COUNT) / CURVATURE_OFFSET_COUNT
    return float(np.mean([_sum_bends(path, distances, offset, step) for offset in offsets]) / distances[-1])


def _sum_bends(path: Floats, distances: Floats, offset: float, step: float) -> float:
    """Return the total rotation [rad] of a path sampled at equal distances.

    Args:
        path: positions (m, 3) [m].
        distances: arc lengths of the positions (m,) [m], increasing.
        offset: arc length of the first sample [m].
        step: arc length between samples [m].
    """
    samples = np.arange(offset, distances[-1], step)
    chords = np.diff(np.stack([np.interp(samples, distances, column) for column in path.T], axis=1), axis=0)
    chords /= np.maximum(np.linalg.norm(chords, axis=1, keepdims=True), 1e-12)
    return float(np.arccos(np.clip(np.vecdot(chords[:-1], chords[1:]), -1.0, 1.0)).sum())


def rms_jerk(path: Floats, *, period: float) -> float:
    """Return the RMS jerk [m/s^3] of a hand's motion below 10 Hz.

    As for motion capture, a fourth-order Butterworth filter is applied forward and backward, without delay. Otherwise
    the ticks of the servos would dominate the jerk.

    Args:
        path: positions (m, 3) [m].
        period: time between samples [s].

    Returns:
        The jerk, 0 for a path too short to filter.
    """
    from scipy.signal import butter, sosfiltfilt  # noqa: PLC0415 - slow import, rarely needed

    stages = butter(2, JERK_CUTOFF, fs=1.0 / period, output="sos")
    if len(path) <= 3 * (2 * len(stages) + 1):
        return 0.0
    smooth = sosfiltfilt(stages, path, axis=0)
    jerks = np.diff(smooth, n=3, axis=0) / period**3
    return float(np.sqrt((jerks**2).sum(axis=1).mean()))


def count_visits(path: Floats, position: Floats, *, near: float, far: float) -> int:
    """Count visits of a path (m, 3) to a position.

    Its radius is `near`; a new visit counts after the path was farther than `far`.
    """
    distances = np.linalg.norm(path - position, axis=1)
    count, is_away = 0, True
    for distance in distances.tolist():
        if is_away and distance <= near:
            count, is_away = count + 1, False
        elif not is_away and distance > far:
            is_away = True
    return count
