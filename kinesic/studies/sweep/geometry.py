"""Measures a path: its speed, length, volume and curvature, and how often it visits a place. Pure."""

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from kinesic.body.arrays import Floats

FLAT = 1e-3  # [m] a path thinner than this spans no volume
CUT = 10.0  # [Hz] above which nobody moves on purpose: the servos' steps


def peak_speed(path: Floats, *, period: float) -> float:
    """Finds the largest speed [m/s] along (m, 3) [m] with `period` [s] between samples; 0 for fewer than two."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).max(initial=0.0) / period)


def length(path: Floats) -> float:
    """Measures the length [m] of (m, d)."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def hull_volume(path: Floats) -> float:
    """Measures the convex hull of (m, 3) [m] [m^3]; 0 for a path that is a point, a line or lies in a plane."""
    if len(path) < 4:
        return 0.0
    thickness = np.linalg.svd(path - path.mean(axis=0), compute_uv=False)[-1] / np.sqrt(len(path))
    if thickness < FLAT / 10:
        return 0.0
    try:
        return float(ConvexHull(path).volume)
    except QhullError:
        return 0.0


def mean_curvature(path: Floats, *, step: float) -> float | None:
    """Measures how much a path turns per metre of its way [1/m].

    The path is laid out anew in equal steps of arc length, so that neither speed nor stops count: a hand that waits
    adds nothing, and one that stops and turns back adds the half turn that it makes there.

    Args:
        path: (m, 3) [m].
        step: [m] of arc over which a bend is judged; smaller bends are noise.

    Returns:
        The figure, None for a path shorter than four steps.
    """
    ways = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    count = int(ways[-1] / step)
    if count < 4:
        return None
    moved = np.concatenate([[True], np.diff(ways) > 0.0])
    even = np.linspace(0.0, ways[-1], count + 1)
    points = np.stack([np.interp(even, ways[moved], column) for column in path[moved].T], axis=1)
    chords = np.diff(points, axis=0)
    chords /= np.maximum(np.linalg.norm(chords, axis=1, keepdims=True), 1e-12)
    turns = np.arccos(np.clip(np.vecdot(chords[:-1], chords[1:]), -1.0, 1.0))
    return float(turns.sum() / ways[-1])


def rms_jerk(path: Floats, *, period: float) -> float:
    """Measures the root mean square of the jerk over time, of the motion below 10 Hz [m/s^3].

    As motion capture is treated: a fourth-order Butterworth filter, forward and backward, so that nothing is delayed;
    the ticks of the servos would else drown the motion.

    Args:
        path: (m, 3) [m].
        period: [s] between samples.

    Returns:
        The figure, 0 for a path too short to filter.
    """
    from scipy.signal import butter, sosfiltfilt  # noqa: PLC0415 - slow to import, and few motions are measured

    stages = butter(2, CUT, fs=1.0 / period, output="sos")
    if len(path) <= 3 * (2 * len(stages) + 1):
        return 0.0
    smooth = sosfiltfilt(stages, path, axis=0)
    jerks = np.diff(smooth, n=3, axis=0) / period**3
    return float(np.sqrt((jerks**2).sum(axis=1).mean()))


def visits(path: Floats, place: Floats, *, near: float, far: float) -> int:
    """Counts how often a path (m, 3) comes nearer than `near` to a place, having been farther than `far` between."""
    distances = np.linalg.norm(path - place, axis=1)
    count, away = 0, True
    for distance in distances.tolist():
        if away and distance <= near:
            count, away = count + 1, False
        elif not away and distance > far:
            away = True
    return count
