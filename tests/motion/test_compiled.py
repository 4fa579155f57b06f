"""Tests of compiled samples and limit peaks against their Python reference."""

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory

from ..reference.motion import sampling


def wander(count: int, hinges: int) -> Trajectory:
    steps = np.random.default_rng(count).normal(scale=1e-4, size=(count + 3, hinges))
    return Trajectory(sealed(np.cumsum(np.cumsum(steps, axis=0), axis=0)), 0.0, start=0.3)


@pytest.mark.parametrize("count", [1, 2, 130])
def test_compiled_samples_equal_the_python_reference_before_during_and_after_motion(count):
    motion = wander(count, 5)
    times = np.linspace(motion.start - 0.05, motion.end + 0.05, 333)
    for compiled, expected in zip(motion.sample(times), sampling.sample(motion, times), strict=True):
        np.testing.assert_allclose(compiled, expected, rtol=1e-12, atol=1e-12)


def test_compiled_limit_peaks_and_times_equal_the_python_reference(known):
    motion = wander(400, len(known.limits.lower))
    peaks, expected = check_limits(motion, known.limits), sampling.limit_ratios(motion, known.limits)
    assert list(peaks.by_quantity) == list(expected)
    for name, peak in peaks.by_quantity.items():
        ratios = np.abs(expected[name])
        largest = ratios.max(axis=(0, 1))
        np.testing.assert_allclose(peak.ratios, largest, rtol=1e-12, atol=0, err_msg=name)
        interval, instant, _ = np.unravel_index(ratios[..., [largest.argmax()]].argmax(), (*ratios.shape[:2], 1))
        time = KNOT_INTERVAL * (interval + sampling.INSTANTS[instant])
        assert peak.time == pytest.approx(time, abs=1e-12), name
    jerks = expected["jerk"] * known.limits.jerk
    assert peaks.rms_jerk == pytest.approx(np.sqrt(np.mean(jerks**2)), rel=1e-12)
