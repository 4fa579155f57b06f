import numpy as np
import pytest

from kinesic.metrics.tracking_delay import estimate_tracking_delays

TIMES = np.arange(0.0, 4.0, 0.01)


def pulse(times, late):
    """Return the velocity of a motion forth and back."""
    moved = times - late
    return np.exp(-((moved - 1.2) ** 2) / 0.02) - 0.7 * np.exp(-((moved - 2.6) ** 2) / 0.05)


def of(speeds):
    """Return the velocities of some hinges."""
    return lambda hinges: speeds[:, hinges]


@pytest.mark.parametrize("late", [0.0, 0.0032, 0.0471, 0.2, -0.031])
def test_tracking_delay_is_interpolated_between_samples(late):
    planned = np.stack([pulse(TIMES, 0.0), 3.0 * pulse(TIMES, 0.3)], axis=1)
    performed = np.stack([0.8 * pulse(TIMES, late), 3.0 * pulse(TIMES, 0.3)], axis=1)
    delays = estimate_tracking_delays(of(planned), performed, np.array([True, True]), period=0.01)
    assert delays == pytest.approx([late, 0.0], abs=2e-4)


def test_tracking_delay_of_a_still_hinge_is_nan():
    planned = np.stack([pulse(TIMES, 0.0), np.zeros_like(TIMES)], axis=1)
    delays = estimate_tracking_delays(of(planned), planned, np.array([True, False]), period=0.01)
    assert delays[0] == pytest.approx(0.0, abs=1e-9)
    assert np.isnan(delays[1])
    assert np.isnan(estimate_tracking_delays(of(planned), planned, np.array([False, False]), period=0.01)).all()


def test_measured_tracking_delays_do_not_depend_on_the_batch_size(monkeypatch):
    monkeypatch.setattr("kinesic.metrics.tracking_delay.VELOCITIES_PER_WINDOW", 2 * len(TIMES))
    late = [0.0, 0.02, 0.05, -0.01, 0.11, 0.07, 0.03]
    planned = np.stack([pulse(TIMES, 0.0)] * len(late), axis=1)
    performed = np.stack([pulse(TIMES, item) for item in late], axis=1)
    moving = np.array([True, True, False, True, True, True, True])
    delays = estimate_tracking_delays(of(planned), performed, moving, period=0.01)
    assert np.isnan(delays[2])
    assert delays[moving] == pytest.approx(np.array(late)[moving], abs=2e-4)
