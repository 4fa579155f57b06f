"""Derivatives of sampled motions, and the time stretch that limits require."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.capture.robot_motion import SAMPLE_RATE


def compute_time_stretch(angles: Floats, limits: Limits) -> Floats:
    """Return the local time stretch (m,) that satisfies limits, at least 1.

    Considers velocity, acceleration, jerk and duty limits of all joints.
    """
    velocity, acceleration, jerk = (np.abs(values) for values in differentiate(angles))
    viscous = limits.viscous * velocity
    duty = (viscous + np.sqrt(viscous**2 + 4.0 * limits.duty * limits.inertial * acceleration)) / (2.0 * limits.duty)
    ratios = (
        velocity / limits.speed,
        np.sqrt(acceleration / limits.acceleration),
        np.cbrt(jerk / limits.jerk),
        duty,
    )
    required: Floats = np.maximum(1.0, np.max(ratios, axis=(0, 2)))
    return required


def differentiate(angles: Floats) -> tuple[Floats, Floats, Floats]:
    """Return velocities, accelerations and jerks (m, n) of samples at `SAMPLE_RATE`.

    They are differences over one, two and three intervals, centred as far as possible; zero at the ends.
    """
    derivatives = []
    difference = angles
    for order in range(1, 4):
        difference = np.diff(difference, axis=0) * SAMPLE_RATE if len(difference) > 1 else np.zeros_like(angles[:0])
        missing = len(angles) - len(difference)
        before = min(missing, (order + 1) // 2)
        derivatives.append(np.pad(difference, ((before, missing - before), (0, 0))))
    velocity, acceleration, jerk = derivatives
    return velocity, acceleration, jerk
