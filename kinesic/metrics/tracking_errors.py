"""Statistics of the tracking errors of moving hinges."""

from dataclasses import dataclass

import numpy as np

from kinesic._kernel import metrics as kernel
from kinesic.body.arrays import Flags, Floats


@dataclass(frozen=True)
class TrackingErrors:
    """Tracking error statistics of moving hinges [deg], 0 without motion."""

    rmse: float
    p95: float
    max: float
    row: int  # index of the sample with the largest error
    hinge: int  # index of the hinge with the largest error
    most: int  # index of the hinge with the largest sum of squared errors


def measure_errors(errors: Floats, moving: Flags) -> TrackingErrors:
    """Compute RMS, 95th percentile and largest tracking error of moving hinges.

    Args:
        errors: (k,) [rad] of moving hinges, sample by sample.
        moving: (m, n) whether a hinge moves at a sample; True k times.

    Returns:
        NaN statistics if an error is NaN, with the sample and hinge of the first NaN.
    """
    if not moving.any():
        return TrackingErrors(0.0, 0.0, 0.0, 0, 0, 0)
    if np.isnan(errors.sum()):  # the kernel sorts the errors, and NaN has no place in an order
        rows, hinges = (places[np.isnan(errors)] for places in np.nonzero(moving))
        return TrackingErrors(np.nan, np.nan, np.nan, int(rows[0]), int(hinges[0]), int(hinges.min()))
    return TrackingErrors(*kernel.tracking_errors(errors, moving))
