"""Smoothness measures: dimensionless jerk, visible jerk and spectral arc length."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.smoothing import smooth_curve

CUTOFF_FREQUENCY = 10.0  # [Hz] upper limit of voluntary movement (low-pass filter)
NOISE_THRESHOLD = 0.05  # fraction of the peak below which speed or spectrum counts as noise
SPECTRUM_OVERSAMPLING = 16  # interpolation factor of the spectrum, by zero padding
MIN_SPECTRUM_SAMPLES = 3  # minimum number of speed samples for a spectrum


@dataclass(frozen=True)
class HandSmoothness:
    """Smoothness of a hand's path by jerk and spectral arc length."""

    planned_jerk: float | None  # dimensionless; None without motion
    planned_arc_length: float | None  # SPARC; None without motion
    performed_arc_length: float | None  # SPARC; None without motion

    @classmethod
    def of(cls, planned: Floats, performed: Floats, *, period: float) -> "HandSmoothness":
        """Measure the smoothness of a hand's planned and performed path.

        Args:
            planned: (m, 3) [m].
            performed: (m, 3) [m].
            period: [s] between samples.
        """
        return cls(
            dimensionless_jerk(planned, period=period),
            spectral_arc_length(_measure_speeds(planned, period), period=period),
            spectral_arc_length(_measure_speeds(performed, period), period=period),
        )


def dimensionless_jerk(path: Floats, *, period: float) -> float | None:
    """Compute the dimensionless jerk of a path (Hogan and Sternad, 2009).

    It is the integral of the squared jerk, times duration cubed, over peak speed squared. A minimum-jerk reach has
    204.8; each stop within the path increases it.

    Args:
        path: (m, 3) [m].
        period: [s] between samples.

    Returns:
        Dimensionless jerk; None for a path without motion or with fewer than four samples.
    """
    speeds = np.diff(path, axis=0) / period
    peak = float(np.linalg.norm(speeds, axis=1).max(initial=0.0))
    moving = np.flatnonzero(np.linalg.norm(speeds, axis=1) > NOISE_THRESHOLD * peak)
    if not len(moving) or len(path) < 4:
        return None
    jerks = np.diff(path, n=3, axis=0) / period**3
    duration = (moving[-1] - moving[0] + 1) * period
    return float((jerks**2).sum() * period * duration**3 / peak**2)


def visible_jerk(path: Floats, *, period: float) -> float:
    """Compute a path's mean square jerk [m^2/s^6] below 10 Hz.

    Faster oscillations are too small to be seen: servo ticks move a hand by 0.1 mm, with far more jerk than a slow
    reach.

    Args:
        path: (m, 3) [m], longer than 0.2 s.
        period: [s] between samples.
    """
    width = np.sqrt(np.log(2.0)) / (
        2.0 * np.pi * CUTOFF_FREQUENCY * period
    )  # [samples]; half the power passes at the cutoff
    edge = int(np.ceil(3.0 * width))  # samples affected by the ends of the path
    seen = smooth_curve(path, width, ends="symmetric")[edge:-edge]
    return float(((np.diff(seen, n=3, axis=0) / period**3) ** 2).sum(axis=1).mean())


def spectral_arc_length(speeds: Floats, *, period: float) -> float | None:
    """Compute a motion's spectral arc length, SPARC (Balasubramanian et al., 2015).

    It is minus the length of the normalised speed spectrum: about -1.4 for one smooth reach, more negative for a
    rougher one, and insensitive to noise. The spectrum ends at 10 Hz, or where it stays below a twentieth of its
    largest amplitude.

    Args:
        speeds: (m,) in any unit.
        period: [s] between samples.

    Returns:
        Spectral arc length; None without motion or with fewer than three samples.
    """
    if len(speeds) < MIN_SPECTRUM_SAMPLES or not speeds.any():
        return None
    size = SPECTRUM_OVERSAMPLING * 2 ** int(np.ceil(np.log2(len(speeds))))
    spectrum = np.abs(np.fft.rfft(speeds, size))
    spectrum = spectrum[: int(CUTOFF_FREQUENCY * size * period) + 1] / spectrum[0]
    counted = np.flatnonzero(spectrum >= NOISE_THRESHOLD)
    spectrum = spectrum[: counted[-1] + 1]
    across = 1.0 / max(1, len(spectrum) - 1)
    return -float(np.hypot(across, np.diff(spectrum)).sum())


def _measure_speeds(path: Floats, period: float) -> Floats:
    """Return the speeds [m/s] along a path (m, 3) [m]."""
    return np.asarray(np.linalg.norm(np.diff(path, axis=0), axis=1) / period)
