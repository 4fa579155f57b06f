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


def measure_errors(planned: Floats, measured: Floats, moving: Flags) -> TrackingErrors:
    """Measures root mean square, 95th percentile and largest error.

    Args:
        planned: (m, n) [rad].
        measured: (m, n) [rad] at the same times.
        moving: (m, n) what counts.
    """
    if not moving.any():
        return TrackingErrors(0.0, 0.0, 0.0, 0, 0, 0)
    if KERNEL == "compiled":
        return TrackingErrors(*_kernel.tracking_errors(planned, measured, moving))
    errors = np.where(moving, np.degrees(np.abs(measured - planned)), 0.0)
    row, hinge = np.unravel_index(int(errors.argmax()), errors.shape)
    counted = errors[moving]
    return TrackingErrors(
        rmse=float(np.sqrt(np.mean(counted**2))),
        p95=float(np.percentile(counted, 95)),
        max=float(counted.max()),
        row=int(row),
        hinge=int(hinge),
        most=int((errors**2).sum(axis=0).argmax()),
    )
