"""Measures how far hinges are from where a plan has them, over all samples at which they move."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.kernels import Kernel, find_kernel

KERNEL: Kernel = find_kernel("kinesic.controller._kernel")  # which implementation runs

if KERNEL == "compiled":
    from kinesic.controller import _kernel


@dataclass(frozen=True)
class TrackingErrors:
    """Errors of all moving hinges together [deg]; 0 when nothing moves."""

    rmse: float
    p95: float
    max: float
    row: int  # of the largest, among the samples
    hinge: int  # whose is the largest
    most: int  # the hinge whose squares sum up to most


def measure_errors(errors: Floats, moving: Flags) -> TrackingErrors:
    """Measures root mean square, 95th percentile and largest error.

    Args:
        errors: (k,) [rad] of hinges while they move, sample after sample.
        moving: (m, n) in which samples each of them moves: k times in all.
    """
    if not moving.any():
        return TrackingErrors(0.0, 0.0, 0.0, 0, 0, 0)
    if KERNEL == "compiled" and not np.isnan(errors.sum()):  # it sorts, for which all must be numbers
        return TrackingErrors(*_kernel.tracking_errors(errors, moving))
    counted, (rows, hinges) = np.degrees(np.abs(errors)), np.nonzero(moving)
    largest = int(counted.argmax())
    return TrackingErrors(
        rmse=float(np.sqrt(np.mean(counted**2))),
        p95=float(np.percentile(counted, 95)),
        max=float(counted.max()),
        row=int(rows[largest]),
        hinge=int(hinges[largest]),
        most=int(np.bincount(hinges, counted**2).argmax()),
    )
