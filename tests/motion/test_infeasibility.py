from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.infeasibility import EASY, guess_share, measure_shortage
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import KERNEL, nearest_motion
from kinesic.motion.trajectory import STEP

LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def way(pieces: int, place: float) -> SplineSegment:
    """From 0 over 0.8 to 1.6 rad."""
    return SplineSegment(0, 0, grid(pieces, STEP), 0.0, 1.6, np.array([place]), np.array([0.8]))


def passes(found: SplineSegment) -> bool:
    places = np.array([0.0, *found.places, found.grid.pieces])
    wish = np.interp(np.arange(found.grid.pieces + 1), places, [found.start, *found.angles, found.end])
    return nearest_motion(found, wish, LIMITS) is not None


@pytest.mark.parametrize("pieces", [30, 40, 44, 48, 52, 56, 60, 80])
def test_what_lacks_nothing_can_be_passed(pieces):
    assert (measure_shortage(way(pieces, pieces / 2), LIMITS).amount <= 0) == passes(way(pieces, pieces / 2))


@pytest.mark.parametrize("before", [0.9, 0.3, 0.1, 0.03, 0.021])
def test_a_last_key_just_before_the_last_knot_is_solved_as_any_other(before):
    places, angles = np.array([20.0, 40.0 - before]), np.array([0.8, 1.6])
    late = SplineSegment(0, 0, grid(40, STEP), 0.0, 1.6, places, angles)
    found = measure_shortage(late, LIMITS)
    assert found is not None
    assert found.amount == pytest.approx(measure_shortage(way(39, 20.0), LIMITS).amount, abs=1e-4)
    assert np.isfinite(found.slopes).all()


def test_the_amount_is_about_the_share_of_the_time():
    found = measure_shortage(way(40, 20.0), LIMITS)
    longer = 40 * float(np.exp(found.amount))
    assert measure_shortage(way(round(1.1 * longer), 0.55 * longer), LIMITS).amount < 0.0
    assert measure_shortage(way(round(0.9 * longer), 0.45 * longer), LIMITS).amount > 0.0


def test_slopes_are_those_of_the_amount():
    found, more = measure_shortage(way(40, 17.3), LIMITS), 0.1
    later = measure_shortage(way(40, 17.3 + more), LIMITS)
    assert found.slopes[1] == pytest.approx((later.amount - found.amount) / (more * STEP), rel=0.05)
    assert found.slopes[2] == pytest.approx(0.0, abs=1e-6)
    assert found.slopes.sum() == pytest.approx(0.0, abs=1e-9)


def test_an_end_between_two_knots_counts():
    """The last key holds the hinge from the knot before it, so that the rest begins there."""
    off = SplineSegment(0, 0, grid(41, STEP), 0.0, 1.6, np.array([25.3, 40.4]), np.array([0.8, 1.6]))
    found = measure_shortage(off, LIMITS)
    assert found.slopes[3] < -1.0
    assert found.slopes[1] == pytest.approx(-found.slopes[3], rel=1e-6)


def test_time_to_spare_is_not_counted_beyond_need():
    assert measure_shortage(way(300, 150.0), LIMITS).amount == pytest.approx(np.log1p(2 * EASY) / 2)


@pytest.mark.parametrize("target", [-0.05, -0.0005, 0.05])
def test_a_search_that_ends_with_enough_tells_as_much_as_one_that_goes_on(target):
    ended = 0
    for pieces in range(30, 90, 3):
        found = measure_shortage(way(pieces, pieces / 2), LIMITS)
        sooner = measure_shortage(way(pieces, pieces / 2), LIMITS, target=target)
        assert (sooner.amount <= target) == (found.amount <= target)
        if sooner.amount > target:
            assert sooner.amount == found.amount
            np.testing.assert_array_equal(sooner.slopes, found.slopes)
        ended += sooner.amount > found.amount
    assert ended > 0 or KERNEL == "numpy"


def test_the_smoothest_way_takes_no_less_than_it_must():
    for pieces in (40, 60, 80, 120, 300):
        if guess_share(way(pieces, pieces / 2), LIMITS) <= 1.0:
            assert measure_shortage(way(pieces, pieces / 2), LIMITS).amount <= 1e-6
    assert guess_share(way(300, 150.0), LIMITS) < 1.0 < guess_share(way(40, 20.0), LIMITS)


@pytest.mark.parametrize(
    ("quantity", "change"),
    [
        ("speed", {"speed": 0.5}),
        ("acceleration", {"acceleration": 4.0}),
        ("jerk", {"jerk": 10.0}),
        ("duty", {"duty": 0.05}),
    ],
)
def test_the_limit_is_named(quantity, change):
    tight = replace(LIMITS, **{name: sealed([value]) for name, value in change.items()})
    assert measure_shortage(way(40, 20.0), tight).binding[0] == quantity


def test_a_gap_with_time_to_spare_has_no_limit():
    assert measure_shortage(way(200, 20.0), LIMITS).binding == ("speed", None)


def test_a_program_with_more_pieces_than_allowed_is_not_solved():
    assert measure_shortage(way(40, 20.0), LIMITS, max_work=39) is None
    allowed, free = measure_shortage(way(40, 20.0), LIMITS, max_work=40), measure_shortage(way(40, 20.0), LIMITS)
    assert allowed is not None
    assert allowed.amount == free.amount
