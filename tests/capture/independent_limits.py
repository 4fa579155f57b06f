"""Limits of a motion at 10 kHz, by SciPy's B-splines and without code of kinesic's motion packages."""

import numpy as np
from scipy.interpolate import BSpline

RATE = 10_000.0  # [Hz] rate at which limits are checked
KNOT = 0.01  # [s] time between two knots of a trajectory


def derivatives(controls) -> list[np.ndarray]:
    """Return angles, velocities, accelerations and jerks (m, n) of a uniform cubic B-spline at `RATE`."""
    count = len(controls) - 3
    knots = KNOT * np.arange(-3, count + 4)
    spline = BSpline(knots, controls, 3)
    times = np.arange(0.0, count * KNOT, 1.0 / RATE)
    return [spline.derivative(order)(times) if order else spline(times) for order in range(4)]


def largest_ratios(controls, limits) -> dict[str, float]:
    """Return the largest value / limit by kind; positions: the excess [rad]."""
    angles, velocity, acceleration, jerk = derivatives(np.asarray(controls))
    duty = limits.inertial * acceleration + limits.viscous * velocity
    return {
        "position": float(np.maximum(angles - limits.upper, limits.lower - angles).max()),
        "velocity": float((np.abs(velocity) / limits.speed).max()),
        "acceleration": float((np.abs(acceleration) / limits.acceleration).max()),
        "jerk": float((np.abs(jerk) / limits.jerk).max()),
        "duty": float((np.abs(duty) / limits.duty).max()),
    }


def assert_within_limits(trajectory, limits) -> None:
    """Check that a trajectory satisfies every limit."""
    ratios = largest_ratios(trajectory.controls, limits)
    assert ratios.pop("position") <= 1e-9
    assert max(ratios.values()) <= 1.001, ratios
