from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.infeasibility import (
    DEFICIT_MARGIN,
    EASY_DEFICIT,
    MIN_PLANE_SLOPE,
    Infeasibility,
    estimate_limit_ratio,
    make_cutting_planes,
    measure_time_deficit,
)
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import nearest_motion
from kinesic.motion.trajectory import KNOT_INTERVAL

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def way(pieces: int, place: float) -> SplineSegment:
    """Return a segment of keys at 0, 0.8 and 1.6 rad."""
    return SplineSegment(0, 0, grid(pieces, KNOT_INTERVAL), 0.0, 1.6, np.array([place]), np.array([0.8]))


def passes(found: SplineSegment) -> bool:
    places = np.array([0.0, *found.places, found.grid.pieces])
    wish = np.interp(np.arange(found.grid.pieces + 1), places, [found.start, *found.angles, found.end])
    return nearest_motion(found, wish, JOINT_LIMITS) is not None


@pytest.mark.parametrize("pieces", [30, 40, 44, 48, 52, 56, 60, 80])
def test_segment_is_feasible_exactly_if_its_time_deficit_is_not_positive(pieces):
    assert (measure_time_deficit(way(pieces, pieces / 2), JOINT_LIMITS).amount <= 0) == passes(way(pieces, pieces / 2))


@pytest.mark.parametrize("before", [0.9, 0.3, 0.1, 0.03, 0.021])
def test_time_deficit_is_continuous_for_a_key_just_before_the_last_knot(before):
    places, angles = np.array([20.0, 40.0 - before]), np.array([0.8, 1.6])
    late = SplineSegment(0, 0, grid(40, KNOT_INTERVAL), 0.0, 1.6, places, angles)
    infeasibility = measure_time_deficit(late, JOINT_LIMITS)
    assert infeasibility is not None
    assert infeasibility.amount == pytest.approx(measure_time_deficit(way(39, 20.0), JOINT_LIMITS).amount, abs=1e-4)
    assert np.isfinite(infeasibility.slopes).all()


def test_time_deficit_approximates_the_log_of_the_required_time_ratio():
    infeasibility = measure_time_deficit(way(40, 20.0), JOINT_LIMITS)
    longer = 40 * float(np.exp(infeasibility.amount))
    assert measure_time_deficit(way(round(1.1 * longer), 0.55 * longer), JOINT_LIMITS).amount < 0.0
    assert measure_time_deficit(way(round(0.9 * longer), 0.45 * longer), JOINT_LIMITS).amount > 0.0


def test_slopes_of_a_time_deficit_equal_its_finite_differences():
    infeasibility, more = measure_time_deficit(way(40, 17.3), JOINT_LIMITS), 0.1
    later = measure_time_deficit(way(40, 17.3 + more), JOINT_LIMITS)
    assert infeasibility.slopes[1] == pytest.approx(
        (later.amount - infeasibility.amount) / (more * KNOT_INTERVAL), rel=0.05
    )
    assert infeasibility.slopes[2] == pytest.approx(0.0, abs=1e-6)
    assert infeasibility.slopes.sum() == pytest.approx(0.0, abs=1e-9)


def test_time_deficit_depends_on_a_segment_end_between_two_knots():
    """Test a hinge that rests from the knot before its last key."""
    off = SplineSegment(0, 0, grid(41, KNOT_INTERVAL), 0.0, 1.6, np.array([25.3, 40.4]), np.array([0.8, 1.6]))
    infeasibility = measure_time_deficit(off, JOINT_LIMITS)
    assert infeasibility.slopes[3] < -1.0
    assert infeasibility.slopes[1] == pytest.approx(-infeasibility.slopes[3], rel=1e-6)


def test_spare_time_of_a_segment_is_computed_only_up_to_a_bound():
    assert measure_time_deficit(way(300, 150.0), JOINT_LIMITS).amount == pytest.approx(np.log1p(2 * EASY_DEFICIT) / 2)


@pytest.mark.parametrize("target", [-0.05, -0.0005, 0.05])
def test_early_end_of_the_deficit_search_does_not_change_the_feasibility_result(target):
    ended = 0
    for pieces in range(30, 90, 3):
        infeasibility = measure_time_deficit(way(pieces, pieces / 2), JOINT_LIMITS)
        sooner = measure_time_deficit(way(pieces, pieces / 2), JOINT_LIMITS, target=target)
        assert (sooner.amount <= target) == (infeasibility.amount <= target)
        if sooner.amount > target:
            assert sooner.amount == infeasibility.amount
            np.testing.assert_array_equal(sooner.slopes, infeasibility.slopes)
        ended += sooner.amount > infeasibility.amount
    assert ended > 0


