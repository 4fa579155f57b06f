"""Observer constants packed for the compiled kernel.

See `controller.observer`.
"""

import numpy as np

from kinesic._kernel import controller as kernel
from kinesic.body.arrays import Floats, sealed

RESTORING_GAINS = sealed([0.2, 0.02, 0.2])  # corrections per deviation [1], per velocity [s] and per disturbance [1]
LOAD_ERROR_RANGE = (-0.5, 1.0)  # smallest and largest relative load error: half and twice the modelled load
DISTURBANCE_DECAY = 0.95  # factor per tick on the estimated disturbance of a servo that does not answer


def pack_observer(
    forecast: Floats, gain: Floats, step: Floats, full: Floats, arrival: Floats, restoring: float
) -> kernel.Observer:
    """Pack an observer's gains and limits for the compiled kernel.

    Args:
        forecast: (3, 3, n) transition of deviation, velocity and disturbance over one tick.
        gain: (3, n) of the innovation.
        step: (n,) [rad] of correction per tick.
        full: (n,) [rad] error of full duty.
        arrival: (h,) fraction of each setpoint in flight that acts in this tick.
        restoring: fraction of `RESTORING_GAINS` that is used.
    """
    constants = np.array([*(restoring * RESTORING_GAINS), *LOAD_ERROR_RANGE, DISTURBANCE_DECAY])
    return kernel.make_observer(forecast, gain, step, full, arrival, constants)
