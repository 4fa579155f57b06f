import numpy as np
import pytest

from kinesic.hardware.bus.timeout import LEAST, MOST, TimeoutEstimate


def after(excesses: list[float]) -> TimeoutEstimate:
    slack = TimeoutEstimate()
    for excess in excesses:
        slack.took(excess)
    return slack


@pytest.mark.parametrize("usual", [0.0001, 0.001, 0.004, 0.009])
def test_it_finds_what_nine_in_ten_take(usual: float):
    rng = np.random.default_rng(0)
    slack = after((usual * rng.uniform(0.0, 1.0, 3000)).tolist())
    assert slack.usual == pytest.approx(0.9 * usual, abs=0.001)
    assert LEAST <= slack.wait <= MOST
    assert slack.wait >= usual


def test_a_rare_late_answer_does_not_hold_up_the_others():
    rng = np.random.default_rng(0)
    slack = after([0.012 if rng.random() < 0.05 else 0.001 for _ in range(2000)])
    assert slack.wait < 0.005


def test_answers_that_are_mostly_late_are_waited_for():
    rng = np.random.default_rng(0)
    slack = after([0.012 if rng.random() < 0.4 else 0.001 for _ in range(2000)])
    assert slack.wait > 0.012


def test_it_stays_within_bounds():
    assert after([1.0] * 2000).wait == MOST
    assert after([-1.0] * 2000).wait == LEAST
