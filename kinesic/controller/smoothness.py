"""Measures how smoothly a point moves: dimensionless jerk, jerk that is seen, and spectral arc length."""

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


def visible_jerk(path: Floats, *, period: float) -> float:
    """Measures the mean square of the jerk [m^2/s^6] below 10 Hz, where a shake is large enough to be seen.

    The jerk of a servo's ticks is far larger than that of a slow reach, though they move a hand by 0.1 mm.

    Args:
        path: (m, 3) [m], longer than 0.2 s.
        period: [s] between samples.
    """
    width = np.sqrt(np.log(2.0)) / (2.0 * np.pi * CUT * period)  # [samples]; half the power passes at CUT
    edge = int(np.ceil(3.0 * width))  # where the filter looks beyond the path
    seen = scipy.ndimage.gaussian_filter1d(path, width, axis=0)[edge:-edge]
    return float(((np.diff(seen, n=3, axis=0) / period**3) ** 2).sum(axis=1).mean())


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
