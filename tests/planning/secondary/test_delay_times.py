"""Tests of joint delays over time in gaps between strokes."""

from math import inf

import numpy as np
import pytest

from kinesic.planning.secondary.arm_times import ArmStroke, Gap
from kinesic.planning.secondary.succession import (
    MAX_CATCH_UP,
    MAX_DELAY_RATE,
    _delay_hand,
    _delay_on_approach,
    _delay_on_return,
)

HAND_DELAY = 0.07  # [s] delay of the following hand: built up in 0.2 s of rest, or reduced in 0.47 s of motion
DELAYED_STROKE = ArmStroke("g", 1.5, 2.0, behind=HAND_DELAY)  # stroke from 1.5 to 2 s
RESTING_BEFORE = Gap(0.0, 1.5, ((0.0, 1.0),))  # gap before the stroke, with a rest of 1 s
RESTING_AFTER = Gap(2.0, inf, ((3.0, 3.1), (4.0, inf)))  # gap after the stroke, with a short and an infinite rest
MOVING_BEFORE = Gap(0.0, 1.5, ())  # gap before the stroke, without a rest
MOVING_AFTER = Gap(2.0, 3.0, ())  # gap after the stroke, without a rest
SHORT_BEFORE = Gap(1.1, 1.5, ())  # gap of 0.4 s before the stroke
SHORT_AFTER = Gap(2.0, 2.4, ())  # gap of 0.4 s after the stroke


@pytest.mark.parametrize(
    ("before", "after", "times"),
    [
        (RESTING_BEFORE, RESTING_AFTER, [0.8, 1.0, 4.0, 4.2]),
        (RESTING_BEFORE, MOVING_AFTER, [0.8, 1.0, 2.0, 3.0]),
        (MOVING_BEFORE, RESTING_AFTER, [0.0, 1.5, 4.0, 4.2]),
        (MOVING_BEFORE, MOVING_AFTER, [0.0, 1.5, 2.0, 3.0]),
        (Gap(0.0, 1.5, ((0.0, 0.1),)), MOVING_AFTER, [0.0, 1.5, 2.0, 3.0]),
        (MOVING_BEFORE, Gap(2.0, 3.0, ((2.8, 2.9),)), [0.0, 1.5, 2.0, 3.0]),
    ],
)
def test_delay_of_the_following_hand_builds_up_in_a_long_rest_or_else_in_the_whole_gap(
    before: Gap, after: Gap, times: list[float]
):
    lateness = _delay_hand(DELAYED_STROKE, before, after)
    assert [time for time, _ in lateness] == pytest.approx(times)
    assert [delay for _, delay in lateness] == [0.0, HAND_DELAY, HAND_DELAY, 0.0]


@pytest.mark.parametrize(
    ("before", "after"),
    [(SHORT_BEFORE, RESTING_AFTER), (RESTING_BEFORE, SHORT_AFTER), (SHORT_BEFORE, SHORT_AFTER)],
)
def test_following_hand_without_time_to_catch_up_is_not_delayed(before: Gap, after: Gap):
    assert _delay_hand(DELAYED_STROKE, before, after) == ()


@pytest.mark.parametrize(
    ("delay", "gap", "start", "applied"),
    [
        (0.1, Gap(0.0, 2.0, ((0.2, 1.0),)), 0.9, 0.1),
        (-0.1, Gap(0.0, 2.0, ((0.2, 1.0),)), 0.0, -0.1),
        (-0.1, Gap(0.0, 2.0, ((0.2, 1.0),)), 0.9, -0.1 * MAX_DELAY_RATE),  # 0.1 s since the motion began
        (1.0, Gap(0.0, 2.0, ((0.2, 1.0),)), 0.0, MAX_CATCH_UP),  # 1 s to catch up
        (1.0, Gap(0.0, 9.0, ((0.0, 0.1), (0.2, 1.0))), 0.0, 0.8 * MAX_DELAY_RATE),  # 0.8 s of rest
    ],
)
def test_joint_delay_during_the_approach_to_a_stroke_is_zero_at_the_stroke(
    delay: float, gap: Gap, start: float, applied: float
):
    begin, leave, end = _delay_on_approach(delay, gap, start)
    assert leave == (1.0, pytest.approx(applied))
    assert begin == (pytest.approx(max(0.2, 1.0 - abs(applied) / MAX_DELAY_RATE)), 0.0)
    assert end == (gap.end, 0.0)


def test_joints_are_delayed_on_approach_only_after_a_rest_of_the_arm():
    assert _delay_on_approach(0.1, MOVING_BEFORE, 0.0) == ()
    assert _delay_on_approach(0.1, Gap(0.0, 2.0, ((1.0, 1.0),)), 0.0) == ()
    assert _delay_on_approach(0.0, RESTING_BEFORE, 0.0) == ()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("delay", "gap", "times", "applied"),
    [
        (0.1, Gap(1.0, inf, ((2.0, 2.5), (4.0, 6.0))), [2.0, 2.5, 4.0], 0.1),
        (0.3, Gap(1.0, inf, ((2.0, 2.5), (4.0, 6.0))), [2.0, 2.5, 4.0], 0.5 * MAX_DELAY_RATE),
        (0.3, Gap(1.0, inf, ((2.0, 4.0), (5.0, 5.2))), [2.0, 4.0, 5.0], 0.2 * MAX_DELAY_RATE),
        (0.1, Gap(1.0, inf, ((4.0, inf),)), [1.0, 4.0, 4.0], 0.1),
    ],
)
def test_joint_delay_during_the_return_of_an_arm_builds_up_before_it_and_ends_in_the_last_rest(
    sign: float, delay: float, gap: Gap, times: list[float], applied: float
):
    lateness = _delay_on_return(sign * delay, gap)
    end = times[-1] + applied / MAX_DELAY_RATE
    np.testing.assert_allclose([time for time, _ in lateness], [*times, min(end, gap.rests[-1][1])])
    np.testing.assert_allclose([value for _, value in lateness], [0.0, sign * applied, sign * applied, 0.0])


def test_arm_that_does_not_return_to_rest_is_not_delayed_afterwards():
    assert _delay_on_return(0.1, MOVING_AFTER) == ()
    assert _delay_on_return(0.1, Gap(2.0, 4.0, ((2.5, 3.0),))) == ()
    assert _delay_on_return(0.0, RESTING_AFTER) == ()
