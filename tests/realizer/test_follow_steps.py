"""Durations of the steps of head and trunk, compared with closed forms and dense sampling."""

import numpy as np
import pytest

from kinesic.realizer.follow_steps import FollowStep, fit_step

LIMITS = {"neck": (90.0, 400.0), "torso": (25.0, 100.0)}  # [deg/s] and [deg/s^2]
GROWTH = 1.2  # duration of an attempt / that of the previous one


def lone_duration(chain: str, angle: float) -> float:
    """Return the duration [s] of a minimum-jerk step by `angle` [deg] with both peaks within the limits."""
    velocity, acceleration = LIMITS[chain]
    shortest = {"neck": 0.2, "torso": 0.4}[chain]
    return max(shortest, 15 / 8 * angle / velocity, np.sqrt(10 / np.sqrt(3) * angle / acceleration))


def turn(angle: float, axis: int = 0) -> np.ndarray:
    change = np.zeros(3)
    change[axis] = np.radians(angle)
    return change


def peaks(steps, chain):
    """Return the largest velocity and acceleration of a sum of steps, relative to the limits."""
    times = np.linspace(min(step.begin for step in steps), max(step.end for step in steps), 3001)
    rates = [step.rates(times) for step in steps]
    values = [np.degrees(np.abs(np.sum([rate[k] for rate in rates], axis=0)).max()) for k in (0, 1)]
    return [value / limit for value, limit in zip(values, LIMITS[chain], strict=True)]


@pytest.mark.parametrize(
    ("chain", "angle"), [("neck", 0.5), ("neck", 6.0), ("neck", 60.0), ("torso", 0.5), ("torso", 3.0), ("torso", 12.0)]
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_lone_follow_step_takes_the_least_time_within_velocity_and_acceleration_limits(chain, angle, sign):
    step = fit_step(chain, turn(sign * angle, axis=1), 5.0, [])
    assert step.begin == pytest.approx(5.0 + {"neck": 0.0, "torso": 0.12}[chain])
    assert step.end - step.begin == pytest.approx(lone_duration(chain, angle), rel=1e-12)
    assert max(peaks([step], chain)) <= 1.0 + 1e-4
    assert step.progress(np.array([step.begin, step.end])).tolist() == [0.0, 1.0]


def test_follow_step_that_would_last_longer_than_three_seconds_is_refused():
    fastest = 3.0 * 25.0 * 8 / 15  # [deg] whose lone step lasts 3 s
    assert fit_step("torso", turn(fastest - 0.1), 0.0, []).end == pytest.approx(3.12, abs=0.02)
    assert fit_step("torso", turn(fastest + 0.1), 0.0, []) is None


def test_new_follow_step_grows_only_until_its_sum_with_running_steps_keeps_limits():
    running = FollowStep("neck", turn(40.0), 0.0, 1.5 * lone_duration("neck", 40.0))
    step = fit_step("neck", turn(30.0), 0.3, [running])
    attempts = np.log((step.end - step.begin) / lone_duration("neck", 30.0)) / np.log(GROWTH)
    assert attempts == pytest.approx(round(attempts), abs=1e-9)
    assert round(attempts) >= 1
    assert max(peaks([running, step], "neck")) <= 1.02
    faster = FollowStep("neck", step.change, step.begin, step.begin + (step.end - step.begin) / GROWTH)
    assert max(peaks([running, faster], "neck")) > 1.0


def test_only_running_follow_steps_of_the_same_chain_that_have_not_ended_delay_a_new_step():
    change, expected = turn(30.0), lone_duration("neck", 30.0)
    ended, ending = (FollowStep("neck", turn(30.0), 0.0, end) for end in (0.3, 1.5))
    opposite = FollowStep("neck", -change, 0.3, 0.3 + expected)
    for others in ([FollowStep("torso", turn(30.0), 0.0, 1.0)], [ended], [opposite]):
        assert fit_step("neck", change, 0.3, others).end == pytest.approx(0.3 + expected)
    assert fit_step("neck", change, 0.3, [ending]).end > 0.3 + expected


@pytest.mark.parametrize(
    ("running", "angle", "exceeded"),
    [
        (FollowStep("neck", turn(40.0), -0.4, 1.6), 60.0, 0),
        (FollowStep("neck", turn(6.0), 0.0, 0.38), 12.0, 1),
    ],
)
def test_follow_step_is_longer_if_only_velocity_or_only_acceleration_would_exceed_its_limit(running, angle, exceeded):
    lone = FollowStep("neck", turn(angle), 0.0, lone_duration("neck", angle))
    together = peaks([running, lone], "neck")
    assert together[exceeded] > 1.0 > together[1 - exceeded]
    step = fit_step("neck", turn(angle), 0.0, [running])
    assert step.end > lone.end
    assert max(peaks([running, step], "neck")) <= 1.02
