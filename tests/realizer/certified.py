"""Checks of merged motions."""

import numpy as np

from kinesic.motion.limit_check import check_limits
from kinesic.motion.transition import knot_at
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance


def certified(motion, known, before, time: float) -> None:
    """Assert equality before the change, all limits, and clearance afterwards."""
    knot = knot_at(time)
    np.testing.assert_allclose(motion.controls[: knot + 3], before.controls[: knot + 3], atol=1e-8)
    for name, peak in check_limits(motion, known.limits).by_quantity.items():
        assert peak.ratios.max() <= 1.001, name
    assert scan_clearance(motion, known.distances)[1].distances.min() >= known.robot.min_clearance + LAG_RESERVE - 1e-4
