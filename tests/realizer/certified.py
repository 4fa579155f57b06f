"""What holds of a motion that was laid over a running one."""

import numpy as np

from kinesic.motion.limit_check import check_limits
from kinesic.motion.transition import knot_at
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance


def certified(motion, known, before, time: float) -> None:
    """The same until the cut; then within all limits, and clear of the body."""
    knot = knot_at(time)
    np.testing.assert_allclose(motion.controls[: knot + 3], before.controls[: knot + 3], atol=1e-8)
    for name, peak in check_limits(motion, known.limits).shares.items():
        assert peak.ratios.max() <= 1.001, name
    assert (
        scan_clearance(motion, known.distances)[1].distances.min() >= known.robot.least_clearance + LAG_RESERVE - 1e-4
    )
