"""Measures how late each hinge follows, by cross-correlation of planned and performed speed."""

from collections.abc import Callable
from typing import cast

import numpy as np
import scipy

from kinesic.body.arrays import Flags, Floats, Indices, sealed

LONGEST_DELAY = 0.3  # [s] longest lateness that is looked for
SPEEDS_PER_WINDOW = 100_000  # speeds that are compared together


def tracking_delay(planned: Callable[[Indices], Floats], performed: Floats, moving: Flags, *, period: float) -> Floats:
    """Finds the delay at which the performed speed of each hinge is most like the planned one.

    Args:
        planned: gives (m, k) [rad/s] of (k,) hinges.
        performed: (m, n) [rad/s] of all hinges at the same times.
        moving: (n,) which hinges move at all.
        period: [s] between samples; the delay is found between samples by a parabola.

    Returns:
        (n,) [s], positive when the hinge is late, NaN for one that does not move.
    """
    late = np.full(performed.shape[1], np.nan)
    if not moving.any():
        return sealed(late)
    reach, hinges = round(LONGEST_DELAY / period), np.flatnonzero(moving)
    few = max(1, SPEEDS_PER_WINDOW // len(performed))
    parts = [hinges[k : k + few] for k in range(0, len(hinges), few)]
    likeness = np.concatenate([_compare(planned(some), performed[:, some], reach) for some in parts])
    best = 1 + likeness[:, 1:-1].argmax(axis=1)
    late[hinges] = period * (best - reach - 1 + _summit(likeness, best))
    return sealed(late)


def _compare(planned: Floats, performed: Floats, reach: int) -> Floats:
    """(k, 2 reach + 3) how much alike speeds (m, k) are at delays of up to so many samples, and one more."""
    size = scipy.fft.next_fast_len(len(planned) + reach, real=True)
    asked, seen = (scipy.fft.rfft(speeds.T, size) for speeds in (planned, performed))
    likeness = scipy.fft.irfft(seen * asked.conj(), size)  # (k, size) at delays of 0, 1, ... -2, -1 samples
    return np.concatenate([likeness[:, -reach - 1 :], likeness[:, : reach + 2]], axis=1)


def _summit(likeness: Floats, best: Flags) -> Floats:
    """(k,) samples from the best sample of each row to the top of the parabola through it and its neighbours."""
    rows = np.arange(len(likeness))
    before, top, after = (likeness[rows, best + step] for step in (-1, 0, 1))
    bend = before - 2 * top + after
    return cast(Floats, np.where(bend < 0.0, (before - after) / 2 / np.where(bend < 0.0, bend, 1.0), 0.0))
