import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.motion.transition import (
    cross_over,
    delay_controls,
    join_columns,
    keep_limits,
    knot_at,
    largest_shares,
    lengthen,
    roomy,
    shorten,
)

BOXES = (-1.5, 1.5, 4.0, 59.0, 1500.0, 0.01, 0.18, 0.65)
LIMITS = Limits(*(sealed([value]) for value in BOXES))


def wave(pieces: int, size: float, period: float) -> np.ndarray:
    return size * np.sin(2 * np.pi * np.arange(pieces + 3) * STEP / period)


def share(column: np.ndarray) -> float:
    return grid(len(column) - 3, STEP).largest(column, LIMITS, 0)


@pytest.mark.parametrize("leave", [3, 20, 41])
def test_a_way_goes_on_as_one_motion_and_ends_as_the_other(leave):
    own, after = wave(150, 0.4, 1.6), 0.5 + wave(150, 0.3, 2.0)
    way = cross_over(own, after, (leave, leave + 60), roomy(LIMITS), 0)
    np.testing.assert_array_equal(way[: leave + 3], own[: leave + 3])
    np.testing.assert_array_equal(way[leave + 60 :], after[leave + 60 :])
    assert share(way) <= 1.001


def test_a_way_that_is_too_short_is_none():
    own, after = wave(150, 0.4, 1.6), np.full(153, 1.0)
    assert cross_over(own, after, (20, 22), roomy(LIMITS), 0) is None
    assert cross_over(own, after, (20, 30), roomy(LIMITS), 0) is None
    assert cross_over(own, after, (20, 80), roomy(LIMITS), 0) is not None


def test_a_way_to_where_it_is_already_is_none_at_all():
    own = wave(150, 0.4, 1.6)
    after = own.copy()
    after[100:] = after[99]
    np.testing.assert_array_equal(cross_over(own, after, (40, 41), roomy(LIMITS), 0), after)


def test_a_way_passes_the_keys_of_the_other_motion():
    own, after = np.zeros(153), 0.5 + wave(150, 0.3, 2.0)
    places = np.array([62.4, 80.0])
    way = cross_over(own, after, (10, 100), roomy(LIMITS), 0, passing=places)
    reached, wanted = (Trajectory(sealed(each[:, None]), 0.0).sample(places * STEP)[0] for each in (way, after))
    np.testing.assert_allclose(reached, wanted, atol=1e-9)


def test_a_wish_beyond_the_limits_is_kept_but_for_where_it_exceeds_them():
    wish = wave(300, 0.2, 1.5)
    wish[150:] += 0.03  # a jump
    assert share(wish) > 10
    column = keep_limits(wish, 0, 300, roomy(LIMITS), 0)
    assert share(column) <= 1.001
    np.testing.assert_array_equal(column[:100], wish[:100])
    np.testing.assert_array_equal(column[-100:], wish[-100:])
    assert np.abs(column - wish).max() < 0.03


def test_a_wish_within_the_limits_stays():
    wish = wave(300, 0.2, 1.5)
    assert keep_limits(wish, 0, 300, LIMITS, 0) is wish


def test_excesses_are_those_of_each_hinge():
    both = np.stack([wave(100, 0.2, 1.5), wave(100, 0.4, 1.5)], axis=1)
    limits = Limits(*(sealed([value, value]) for value in BOXES))
    one, other = largest_shares(both, limits)
    assert one == pytest.approx(share(np.ascontiguousarray(both[:, 0])))
    assert other > one


def test_motions_are_moved_in_time_by_whole_knots():
    motion = np.arange(12.0).reshape(6, 2)
    np.testing.assert_array_equal(delay_controls(motion, 2)[:3], motion[[0, 0, 0]])
    np.testing.assert_array_equal(delay_controls(motion, 2)[2:], motion)
    np.testing.assert_array_equal(delay_controls(motion, -2), motion[2:])
    np.testing.assert_array_equal(delay_controls(motion, -50), motion[3:], "three stay at least")
    np.testing.assert_array_equal(lengthen(motion, 9)[6:], motion[[-1, -1, -1]])
    assert lengthen(motion, 4) is motion


def test_rest_at_the_end_is_cut_off():
    motion = np.vstack([np.arange(8.0)[:, None], np.full((50, 1), 9.0)])
    np.testing.assert_array_equal(shorten(motion), motion[:11])
    assert len(shorten(np.ones((40, 2)))) == 4


def test_knots_go_on_beyond_the_end():
    assert [knot_at(time) for time in (-1.0, 0.0, 0.0101, 0.02, 99.0)] == [0, 0, 2, 2, 9900]


def test_a_difference_between_motions_fades_without_swinging_beyond():
    after = wave(150, 0.3, 2.0)
    way = cross_over(after + 0.2, after, (20, 90), roomy(LIMITS), 0)
    away = way - after
    assert np.all(np.diff(away) <= 1e-9)
    assert away.min() >= -1e-9
    assert away[:23] == pytest.approx(0.2)
    assert away[90:] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("pieces", "is_found"), [(2, False), (3, True)])
def test_a_small_difference_is_passed_over_in_three_pieces(pieces, is_found):
    after = np.zeros(60)
    assert (cross_over(after + 1e-6, after, (20, 20 + pieces), roomy(LIMITS), 0) is not None) is is_found


def test_no_motion_within_the_limits_is_none():
    wish = np.zeros(103)
    wish[50:] = 1.0
    assert keep_limits(wish, 40, 60, roomy(LIMITS), 0) is None
    assert keep_limits(wish, 0, 100, roomy(LIMITS), 0) is not None


@pytest.mark.parametrize("at", [4, 50, 96])
def test_only_control_points_between_the_two_knots_move_into_the_limits(at):
    wish = wave(100, 0.1, 1.5)
    wish[at] += 0.004
    first, last = max(0, at - 20), min(100, at + 20)
    column = keep_limits(wish, first, last, roomy(LIMITS), 0)
    assert share(column) <= 1.001
    np.testing.assert_array_equal(column[: first + 3], wish[: first + 3])
    np.testing.assert_array_equal(column[last:], wish[last:])


def test_what_exceeds_the_limits_outside_the_two_knots_is_left():
    wish = wave(100, 0.1, 1.5)
    wish[10] += 0.004
    assert keep_limits(wish, 30, 90, roomy(LIMITS), 0) is wish


@pytest.mark.parametrize("place", [0, -1])
def test_an_excess_at_an_end_counts(place):
    column = np.zeros((60, 1))
    column[place] = 0.01
    (found,) = largest_shares(column, LIMITS)
    assert found == pytest.approx(share(np.ascontiguousarray(column[:, 0])))
    assert found > 1.0


def test_joined_columns_need_every_joint():
    one, other = np.arange(5.0), np.ones(5)
    np.testing.assert_array_equal(join_columns([one, other]), np.stack([one, other], axis=1))
    assert join_columns([one, None, other]) is None
    assert join_columns([]) is None


def test_widened_limits_stay_within_what_the_certificate_allows():
    wide = roomy(LIMITS)
    for name in ("speed", "acceleration", "jerk", "duty"):
        assert 1.0 < getattr(wide, name)[0] / getattr(LIMITS, name)[0] <= 1.001
    assert (wide.lower, wide.upper) == (LIMITS.lower, LIMITS.upper)
