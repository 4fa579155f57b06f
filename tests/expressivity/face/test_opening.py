import numpy as np
import pytest

from kinesic.expressivity.face.opening import LIP_OPENINGS, MAX_LIP_VELOCITY, limit_lip_opening, lip_opening

TIME_STEP = 0.005
SAMPLE_TIMES = TIME_STEP * np.arange(200)  # [s] one second of samples


def test_lip_opening_is_the_weighted_sum_of_lip_opening_action_units():
    assert lip_opening({"25": 0.5, "26": 0.5, "18": 1.0}) == pytest.approx(
        0.5 * LIP_OPENINGS["25"] + 0.5 * LIP_OPENINGS["26"]
    )


def test_lips_stay_within_velocity_and_opening_limits():
    shown = {"26": np.full(200, 0.6), "25": np.full(200, 0.5), "18": np.full(200, 0.3)}
    most = np.full(200, np.inf)
    most[80:90] = most[100:105] = 0.0
    limit_lip_opening(shown, most, TIME_STEP)
    opened = sum(LIP_OPENINGS[channel] * shown[channel] for channel in ("25", "26"))
    assert opened[80:90].max() == opened[100:105].max() == 0.0
    assert np.abs(np.diff(opened)).max() <= 1.001 * MAX_LIP_VELOCITY * TIME_STEP
    assert opened[:20].min() == pytest.approx(lip_opening({"25": 0.5, "26": 0.6}))
    assert 0.0 < opened[90:100].max() < 0.004  # The time is too short for more
    np.testing.assert_allclose(shown["25"] / 0.5, shown["26"] / 0.6)
    assert (shown["18"] == 0.3).all()


def test_mouth_motion_below_all_limits_is_unchanged():
    row = 0.1 * np.sin(np.pi * SAMPLE_TIMES) ** 2
    shown = {"26": row}
    limit_lip_opening(shown, np.full(200, np.inf), TIME_STEP)
    np.testing.assert_allclose(shown["26"], row, atol=0.002)
    assert (shown["26"] <= row + 1e-12).all()


def test_lips_slow_down_gradually_before_they_close():
    shown = {"26": np.ones(200)}
    most = np.full(200, np.inf)
    most[100] = 0.0
    limit_lip_opening(shown, most, TIME_STEP)
    steps = np.abs(np.diff(LIP_OPENINGS["26"] * shown["26"]))[:100][::-1]
    assert steps[0] < steps[2] < steps[4]
    assert steps[0] < 0.2 * MAX_LIP_VELOCITY * TIME_STEP
    assert steps.max() > 0.9 * MAX_LIP_VELOCITY * TIME_STEP
