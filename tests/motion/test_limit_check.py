import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.limit_check import INTERVALS_PER_GROUP, check_limits, find_beyond
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory

from ..reference.motion import sampling

JOINT_LIMITS = Limits(  # limits of two hinges
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
    """Return a random motion of two hinges."""
    steps = np.random.default_rng(seed).normal(0.0, 0.02, (pieces + 3, 2))
    return Trajectory(sealed(np.cumsum(steps, axis=0)), 0.0)


def sampled(trajectory):
    """Return sample times at 1 kHz, and sampled limit ratios by quantity."""
    times = np.arange(round(1000 * trajectory.duration) + 1) / 1000
    angles, speeds, accelerations = trajectory.sample(times)
    middle, half = (JOINT_LIMITS.upper + JOINT_LIMITS.lower) / 2, (JOINT_LIMITS.upper - JOINT_LIMITS.lower) / 2
    return times, {
        "position": (angles - middle) / half,
        "speed": speeds / JOINT_LIMITS.speed,
        "acceleration": accelerations / JOINT_LIMITS.acceleration,
        "jerk": trajectory.jerks(times) / JOINT_LIMITS.jerk,
        "duty": (JOINT_LIMITS.inertial * accelerations + JOINT_LIMITS.viscous * speeds) / JOINT_LIMITS.duty,
    }


@pytest.mark.parametrize("pieces", [1, 10, INTERVALS_PER_GROUP, INTERVALS_PER_GROUP + 1, 3 * INTERVALS_PER_GROUP + 7])
def test_limit_peaks_equal_those_of_samples_at_1_khz(pieces):
    motion = wandering(pieces)
    by_quantity = check_limits(motion, JOINT_LIMITS).by_quantity
    times, expected = sampled(motion)
    assert by_quantity.keys() == expected.keys()
    for name, ratios in expected.items():
        assert by_quantity[name].ratios == pytest.approx(np.abs(ratios).max(axis=0), rel=1e-9), name
        assert by_quantity[name].hinge == int(np.abs(ratios).max(axis=0).argmax()), name
        there = np.abs(times - by_quantity[name].time) < KNOT_INTERVAL + 1e-9
        assert np.abs(ratios[there, by_quantity[name].hinge]).max() == pytest.approx(np.abs(ratios).max(), rel=1e-9), (
            name
        )


def test_rms_jerk_matches_its_definition():
    motion = wandering(300)
    jerks = motion.jerks((np.arange(300) + 0.5) * KNOT_INTERVAL)
    assert check_limits(motion, JOINT_LIMITS).rms_jerk == pytest.approx(np.sqrt(np.mean(jerks**2)))


def test_limit_peak_at_the_end_of_the_motion_is_found():
    controls = np.zeros((43, 2))
    controls[-1, 1] = 1.0
    motion = Trajectory(sealed(controls), 0.0)
    speed = check_limits(motion, JOINT_LIMITS).by_quantity["speed"]
    assert speed.hinge == 1
    assert speed.time == pytest.approx(motion.duration)


def test_only_limit_violations_absent_from_the_earlier_motion_are_flagged():
    still, both = np.zeros((2, 40)), np.array([0, 1])
    leaping = still.copy()
    leaping[1, 20] = 0.002
    beyond = find_beyond(leaping, still, JOINT_LIMITS, both, full=1.0)
    assert np.flatnonzero(beyond[1]).tolist() == [*range(17, 24)], "all that its jerks depend on"
    assert not beyond[0].any()
    assert not find_beyond(leaping, leaping, JOINT_LIMITS, both, full=1.0).any(), "it was as fast before"
    assert find_beyond(2.0 * leaping, leaping, JOINT_LIMITS, both, full=1.0)[1, 20]


def test_compiled_flags_of_control_points_beyond_limits_equal_the_python_reference():
    controls, before = (wandering(300, seed).controls.T * scale for seed, scale in ((1, 0.02), (2, 0.01)))
    given = controls[::-1] + before, before, JOINT_LIMITS, np.array([1, 0])
    compiled = find_beyond(*given, full=6.0)
    np.testing.assert_array_equal(sampling.find_beyond(*given, full=6.0), compiled)
    assert 0.05 < compiled.mean() < 0.95
