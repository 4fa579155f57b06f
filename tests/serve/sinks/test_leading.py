import numpy as np
import pytest

from kinesic.controller.feedforward import FeedForward
from kinesic.serve.sinks.leading import OVER, Leading
from kinesic.sim.servo_factors import NOMINAL, Factors


class Swing:
    """All hinges swing at 1 Hz by a tenth of a radian."""

    def __init__(self, hinges: int) -> None:
        self._one = np.ones(hinges)

    def sample(self, times):
        turns = 2.0 * np.pi
        rows = 0.1 * np.sin(turns * times), 0.1 * turns * np.cos(turns * times), -0.1 * turns**2 * np.sin(turns * times)
        return tuple(np.outer(row, self._one) for row in rows)


SOFT = Factors(gain=0.5, latency=0.015)


def test_goals_go_over_to_what_was_learned_without_a_jump(known):
    leading, motion = Leading(NOMINAL, delay=0.002), Swing(len(known.robot.drives))
    leading.change(SOFT, 2.0)
    times = np.arange(1.5, 3.5, 0.01)
    goals = leading.feedforward(known, times).lead(motion, times).goals
    before, after = (
        FeedForward.of(known.robot, known.dynamics, believed, delay=0.002).lead(motion, times).goals
        for believed in (NOMINAL, SOFT)
    )
    np.testing.assert_allclose(goals[times <= 2.0], before[times <= 2.0], atol=1e-12)
    np.testing.assert_allclose(goals[times >= 2.0 + OVER], after[times >= 2.0 + OVER], atol=1e-12)
    assert np.abs(np.diff(goals, axis=0)).max() < 1.3 * np.abs(np.diff(after, axis=0)).max()


def test_tick_by_tick_and_many_at_once_are_the_same(known):
    leading, motion = Leading(NOMINAL, delay=0.0), Swing(len(known.robot.drives))
    leading.change(SOFT, 0.1)
    times = np.arange(0.0, 0.5, 0.05)
    at_once = leading.feedforward(known, times).lead(motion, times).goals
    single = [leading.feedforward(known, times[k : k + 1]).lead(motion, times[k : k + 1]).goals[0] for k in range(10)]
    assert at_once == pytest.approx(np.array(single), abs=1e-12)
