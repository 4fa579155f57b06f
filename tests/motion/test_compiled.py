"""The kernel samples motions, and finds their peaks, as Python does."""

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion import limit_check, trajectory
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import Trajectory

pytestmark = pytest.mark.skipif(trajectory.KERNEL != "compiled", reason="no compiled kernel")


def wander(count: int, hinges: int) -> Trajectory:
    steps = np.random.default_rng(count).normal(scale=1e-4, size=(count + 3, hinges))
    return Trajectory(sealed(np.cumsum(np.cumsum(steps, axis=0), axis=0)), 0.0, start=0.3)


@pytest.fixture
def in_python(monkeypatch):
    def run(function):
        with monkeypatch.context() as patch:
            for module in (limit_check, trajectory):
                patch.setattr(module, "KERNEL", "numpy")
            return function()

    return run


@pytest.mark.parametrize("count", [1, 2, 130])
def test_samples_are_the_same_before_within_and_after_the_motion(count, in_python):
    motion = wander(count, 5)
    times = np.linspace(motion.start - 0.05, motion.end + 0.05, 333)
    for fast, slow in zip(motion.sample(times), in_python(lambda: motion.sample(times)), strict=True):
        np.testing.assert_allclose(fast, slow, rtol=1e-12, atol=1e-12)


def test_peaks_are_the_same_and_so_are_their_times(in_python, known):
    motion = wander(400, len(known.limits.lower))
    fast, slow = check_limits(motion, known.limits), in_python(lambda: check_limits(motion, known.limits))
    assert list(fast.shares) == list(slow.shares)
    for name, peak in fast.shares.items():
        np.testing.assert_allclose(peak.ratios, slow.shares[name].ratios, rtol=1e-12, atol=0, err_msg=name)
        assert peak.time == pytest.approx(slow.shares[name].time, abs=1e-12), name
    assert fast.rms_jerk == pytest.approx(slow.rms_jerk, rel=1e-12)
