"""Measures how smoothly a point moves: dimensionless jerk and spectral arc length."""

import numpy as np
import scipy

from kinesic.body.arrays import Floats

CUT = 10.0  # [Hz] above which nobody moves on purpose
THRESHOLD = 0.05  # of the largest magnitude, below which the spectrum is noise
FINENESS = 16  # by which the spectrum is interpolated


def dimensionless_jerk(path: Floats, *, period: float) -> float | None:
    """Integrates the squared jerk, times duration cubed, over peak speed squared (Hogan and Sternad, 2009).

    A single reach of minimum jerk has 204.8; every stop between makes it larger.

    Args:
        path: (m, 3) [m].
        period: [s] between samples.

    Returns:
        The figure, None for a path without motion.
    """
    speeds = np.diff(path, axis=0) / period
    peak = float(np.linalg.norm(speeds, axis=1).max(initial=0.0))
    moving = np.flatnonzero(np.linalg.norm(speeds, axis=1) > THRESHOLD * peak)
    if not len(moving) or len(path) < 4:
        return None
    jerks = np.diff(path, n=3, axis=0) / period**3
    duration = (moving[-1] - moving[0] + 1) * period
    return float((jerks**2).sum() * period * duration**3 / peak**2)


def spectral_arc_length(path: Floats, *, period: float) -> float | None:
    """Computes SPARC: minus the length of the normalised spectrum of the speed (Balasubramanian et al., 2015).

    About -1.4 for one smooth reach; more negative when rougher, and not sensitive to noise.

    Args:
        path: (m, 3) [m].
        period: [s] between samples.

    Returns:
        The figure, None for a path without motion.
    """
    speed = np.linalg.norm(np.diff(path, axis=0), axis=1) / period
    if not len(speed) or speed.max() == 0.0:
        return None
    size = FINENESS * 2 ** int(np.ceil(np.log2(len(speed))))
    spectrum = np.abs(scipy.fft.rfft(speed, size))
    spectrum = spectrum[: int(CUT * size * period) + 1] / spectrum[0]
    counted = np.flatnonzero(spectrum >= THRESHOLD)
    spectrum = spectrum[: counted[-1] + 1]
    across = 1.0 / max(1, len(spectrum) - 1)
    return -float(np.hypot(across, np.diff(spectrum)).sum())
