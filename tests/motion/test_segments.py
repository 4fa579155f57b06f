import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.double_s import rest_to_rest
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import pieces, segments, tight_segments
from kinesic.motion.trajectory import STEP

LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
ROWS = ((0.0, 0.0, 1.0), (0.5, 0.7, 1.0), (1.3, 0.7, 1.0), (1.805, 0.2, 0.4), (2.2, 0.0, 1.0))
KEYS = Keys.of(tuple(KeyPosture(time, sealed(angles), (True, True)) for time, *angles in ROWS), LIMITS)


def cut(hinge: int):
    return [found for found in segments(KEYS.asked, KEYS, STEP) if found.hinge == hinge]


def test_a_hold_is_cut_in_its_middle():
    first, second = cut(0)
    assert (first.first, second.first) == (0, 90)
    assert (first.start, first.end, second.start, second.end) == (0.0, 0.7, 0.7, 0.0)
    assert first.pairs == ((0, 1), (1, 2))
    assert second.pairs == ((1, 2), (2, 3), (3, 4))
    assert second.places == pytest.approx([40.0, 90.5])


def test_segments_cover_the_motion():
    for hinge in (0, 1):
        found = cut(hinge)
        assert [s.knots.stop - 1 for s in found] == [*(s.first for s in found[1:]), pieces(KEYS.asked, STEP)]


def tight(times, hinges=(0, 1)) -> list:
    ways = rest_to_rest(KEYS, LIMITS)
    rests = [np.array([rest for (hinge, _), rest in ways.items() if hinge == own]) for own in (0, 1)]
    return [*tight_segments(np.asarray(times), KEYS, STEP, rests, hinges)]


def test_segments_in_which_a_hinge_could_rest_at_each_key_are_left_out():
    assert tight(KEYS.asked * 3.0) == []
    hurried = tight(KEYS.asked * 0.6)
    assert {found.hinge for found in hurried} == {0, 1}
    assert {found.hinge for found in tight(KEYS.asked * 0.6, [1])} == {1}


def test_a_way_with_far_more_time_than_it_needs_is_cut_in_its_middle():
    times = KEYS.asked + np.array([0.0, 0.0, 0.0, 3.0, 2.8])  # a long way from 0.7 to 0.2, and a hurried one to 0
    (last,) = [found for found in tight(times) if found.hinge == 0]
    assert last.start == pytest.approx(0.45)
    assert (last.end, last.first) == (0.0, 305)
    assert last.pairs == ((2, 3), (3, 4))
    (whole,) = [found for found in segments(times, KEYS, STEP) if found.hinge == 0 and found.first == 90]
    assert last.within(whole)
    assert not whole.within(last)


def test_a_hinge_at_rest_is_still():
    assert [found.still for found in cut(1)] == [True, True, False]


def test_control_points_pass_keys_and_rest_at_the_ends():
    way = cut(0)[1]
    matrix, values = way.fixed.matrix, way.fixed.values
    assert matrix.shape == (8, way.grid.size)
    np.testing.assert_allclose(matrix.sum(axis=1), 1.0)
    np.testing.assert_allclose(values, [0.7, 0.2, 0.7, 0.7, 0.7, 0.0, 0.0, 0.0])


def test_a_last_key_between_knots_is_met_before_the_end():
    times = KEYS.asked + np.array([0, 0, 0, 0, 0.004])
    last = [found for found in segments(times, KEYS, STEP) if found.hinge == 0][-1]
    assert last.places[-1] == pytest.approx(130.4)
    assert last.pairs[-1] == (4, 4)


def test_a_path_between_two_keys_of_one_angle_is_no_hold():
    rows = ((0.0, 0.0, True), (0.5, 0.7, True), (0.9, 0.9, False), (1.3, 0.7, True), (2.0, 0.0, True))
    keys = Keys.of(tuple(KeyPosture(t, sealed([a] * 2), (True, True), firm=firm) for t, a, firm in rows), LIMITS)
    assert keys.own == ([0, 1, 3, 4], [0, 1, 3, 4])
    assert keys.led(0).tolist() == [False, True, False]
    assert [(found.hinge, found.first, found.led) for found in segments(keys.asked, keys, STEP)] == [
        (0, 0, True),
        (1, 0, True),
    ]


def test_a_long_hold_stands_still_in_between():
    rows = ((0.0, 0.0), (0.5, 0.7), (300.0, 0.7), (300.5, 0.0))
    keys = Keys.of(tuple(KeyPosture(t, sealed([a] * 2), (True, True)) for t, a in rows), LIMITS)
    before, still, after = [found for found in segments(keys.asked, keys, STEP) if found.hinge == 0]
    assert (before.still, still.still, after.still) == (False, True, False)
    assert before.grid.pieces < 200
    assert after.grid.pieces < 200
    assert still.pairs == ((1, 2),)
