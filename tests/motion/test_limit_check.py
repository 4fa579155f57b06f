import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import limit_check
from kinesic.motion.limit_check import CHUNK, check_limits, find_beyond
from kinesic.motion.trajectory import STEP, Trajectory

LIMITS = Limits(
    lower=sealed([-1.0, -1.0]),
    upper=sealed([1.0, 3.0]),
    speed=sealed([2.0, 2.5]),
    acceleration=sealed([9.0, 4.0]),
    jerk=sealed([100.0, 10.0]),
    inertial=sealed([0.1, 0.1]),
    viscous=sealed([0.2, 0.3]),
    duty=sealed([0.8, 0.5]),
)


def wandering(pieces, seed=4):
    """A motion of two hinges without order."""
    steps = np.random.default_rng(seed).normal(0.0, 0.02, (pieces + 3, 2))
    return Trajectory(sealed(np.cumsum(steps, axis=0)), 0.0)


def sampled(trajectory):
    """Quantity -> values at 1 kHz and what is allowed, by the trajectory's own word."""
    times = np.arange(round(1000 * trajectory.duration) + 1) / 1000
    angles, speeds, accelerations = trajectory.sample(times)
    middle, half = (LIMITS.upper + LIMITS.lower) / 2, (LIMITS.upper - LIMITS.lower) / 2
    return times, {
        "position": (angles - middle) / half,
        "speed": speeds / LIMITS.speed,
        "acceleration": accelerations / LIMITS.acceleration,
        "jerk": trajectory.jerks(times) / LIMITS.jerk,
        "duty": (LIMITS.inertial * accelerations + LIMITS.viscous * speeds) / LIMITS.duty,
    }


@pytest.mark.parametrize("kernel", dict.fromkeys([limit_check.KERNEL, "numpy"]))
@pytest.mark.parametrize("pieces", [1, 10, CHUNK, CHUNK + 1, 3 * CHUNK + 7])
def test_peaks_are_those_of_the_trajectory_at_1_khz(monkeypatch, pieces, kernel):
    monkeypatch.setattr(limit_check, "KERNEL", kernel)
    motion = wandering(pieces)
    found = check_limits(motion, LIMITS).shares
    times, expected = sampled(motion)
    assert found.keys() == expected.keys()
    for name, ratios in expected.items():
        assert found[name].ratios == pytest.approx(np.abs(ratios).max(axis=0), rel=1e-9), name
        assert found[name].hinge == int(np.abs(ratios).max(axis=0).argmax()), name
        there = np.abs(times - found[name].time) < STEP + 1e-9
        assert np.abs(ratios[there, found[name].hinge]).max() == pytest.approx(np.abs(ratios).max(), rel=1e-9), name


@pytest.mark.parametrize("kernel", dict.fromkeys([limit_check.KERNEL, "numpy"]))
def test_rms_jerk(monkeypatch, kernel):
    monkeypatch.setattr(limit_check, "KERNEL", kernel)
    motion = wandering(300)
    jerks = motion.jerks((np.arange(300) + 0.5) * STEP)
    assert check_limits(motion, LIMITS).rms_jerk == pytest.approx(np.sqrt(np.mean(jerks**2)))


def test_a_peak_at_the_very_end_counts():
    controls = np.zeros((43, 2))
    controls[-1, 1] = 1.0
    motion = Trajectory(sealed(controls), 0.0)
    speed = check_limits(motion, LIMITS).shares["speed"]
    assert speed.hinge == 1
    assert speed.time == pytest.approx(motion.duration)


def test_only_what_breaks_a_limit_that_the_other_motion_keeps_is_beyond():
    still, both = np.zeros((2, 40)), np.array([0, 1])
    leaping = still.copy()
    leaping[1, 20] = 0.002
    found = find_beyond(leaping, still, LIMITS, both, full=1.0)
    assert np.flatnonzero(found[1]).tolist() == [*range(17, 24)], "all that its jerks depend on"
    assert not found[0].any()
    assert not find_beyond(leaping, leaping, LIMITS, both, full=1.0).any(), "it was as fast before"
    assert find_beyond(2.0 * leaping, leaping, LIMITS, both, full=1.0)[1, 20]


@pytest.mark.skipif(limit_check.KERNEL == "numpy", reason="no compiled kernel")
def test_the_kernel_finds_the_same_control_points_beyond_limits(monkeypatch):
    controls, before = (wandering(300, seed).controls.T * scale for seed, scale in ((1, 0.02), (2, 0.01)))
    given = controls[::-1] + before, before, LIMITS, np.array([1, 0])
    compiled = find_beyond(*given, full=6.0)
    monkeypatch.setattr(limit_check, "KERNEL", "numpy")
    np.testing.assert_array_equal(find_beyond(*given, full=6.0), compiled)
    assert 0.05 < compiled.mean() < 0.95
