from dataclasses import replace

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.motion.limit_check import check_limits, find_beyond
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary import changes
from kinesic.planning.secondary.changes import REDUCED_AMOUNT, Changes

from ...performances import LIMITS
from .tilts import REST_ANGLES, STILL_MOTION, TILT_HINGE, swell


def allowed(motion, swells):
    count = len(swells)
    return Changes(motion, swells).within_limits(np.ones(count), np.ones(count, dtype=np.bool_), LIMITS).tolist()


def largest(motion):
    return max(peak.ratios.max() for peak in check_limits(motion, LIMITS).by_quantity.values())


def test_secondary_motion_is_reduced_where_it_would_exceed_joint_limits():
    small, wide = swell(1.0, 2.0, 3.0), swell(1.0, 2.0, 3.0, degrees=-16.0)
    assert allowed(STILL_MOTION, [small]) == [1.0]
    assert allowed(STILL_MOTION, [wide]) == [REDUCED_AMOUNT], "the range ends at -15 degrees"
    assert allowed(STILL_MOTION, [replace(wide, away=4.0 * wide.away)]) == [0.0]
    elsewhere = swell(3.5, 4.0, 4.5), swell(1.0, 2.0, 3.0, hinge=TILT_HINGE - 1)
    assert allowed(STILL_MOTION, [wide, *elsewhere]) == [REDUCED_AMOUNT, 1.0, 1.0]


def test_existing_limit_violation_prevents_only_secondary_motion_that_overlaps_it():
    sharp = np.tile(REST_ANGLES, (200, 1))
    sharp[100:, TILT_HINGE] += np.radians(20.0)
    motion = Trajectory(sealed(sharp), 0.0)
    assert largest(motion) > 1.0
    aside = swell(0.1, 0.4, 0.7)
    across = replace(aside, begin=0.5, peak=1.0, end=1.5)
    assert allowed(motion, [aside]) == [1.0]
    assert allowed(motion, [across]) == [0.0]


def test_motion_offset_that_would_violate_a_limit_just_before_its_start_is_omitted():
    jerks = 0.999 * LIMITS.jerk[TILT_HINGE] * np.repeat([0.0, 1.0, -0.5, 0.5, 0.0], [100, 2, 8, 4, 100])
    reach = np.tile(REST_ANGLES, (len(jerks) + 3, 1))
    reach[3:, TILT_HINGE] += np.cumsum(np.cumsum(np.cumsum(jerks))) * KNOT_INTERVAL**3
    motion, switch = Trajectory(sealed(reach), 0.0), 102 * KNOT_INTERVAL
    begun = swell(switch + 0.1 * KNOT_INTERVAL, switch + 0.3, switch + 0.7, degrees=5.0)
    laid = Changes(motion, [begun]).added(np.ones(1))
    over = np.flatnonzero(np.abs(np.diff(laid.controls[:, TILT_HINGE], 3)) / KNOT_INTERVAL**3 > LIMITS.jerk[TILT_HINGE])
    assert largest(motion) < 1.0 < largest(laid)
    assert over.max() * KNOT_INTERVAL < begun.begin
    assert allowed(motion, [begun]) == [0.0]


def test_secondary_motion_beyond_joint_limits_after_the_motion_end_is_omitted():
    end = STILL_MOTION.end
    over, after = (swell(end + first, end + first + 1.0, end + first + 2.0, degrees=-60.0) for first in (-1.0, 0.5))
    small = swell(0.5, 1.0, 1.5)
    assert allowed(STILL_MOTION, [small, over, after]) == [1.0, 0.0, 0.0]
    assert Changes(STILL_MOTION, [small, over, after]).added(np.array([1.0, 0.0, 0.0])).end == end


def test_joint_limits_are_rechecked_only_near_reduced_secondary_motion(monkeypatch):
    looked_at = []

    def find(controls, *others, full):
        looked_at.append(controls.shape[-1])
        return find_beyond(controls, *others, full=full)

    monkeypatch.setattr(changes, "find_beyond", find)
    wide, far = swell(1.0, 1.5, 2.0, degrees=-16.0), swell(3.5, 4.0, 4.5)
    assert allowed(STILL_MOTION, [wide, far]) == [REDUCED_AMOUNT, 1.0]
    assert looked_at[-1] < 1.2 / KNOT_INTERVAL < looked_at[0], "a second of a swell, and not the whole motion"


def test_secondary_motion_within_the_first_knot_interval_has_no_effect():
    early, late = swell(0.0, 0.004, 0.008), swell(1.0, 1.5, 2.0)
    alone, both = (Changes(STILL_MOTION, every).added(np.ones(len(every))) for every in ([late], [early, late]))
    np.testing.assert_array_equal(both.controls, alone.controls)
