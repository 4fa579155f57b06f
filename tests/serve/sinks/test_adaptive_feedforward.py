import numpy as np
import pytest

from kinesic.controller.feedforward import FeedForward
from kinesic.serve.sinks.adaptive_feedforward import TRANSITION_DURATION, AdaptiveFeedForward
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors


class Swing:
    """Motion of all hinges at 1 Hz with an amplitude of 0.1 rad."""

    def __init__(self, hinges: int) -> None:
        self._one = np.ones(hinges)

    def sample(self, times):
        turns = 2.0 * np.pi
        rows = 0.1 * np.sin(turns * times), 0.1 * turns * np.cos(turns * times), -0.1 * turns**2 * np.sin(turns * times)
        return tuple(np.outer(row, self._one) for row in rows)


SOFT_SERVOS = Factors(gain=0.5, latency=0.015)


def test_setpoints_change_to_the_learned_servo_model_without_a_jump(known):
    leading, motion = AdaptiveFeedForward(NOMINAL_FACTORS, delay=0.002), Swing(len(known.robot.drives))
    leading.change(SOFT_SERVOS, 2.0)
    times = np.arange(1.5, 3.5, 0.01)
    goals = leading.feedforward(known, times).compute_setpoints(motion, times).setpoints
    before, after = (
        FeedForward.of(known.robot, known.dynamics, believed, delay=0.002).compute_setpoints(motion, times).setpoints
        for believed in (NOMINAL_FACTORS, SOFT_SERVOS)
    )
    np.testing.assert_allclose(goals[times <= 2.0], before[times <= 2.0], atol=1e-12)
    np.testing.assert_allclose(
        goals[times >= 2.0 + TRANSITION_DURATION], after[times >= 2.0 + TRANSITION_DURATION], atol=1e-12
    )
    assert np.abs(np.diff(goals, axis=0)).max() < 1.3 * np.abs(np.diff(after, axis=0)).max()


def test_feed_forward_of_single_ticks_equals_that_of_batches(known):
    leading, motion = AdaptiveFeedForward(NOMINAL_FACTORS, delay=0.0), Swing(len(known.robot.drives))
    leading.change(SOFT_SERVOS, 0.1)
    times = np.arange(0.0, 0.5, 0.05)
    at_once = leading.feedforward(known, times).compute_setpoints(motion, times).setpoints
    single = [
        leading.feedforward(known, times[k : k + 1]).compute_setpoints(motion, times[k : k + 1]).setpoints[0]
        for k in range(10)
    ]
    assert at_once == pytest.approx(np.array(single), abs=1e-12)
