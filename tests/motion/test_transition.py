import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.motion.transition import (
    cross_over,
    delay_controls,
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
    np.testing.assert_array_equal(lengthen(motion, 9)[6:], motion[[-1, -1, -1]])
    assert lengthen(motion, 4) is motion


def test_rest_at_the_end_is_cut_off():
    motion = np.vstack([np.arange(8.0)[:, None], np.full((50, 1), 9.0)])
    np.testing.assert_array_equal(shorten(motion), motion[:11])
    assert len(shorten(np.ones((40, 2)))) == 4


def test_knots_go_on_beyond_the_end():
    assert [knot_at(time) for time in (-1.0, 0.0, 0.0101, 0.02, 99.0)] == [0, 0, 2, 2, 9900]
