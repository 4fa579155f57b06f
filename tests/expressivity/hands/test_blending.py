"""Hands between two poses."""

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.hands.blending import angle_between, between
from kinesic.expressivity.keyframes import Hand

fractions = st.floats(0.01, 0.99)
angles = st.floats(0.1, 3.0)
REST = Reach(sealed([0.0, -0.2, 0.7]), pointing=sealed([0.0, 0.0, -1.0]), palm=sealed([0.0, 1.0, 0.0]))


def turned(angle: float) -> np.ndarray:
    return sealed([cos(angle), sin(angle), 0.0])


def hand(angle: float, x: float, **fields) -> Hand:
    return Hand(Reach(sealed([x, 0.1, 0.9]), pointing=turned(angle), palm=turned(angle + pi / 2)), **fields)


@given(angle=angles, fraction=fractions)
def test_a_hand_between_two_is_so_far_along_in_everything(angle, fraction):
    a, b = hand(0.0, 0.1, openness=0.2, effort=1.0, lift=0.3), hand(angle, 0.5, openness=1.0, effort=0.0, lift=0.1)
    mixed = between(a, b, fraction, REST)
    np.testing.assert_allclose(mixed.reach.position, [0.1 + 0.4 * fraction, 0.1, 0.9])
    np.testing.assert_allclose(mixed.reach.pointing, turned(fraction * angle), atol=1e-9)
    np.testing.assert_allclose(mixed.reach.palm, turned(fraction * angle + pi / 2), atol=1e-9)
    assert (mixed.openness, mixed.effort, mixed.lift) == pytest.approx(
        (0.2 + 0.8 * fraction, 1.0 - fraction, 0.3 - 0.2 * fraction)
    )


def test_the_ends_are_the_hands_themselves():
    a, b = hand(0.0, 0.1), hand(1.0, 0.5)
    assert [between(a, b, fraction, REST) for fraction in (-0.1, 0.0, 1.0, 1.1)] == [a, a, b, b]


def test_a_hand_comes_from_where_it_hangs():
    way = between(Hand(), hand(0.0, 0.4), 0.25, REST)
    np.testing.assert_allclose(way.reach.position, [0.1, -0.125, 0.75])
    assert between(hand(0.0, 0.4), Hand(), 0.75, REST).reach.position == pytest.approx(way.reach.position)


@pytest.mark.parametrize("fraction", [0.0, 0.5, 1.0])
def test_between_two_hands_at_rest_is_rest(fraction):
    found = between(Hand(openness=0.5), Hand(lift=0.5), fraction, REST)
    assert (found.reach, found.openness, found.lift) == (None, 0.0, 0.0)


def test_a_shape_or_an_aim_holds_on_its_half_of_the_way():
    a, b = hand(0.0, 0.1, shape="fist", aim=sealed([1.0, 0.0, 0.0])), hand(0.0, 0.5, shape="flat")
    early, middle, late = (between(a, b, fraction, REST) for fraction in (0.49, 0.5, 0.51))
    assert (early.shape, middle.shape, late.shape) == ("fist", "flat", "flat")
    assert early.aim is a.aim
    assert late.aim is None


def test_a_touch_or_a_tip_holds_only_where_both_have_it():
    a = hand(0.0, 0.1, touch="lap", tip="index")
    both, other = between(a, a, 0.4, REST), between(a, replace(a, touch="head", tip="thumb"), 0.4, REST)
    assert (both.touch, both.tip) == ("lap", "index")
    assert (other.touch, other.tip) == (None, None)


@pytest.mark.parametrize("fraction", [0.3, 0.7])
def test_a_direction_without_a_way_to_the_other_is_that_of_the_nearer_hand(fraction):
    a, opposite = hand(0.0, 0.1), hand(pi, 0.5)
    nearer = a if fraction < 0.5 else opposite
    assert between(a, opposite, fraction, REST).reach.pointing is nearer.reach.pointing
    open_ = Hand(Reach(sealed([0.5, 0.1, 0.9])))
    found = between(a, open_, fraction, REST).reach
    assert found.pointing is (a.reach.pointing if fraction < 0.5 else None)
    assert between(a, hand(0.0, 0.5), fraction, REST).reach.pointing == pytest.approx(turned(0.0))


@given(angle=st.floats(0.0, pi))
def test_the_angle_between_directions_is_the_same_both_ways(angle):
    assert angle_between(turned(0.0), turned(angle)) == pytest.approx(angle, abs=1e-7)
    assert angle_between(turned(angle), turned(0.0)) == pytest.approx(angle, abs=1e-7)
    assert angle_between(None, turned(angle)) == angle_between(turned(angle), None) == 0.0
    assert angle_between(2.0 * turned(0.0), turned(0.0)) == 0.0  # rounded beyond 1
