"""Samples and limit ratios of cubic B-splines, computed by their definition."""

import numpy as np

from kinesic.body.limits import Limits
from kinesic.motion.bspline import STENCIL_WIDTHS, grid
from kinesic.motion.limit_check import CHECK_RATE
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, spline_weights

INSTANTS = np.linspace(0.0, 1.0, round(CHECK_RATE * KNOT_INTERVAL) + 1)  # normalised sample times of a knot interval


def sample(motion: Trajectory, times):
    """Return angles, velocities and accelerations (m, n) at times (m,) [s]."""
    local = times - motion.start
    values = [_derivative(motion.controls, local, order) for order in range(3)]
    for derivative in values[1:]:
        derivative[(local < 0.0) | (local > motion.duration)] = 0.0
    return values


def _derivative(controls, times, order: int):
    first, weights = spline_weights(times / KNOT_INTERVAL, len(controls) - 3, order)
    points = np.diff(controls, order, axis=0) / KNOT_INTERVAL**order
    return sum(weights[:, k : k + 1] * points[first + k] for k in range(weights.shape[1]))


def limit_ratios(motion: Trajectory, limits: Limits):
    """Return the ratio of each quantity to its limit, by name."""
    points = [np.diff(motion.controls, order, axis=0) / KNOT_INTERVAL**order for order in range(4)]
    middle, half = (limits.upper + limits.lower) / 2, (limits.upper - limits.lower) / 2
    duty = _instants(limits.inertial / limits.duty * points[2], 2)
    return {
        "position": _instants((points[0] - middle) / half, 0),
        "speed": _instants(points[1] / limits.speed, 1),
        "acceleration": _instants(points[2] / limits.acceleration, 2),
        "jerk": (points[3] / limits.jerk)[:, None],
        "duty": duty + _instants(limits.viscous / limits.duty * points[1], 1),
    }


def _instants(points, order: int):
    _, weights = spline_weights(INSTANTS, 1, order)
    count = len(points) - 3 + order
    return sum(weights[:, k, None] * points[k : k + count, None] for k in range(4 - order))


def find_beyond(controls, before, limits: Limits, hinges, *, full: float):
    """Compute the flags (h, k) of `limit_check.find_beyond`."""
    flags = np.zeros(controls.shape, dtype=np.bool_)
    splines = grid(controls.shape[1] - 3, KNOT_INTERVAL)
    ratios, earlier = (splines.limit_ratios(points, limits, hinges) for points in (controls, before))
    for width, ratio, once in zip((1, *STENCIL_WIDTHS), ratios, earlier, strict=True):
        over = np.abs(ratio) > np.maximum(full, np.abs(once) + full - 1.0)
        for k in range(width):
            flags[:, k : k + over.shape[1]] |= over
    return flags
