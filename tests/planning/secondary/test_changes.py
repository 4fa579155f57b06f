from dataclasses import replace

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.motion.limit_check import check_limits, find_beyond
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.secondary import changes
from kinesic.planning.secondary.changes import LESS, Changes

from ...performances import LIMITS
from .tilts import REST, STILL, TILT, swell


def allowed(motion, swells):
    count = len(swells)
    return Changes(motion, swells).within_limits(np.ones(count), np.ones(count, dtype=np.bool_), LIMITS).tolist()


def largest(motion):
    return max(peak.ratios.max() for peak in check_limits(motion, LIMITS).shares.values())


def test_only_what_swells_break_makes_them_less():
    small, wide = swell(1.0, 2.0, 3.0), swell(1.0, 2.0, 3.0, degrees=-16.0)
    assert allowed(STILL, [small]) == [1.0]
    assert allowed(STILL, [wide]) == [LESS], "the range ends at -15 degrees"
    assert allowed(STILL, [replace(wide, away=4.0 * wide.away)]) == [0.0]
    elsewhere = swell(3.5, 4.0, 4.5), swell(1.0, 2.0, 3.0, hinge=TILT - 1)
    assert allowed(STILL, [wide, *elsewhere]) == [LESS, 1.0, 1.0]


def test_a_limit_that_a_motion_breaks_alone_is_no_reason_against_a_swell_that_leaves_it():
    sharp = np.tile(REST, (200, 1))
    sharp[100:, TILT] += np.radians(20.0)
    motion = Trajectory(sealed(sharp), 0.0)
    assert largest(motion) > 1.0
    aside = swell(0.1, 0.4, 0.7)
    across = replace(aside, begin=0.5, peak=1.0, end=1.5)
    assert allowed(motion, [aside]) == [1.0]
    assert allowed(motion, [across]) == [0.0]


def test_a_swell_gives_way_where_it_breaks_a_limit_just_before_it_begins():
    jerks = 0.999 * LIMITS.jerk[TILT] * np.repeat([0.0, 1.0, -0.5, 0.5, 0.0], [100, 2, 8, 4, 100])
    reach = np.tile(REST, (len(jerks) + 3, 1))
    reach[3:, TILT] += np.cumsum(np.cumsum(np.cumsum(jerks))) * STEP**3
    motion, switch = Trajectory(sealed(reach), 0.0), 102 * STEP
    begun = swell(switch + 0.1 * STEP, switch + 0.3, switch + 0.7, degrees=5.0)
    laid = Changes(motion, [begun]).added(np.ones(1))
    over = np.flatnonzero(np.abs(np.diff(laid.controls[:, TILT], 3)) / STEP**3 > LIMITS.jerk[TILT])
    assert largest(motion) < 1.0 < largest(laid)
    assert over.max() * STEP < begun.begin
    assert allowed(motion, [begun]) == [0.0]


def test_what_is_too_wide_after_the_end_of_a_motion_is_left_out_and_the_motion_ends_as_before():
    end = STILL.end
    over, after = (swell(end + first, end + first + 1.0, end + first + 2.0, degrees=-60.0) for first in (-1.0, 0.5))
    small = swell(0.5, 1.0, 1.5)
    assert allowed(STILL, [small, over, after]) == [1.0, 0.0, 0.0]
    assert Changes(STILL, [small, over, after]).added(np.array([1.0, 0.0, 0.0])).end == end


def test_after_something_became_less_limits_are_looked_at_there_alone(monkeypatch):
    looked_at = []

    def find(controls, *others, full):
        looked_at.append(controls.shape[-1])
        return find_beyond(controls, *others, full=full)

    monkeypatch.setattr(changes, "find_beyond", find)
    wide, far = swell(1.0, 1.5, 2.0, degrees=-16.0), swell(3.5, 4.0, 4.5)
    assert allowed(STILL, [wide, far]) == [LESS, 1.0]
    assert looked_at[-1] < 1.2 / STEP < looked_at[0], "a second of a swell, and not the whole motion"


def test_what_is_over_before_a_motion_may_move_changes_nothing():
    early, late = swell(0.0, 0.004, 0.008), swell(1.0, 1.5, 2.0)
    alone, both = (Changes(STILL, every).added(np.ones(len(every))) for every in ([late], [early, late]))
    np.testing.assert_array_equal(both.controls, alone.controls)
