"""Gaussian smoothing of sampled curves."""

from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats

KERNEL_RADIUS = 4.0  # [standard deviations] at which the Gaussian kernel is cut off


def smooth_curve(values: Floats, deviation: float, *, ends: Literal["symmetric", "edge"]) -> Floats:
    """Convolve the columns of a curve with a Gaussian kernel.

    Args:
        values: (m, n) samples.
        deviation: standard deviation of the kernel [samples].
        ends: how the curve continues beyond its ends: mirrored, or constant.

    Returns:
        (m, n) smooth samples.
    """
    radius = int(KERNEL_RADIUS * deviation + 0.5)
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / deviation) ** 2)
    kernel /= kernel.sum()
    continued = np.pad(values, ((radius, radius), (0, 0)), mode=ends)
    return np.stack([np.convolve(column, kernel, mode="valid") for column in continued.T], axis=1)
