from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import stopping
from kinesic.motion.condition import condition
from kinesic.motion.double_s import least_stop
from kinesic.motion.keys import KeyPosture
from kinesic.motion.limit_check import check_limits
from kinesic.motion.stopping import _find_shortest, cut_knot, stop
from kinesic.motion.trajectory import KNOT_INTERVAL, stay

# angle, velocity, acceleration and jerk limits of three hinges
BOX_LIMITS = ([-1.5] * 3, [1.5] * 3, [1.0, 4.0, 6.0], [10.0, 59.0, 350.0], [250.0, 1500.0, 8750.0])
# duty per acceleration, duty per velocity and duty limit of three hinges
DUTY_LIMITS = ([0.05, 0.01, 0.002], [0.8, 0.18, 0.134], [0.58, 0.65, 0.79])
JOINT_LIMITS = Limits(*(sealed(values) for values in (*BOX_LIMITS, *DUTY_LIMITS)))  # limits of three hinges


def random_postures(seed: int) -> tuple[KeyPosture, ...]:
    chance = np.random.default_rng(seed)
    times = np.cumsum(chance.uniform(0.1, 0.8, 6))
    return tuple(KeyPosture(float(t), sealed(chance.uniform(-1.2, 1.2, 3)), (True,) * 3) for t in times)


@cache
def moving(seed: int):
    return condition(random_postures(seed), JOINT_LIMITS).trajectory


def largest(trajectory) -> float:
    return max(float(peak.ratios.max()) for peak in check_limits(trajectory, JOINT_LIMITS).by_quantity.values())


@pytest.mark.parametrize("seed", range(4))
def test_stopping_a_motion_keeps_its_past_and_the_limits(seed):
    motion = moving(seed)
    time = np.random.default_rng(100 + seed).uniform(0, motion.duration)
    halted = stop(motion, time, JOINT_LIMITS)
    past = np.linspace(0.0, cut_knot(motion, time) * KNOT_INTERVAL, 50)
    for before, after in zip(motion.sample(past), halted.sample(past), strict=True):
        np.testing.assert_allclose(after, before, atol=1e-9)
    assert largest(halted) <= 1.001
    np.testing.assert_allclose(halted.sample(np.array([halted.duration]))[1], 0.0, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_emergency_stop_takes_the_minimum_time_within_four_knot_intervals(seed):
    motion = moving(seed)
    knot = cut_knot(motion, 0.4 * motion.duration)
    _, speeds, accelerations = motion.sample(np.array([knot * KNOT_INTERVAL]))
    least = float(least_stop(speeds[0], accelerations[0], JOINT_LIMITS.acceleration, JOINT_LIMITS.jerk).max())
    taken = stop(motion, knot * KNOT_INTERVAL, JOINT_LIMITS).duration - knot * KNOT_INTERVAL
    assert least - 1e-9 <= taken <= max(least, 0.0) + 4 * KNOT_INTERVAL


def test_stop_of_a_motion_begins_at_the_next_knot():
    still = stay(np.zeros(3), 0.1)
    assert [cut_knot(still, time) for time in (-1.0, 0.0, 0.0101, 0.02, 0.5)] == [0, 0, 2, 2, 10]


def test_stopping_a_resting_motion_keeps_its_posture():
    still = stay(np.array([0.1, 0.2, 0.3]), 0.1)
    np.testing.assert_array_equal(stop(still, 0.05, JOINT_LIMITS).controls, still.controls[:8])


@pytest.mark.parametrize("seed", range(4))
def test_stopped_motion_ends_no_later_than_the_original_motion(seed):
    motion = moving(seed)
    for left in (0.03, 0.04, 0.06, 0.1, 0.2, 0.4):
        halted = stop(motion, motion.duration - left, JOINT_LIMITS)
        assert halted.duration <= motion.duration + 1e-9
        assert largest(halted) <= 1.001
    over = stop(motion, motion.duration + 1.0, JOINT_LIMITS)
    np.testing.assert_allclose(over.controls, motion.controls)


def test_stop_of_a_motion_with_a_later_start_uses_the_knots_of_the_motion():
    late = replace(moving(0), start=2.0)
    assert [cut_knot(late, time) for time in (0.0, 2.0, 2.01, 2.015)] == [0, 0, 1, 2]
    halted, early = stop(late, 2.3, JOINT_LIMITS), stop(moving(0), 0.3, JOINT_LIMITS)
    assert (halted.start, halted.zero) == (2.0, late.zero)
    np.testing.assert_array_equal(halted.controls, early.controls)


def test_stopped_motion_has_at_least_one_knot_interval():
    still = stay(np.zeros(3), 0.1)
    assert len(stop(still, 0.0, JOINT_LIMITS).controls) == 4


@pytest.mark.parametrize("least", range(12))
def test_stop_search_finds_the_fewest_extra_knot_intervals(least):
    asked = []

    def way(more: int):
        asked.append(more)
        return np.array([float(more)]) if more >= least else None

    result = _find_shortest(way, 50)
    assert result is not None
    assert result[0] == least
    assert result[1].tolist() == [least]
    assert len(asked) <= 9
    assert _find_shortest(lambda more: None, 50) is None


@pytest.mark.parametrize(
    ("needed", "pieces", "taken"),
    [(3, 9, 3), (6, 9, 6), (10, 9, None), (10, 10, 10), (11, 10, None), (30, 10, None)],
)
def test_motion_too_short_for_a_stop_is_returned_unchanged(monkeypatch, needed, pieces, taken):
    def solve(segment, desired, limits):
        return np.zeros(segment.grid.size) if segment.grid.pieces >= needed else None

    monkeypatch.setattr(stopping, "nearest_motion", solve)
    for least in (0, 3, 2):
        controls = np.arange(pieces + 3.0)
        halted = stopping._stop_hinge(0, controls, least, JOINT_LIMITS)
        if taken is None:
            assert halted is controls
        else:
            assert len(halted) == taken + 3
