"""Tracking delay of hinges by cross-correlation of planned and measured velocity."""

from collections.abc import Callable
from typing import cast

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed

MAX_DELAY = 0.3  # [s] largest delay searched
VELOCITIES_PER_WINDOW = 100_000  # velocities correlated at once; more need more memory


def estimate_tracking_delays(
    planned: Callable[[Indices], Floats], performed: Floats, moving: Flags, *, period: float
) -> Floats:
    """Estimate the delay [s] of each hinge by cross-correlation of velocities.

    Args:
        planned: returns the planned velocities (m, k) [rad/s] of (k,) hinges.
        performed: (m, n) [rad/s] measured velocities at the same times.
        moving: (n,) whether a hinge moves.
        period: [s] between samples; a parabola interpolates between them.

    Returns:
        (n,) [s], positive for a late hinge, NaN for one that does not move.
    """
    delays = np.full(performed.shape[1], np.nan)
    if not moving.any():
        return sealed(delays)
    reach, hinges = round(MAX_DELAY / period), np.flatnonzero(moving)
    window_size = max(1, VELOCITIES_PER_WINDOW // len(performed))
    windows = [hinges[k : k + window_size] for k in range(0, len(hinges), window_size)]
    correlation = np.concatenate([_correlate(planned(window), performed[:, window], reach) for window in windows])
    best = 1 + correlation[:, 1:-1].argmax(axis=1)
    delays[hinges] = period * (best - reach - 1 + _find_vertex(correlation, best))
    return sealed(delays)


def _correlate(planned: Floats, performed: Floats, reach: int) -> Floats:
    """Correlate planned and measured velocities over lags of +-(reach + 1) samples.

    Args:
        planned: (m, k) [rad/s].
        performed: (m, k) [rad/s].
        reach: largest lag [samples].

    Returns:
        (k, 2 reach + 3).
    """
    size = 1 << (len(planned) + reach - 1).bit_length()
    planned_spectrum, measured_spectrum = (np.fft.rfft(speeds.T, size) for speeds in (planned, performed))
    correlation = np.fft.irfft(
        measured_spectrum * planned_spectrum.conj(), size
    )  # (k, size) at lags of 0, 1, ... -2, -1 samples
    return np.concatenate([correlation[:, -reach - 1 :], correlation[:, : reach + 2]], axis=1)


def _find_vertex(correlation: Floats, best: Flags) -> Floats:
    """Refine the lag of highest correlation by fitting a parabola.

    Args:
        correlation: (k, s).
        best: (k,) index of the largest sample of each row.

    Returns:
        (k,) [samples] from the best sample.
    """
    rows = np.arange(len(correlation))
    before, top, after = (correlation[rows, best + step] for step in (-1, 0, 1))
    curvature = before - 2 * top + after
    return cast(
        Floats, np.where(curvature < 0.0, (before - after) / 2 / np.where(curvature < 0.0, curvature, 1.0), 0.0)
    )
