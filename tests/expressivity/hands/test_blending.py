"""Tests of the interpolation between two hand poses."""

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.hands.blending import angle_between, interpolate_hands
from kinesic.expressivity.keyframes import Hand

fractions = st.floats(0.01, 0.99)
angles = st.floats(0.1, 3.0)
REST_REACH = Reach(sealed([0.0, -0.2, 0.7]), pointing=sealed([0.0, 0.0, -1.0]), palm=sealed([0.0, 1.0, 0.0]))


def turned(angle: float) -> np.ndarray:
    return sealed([cos(angle), sin(angle), 0.0])


def hand(angle: float, x: float, **fields) -> Hand:
    return Hand(Reach(sealed([x, 0.1, 0.9]), pointing=turned(angle), palm=turned(angle + pi / 2)), **fields)


@given(angle=angles, fraction=fractions)
def test_hand_position_directions_openness_effort_and_lift_are_interpolated(angle, fraction):
    a, b = hand(0.0, 0.1, openness=0.2, effort=1.0, lift=0.3), hand(angle, 0.5, openness=1.0, effort=0.0, lift=0.1)
    mixed = interpolate_hands(a, b, fraction, REST_REACH)
    np.testing.assert_allclose(mixed.reach.position, [0.1 + 0.4 * fraction, 0.1, 0.9])
    np.testing.assert_allclose(mixed.reach.pointing, turned(fraction * angle), atol=1e-9)
    np.testing.assert_allclose(mixed.reach.palm, turned(fraction * angle + pi / 2), atol=1e-9)
    assert (mixed.openness, mixed.effort, mixed.lift) == pytest.approx(
        (0.2 + 0.8 * fraction, 1.0 - fraction, 0.3 - 0.2 * fraction)
    )


def test_interpolation_starts_and_ends_at_the_given_hand_poses():
    a, b = hand(0.0, 0.1), hand(1.0, 0.5)
    assert [interpolate_hands(a, b, fraction, REST_REACH) for fraction in (-0.1, 0.0, 1.0, 1.1)] == [a, a, b, b]


def test_interpolation_from_rest_starts_at_the_hanging_hand():
    way = interpolate_hands(Hand(), hand(0.0, 0.4), 0.25, REST_REACH)
    np.testing.assert_allclose(way.reach.position, [0.1, -0.125, 0.75])
    assert interpolate_hands(hand(0.0, 0.4), Hand(), 0.75, REST_REACH).reach.position == pytest.approx(
        way.reach.position
    )


@pytest.mark.parametrize("fraction", [0.0, 0.5, 1.0])
def test_interpolation_between_two_resting_hands_is_a_resting_hand(fraction):
    hands = interpolate_hands(Hand(openness=0.5), Hand(lift=0.5), fraction, REST_REACH)
    assert (hands.reach, hands.openness, hands.lift) == (None, 0.0, 0.0)


def test_hand_shape_and_pointing_target_change_halfway_between_keys():
    a, b = hand(0.0, 0.1, shape="fist", aim=sealed([1.0, 0.0, 0.0])), hand(0.0, 0.5, shape="flat")
    early, middle, late = (interpolate_hands(a, b, fraction, REST_REACH) for fraction in (0.49, 0.5, 0.51))
    assert (early.shape, middle.shape, late.shape) == ("fist", "flat", "flat")
    assert early.aim is a.aim
    assert late.aim is None


def test_interpolated_hand_keeps_only_contacts_common_to_both_poses():
    a = hand(0.0, 0.1, touch="lap", tip="index")
    both, other = (
        interpolate_hands(a, a, 0.4, REST_REACH),
        interpolate_hands(a, replace(a, touch="head", tip="thumb"), 0.4, REST_REACH),
    )
    assert (both.touch, both.tip) == ("lap", "index")
    assert (other.touch, other.tip) == (None, None)


@pytest.mark.parametrize("fraction", [0.3, 0.7])
def test_interpolation_takes_opposite_or_missing_directions_from_the_nearer_pose(fraction):
    a, opposite = hand(0.0, 0.1), hand(pi, 0.5)
    nearer = a if fraction < 0.5 else opposite
    assert interpolate_hands(a, opposite, fraction, REST_REACH).reach.pointing is nearer.reach.pointing
    open_ = Hand(Reach(sealed([0.5, 0.1, 0.9])))
    reach = interpolate_hands(a, open_, fraction, REST_REACH).reach
    assert reach.pointing is (a.reach.pointing if fraction < 0.5 else None)
    assert interpolate_hands(a, hand(0.0, 0.5), fraction, REST_REACH).reach.pointing == pytest.approx(turned(0.0))


@given(angle=st.floats(0.0, pi))
def test_angle_between_directions_is_symmetric_and_zero_for_a_missing_direction(angle):
    assert angle_between(turned(0.0), turned(angle)) == pytest.approx(angle, abs=1e-7)
    assert angle_between(turned(angle), turned(0.0)) == pytest.approx(angle, abs=1e-7)
    assert angle_between(None, turned(angle)) == angle_between(turned(angle), None) == 0.0
    assert angle_between(2.0 * turned(0.0), turned(0.0)) == 0.0  # Rounded above 1
