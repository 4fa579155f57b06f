import numpy as np
import pytest

from kinesic.expressivity.face.opening import FASTEST, OPENING, limit_opening, opening

STEP = 0.005
TIMES = STEP * np.arange(200)  # a second


def test_opening_is_the_sum_of_what_parts_the_lips():
    assert opening({"25": 0.5, "26": 0.5, "18": 1.0}) == pytest.approx(0.5 * OPENING["25"] + 0.5 * OPENING["26"])


def test_lips_go_no_faster_than_lips_and_are_where_they_must_be():
    shown = {"26": np.full(200, 0.6), "25": np.full(200, 0.5), "18": np.full(200, 0.3)}
    most = np.full(200, np.inf)
    most[80:90] = most[100:105] = 0.0
    limit_opening(shown, most, STEP)
    opened = sum(OPENING[channel] * shown[channel] for channel in ("25", "26"))
    assert opened[80:90].max() == opened[100:105].max() == 0.0
    assert np.abs(np.diff(opened)).max() <= 1.001 * FASTEST * STEP
    assert opened[:20].min() == pytest.approx(opening({"25": 0.5, "26": 0.6}))
    assert 0.0 < opened[90:100].max() < 0.004  # there is no time for more
    np.testing.assert_allclose(shown["25"] / 0.5, shown["26"] / 0.6)
    assert (shown["18"] == 0.3).all()


def test_a_mouth_that_may_do_as_it_likes_is_left_alone():
    row = 0.1 * np.sin(np.pi * TIMES) ** 2
    shown = {"26": row}
    limit_opening(shown, np.full(200, np.inf), STEP)
    np.testing.assert_allclose(shown["26"], row, atol=0.002)
    assert (shown["26"] <= row + 1e-12).all()


def test_lips_gather_speed_before_they_are_as_fast_as_lips_can_be():
    shown = {"26": np.ones(200)}
    most = np.full(200, np.inf)
    most[100] = 0.0
    limit_opening(shown, most, STEP)
    steps = np.abs(np.diff(OPENING["26"] * shown["26"]))[:100][::-1]
    assert steps[0] < steps[2] < steps[4]
    assert steps[0] < 0.2 * FASTEST * STEP
    assert steps.max() > 0.9 * FASTEST * STEP
