import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.controller.condition import LEAD_IN, condition
from kinesic.controller.postures import Posture
from kinesic.controller.retime import minimum_duration
from kinesic.controller.trajectory import Manner, spline

LIMITS = Limits(sealed([-2.0, -2.0]), sealed([2.0, 2.0]), sealed([4.0, 6.0]), sealed([40.0, 60.0]))


def posture(time: float, angles: tuple[float, float], *syncs: str) -> Posture:
    return Posture(time, sealed(angles), (True, True), tuple(("b", sync) for sync in syncs))


def highest(trajectory) -> float:
    """Largest ratio of speed or acceleration to its limit, at 10 kHz."""
    _, speeds, accelerations = trajectory.sample(np.arange(0.0, trajectory.duration, 1e-4))
    return max((np.abs(speeds) / LIMITS.speed).max(), (np.abs(accelerations) / LIMITS.acceleration).max())


def test_a_feasible_motion_keeps_its_times():
    keys = (posture(0.0, (0, 0), "start"), posture(1.0, (0.5, 0.5), "stroke"), posture(2.0, (0, 0), "end"))
    motion = condition(keys, LIMITS, Manner())
    np.testing.assert_array_equal(motion.planned, motion.asked)
    assert not motion.bottlenecks


def test_a_fast_motion_is_stretched_into_the_limits_and_says_which():
    keys = (posture(0.0, (0, 0), "start"), posture(0.2, (1.5, 0.1), "stroke"), posture(0.4, (0, 0), "end"))
    motion = condition(keys, LIMITS, Manner())
    assert {found.hinge for found in motion.bottlenecks.values()} == {0}
    assert highest(motion.trajectory) <= 1.0
    assert motion.planned[2] - motion.planned[0] > 0.4


def test_the_stroke_is_kept_when_the_preparation_can_begin_earlier():
    keys = (posture(0.0, (0, 0), "start"), posture(0.4, (1.2, 0.1), "stroke"), posture(3.0, (0, 0), "end"))
    motion = condition(keys, LIMITS, Manner())
    assert motion.planned[1] == pytest.approx(0.4, abs=1e-6)
    assert motion.planned[0] < 0.0


def test_the_lead_in_is_bounded():
    keys = (posture(0.0, (0, 0), "start"), posture(0.05, (1.9, 1.9), "stroke"), posture(3.0, (0, 0), "end"))
    assert condition(keys, LIMITS, Manner()).planned[0] >= -LEAD_IN - 1e-9
    assert condition(keys, LIMITS, Manner(), lead_in=0.0).planned[0] >= -1e-9


def test_a_rest_to_rest_move_of_the_minimum_duration_is_within_limits_and_hardly_longer():
    for distance in (0.01, 0.3, 1.9):
        duration = float(minimum_duration(np.array([distance, 0.0]), LIMITS).max())
        angles, times = np.array([[0.0, 0.0], [distance, 0.0]]), np.array([0.0, duration])
        whole = np.ones((2, 2), dtype=bool)
        move = spline(times, angles, whole, Manner(), np.ones((2, 2)), zero=0.0)
        assert 0.9 < highest(move) <= 1.0


def test_order_of_keys_is_kept():
    rng = np.random.default_rng(4)
    keys = tuple(posture(0.1 * k, tuple(rng.uniform(-1.5, 1.5, 2)), "stroke") for k in range(8))
    motion = condition(keys, LIMITS, Manner())
    assert np.all(np.diff(motion.planned) > 0)


def test_keys_that_were_asked_for_at_the_same_time_are_moved_apart():
    keys = (
        posture(0.0, (0, 0), "start"),
        posture(1.0, (0.3, 0), "stroke"),
        posture(1.0, (0.2, 0.1)),
        posture(2.0, (0, 0), "end"),
    )
    motion = condition(keys, LIMITS, Manner())
    assert np.all(np.diff(motion.planned) > 0.019)
    assert np.all(np.isfinite(motion.trajectory.sample(np.linspace(0, 2, 50))[2]))