def test_segment_with_an_estimated_limit_ratio_of_at_most_one_is_feasible():
    for pieces in (40, 60, 80, 120, 300):
        if estimate_limit_ratio(way(pieces, pieces / 2), JOINT_LIMITS) <= 1.0:
            assert measure_time_deficit(way(pieces, pieces / 2), JOINT_LIMITS).amount <= 1e-6
    assert estimate_limit_ratio(way(300, 150.0), JOINT_LIMITS) < 1.0 < estimate_limit_ratio(way(40, 20.0), JOINT_LIMITS)


@pytest.mark.parametrize(
    ("quantity", "change"),
    [
        ("speed", {"speed": 0.5}),
        ("acceleration", {"acceleration": 4.0}),
        ("jerk", {"jerk": 10.0}),
        ("duty", {"duty": 0.05}),
    ],
)
def test_binding_motion_limit_of_a_key_interval_is_reported(quantity, change):
    tight = replace(JOINT_LIMITS, **{name: sealed([value]) for name, value in change.items()})
    assert measure_time_deficit(way(40, 20.0), tight).binding[0] == quantity


def test_key_interval_with_spare_time_has_no_binding_limit():
    assert measure_time_deficit(way(200, 20.0), JOINT_LIMITS).binding == ("speed", None)


def test_time_deficit_of_a_segment_above_the_work_limit_is_not_measured():
    assert measure_time_deficit(way(40, 20.0), JOINT_LIMITS, max_work=39) is None
    allowed, free = (
        measure_time_deficit(way(40, 20.0), JOINT_LIMITS, max_work=40),
        measure_time_deficit(way(40, 20.0), JOINT_LIMITS),
    )
    assert allowed is not None
    assert allowed.amount == free.amount


MARKED_SEGMENT = replace(way(40, 20.0), marks=((0,), (1, 2), (3,)))  # segment whose second key is at two key times
KEY_TIMES = np.array([0.0, 1.0, 1.2, 2.0])  # [s] key times of the whole motion


def deficit_of(amount: float, slopes: list[float], binding=("speed", None)) -> Infeasibility:
    return Infeasibility(amount, np.array(slopes), binding, np.zeros(3))


@pytest.mark.parametrize(("amount", "counted"), [(0.3, 0.3), (-0.2, 0.0)])
@pytest.mark.parametrize("slopes", [[-2.0, 2.0, 0.0], [0.0, 0.0, 0.11], [-0.11, 0.0, 0.0]])
def test_cutting_plane_excludes_the_current_key_times_by_the_deficit_and_a_margin(slopes, amount, counted):
    (plane,) = make_cutting_planes(MARKED_SEGMENT, deficit_of(amount, slopes), KEY_TIMES)
    np.testing.assert_allclose(plane.slopes, [slopes[0], slopes[1] / 2, slopes[1] / 2, slopes[2]])
    assert plane.slopes @ KEY_TIMES - plane.bound == pytest.approx(counted + DEFICIT_MARGIN)


def test_deficit_without_slope_gives_a_cutting_plane_for_each_limited_key_interval():
    flat = [-MIN_PLANE_SLOPE, 0.0, MIN_PLANE_SLOPE]
    first, second = make_cutting_planes(MARKED_SEGMENT, deficit_of(0.3, flat, ("speed", "acceleration")), KEY_TIMES)
    np.testing.assert_allclose(first.slopes, [1.0, -0.5, -0.5, 0.0])
    np.testing.assert_allclose(second.slopes, [0.0, 0.5, 0.5, -1.0])
    assert (first.bound, second.bound) == pytest.approx(
        (-1.1 * np.exp(0.3 + DEFICIT_MARGIN), -0.9 * np.exp(0.3 + DEFICIT_MARGIN))
    )
    (only,) = make_cutting_planes(MARKED_SEGMENT, deficit_of(0.3, flat, (None, "jerk")), KEY_TIMES)
    np.testing.assert_array_equal(only.slopes, second.slopes)
