"""Independent checks of certified motions, on motions with known violations."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.bench.capture.independent_checks import find_largest_ratio, touches_itself
from kinesic.motion.trajectory import Trajectory

WIDE_LIMITS = {"lower": -9.0, "upper": 9.0, "speed": 1e9, "acceleration": 1e9, "jerk": 1e9, "duty": 1e9}


def ratio(controls, **limits: float) -> float:
    """Return a hinge's largest value / limit, with only the given limits binding."""
    values = {
        name: np.array([value]) for name, value in (WIDE_LIMITS | {"inertial": 0.0, "viscous": 0.0} | limits).items()
    }
    trajectory = Trajectory(np.asarray(controls)[:, None], 0.0)
    return find_largest_ratio(trajectory, SimpleNamespace(**values))


def test_independent_check_finds_velocity_duty_and_range_violations_of_a_linear_motion():
    line = 0.02 * np.arange(40)  # 2 rad/s
    assert ratio(line, speed=1.6) == pytest.approx(1.25)
    assert ratio(line, duty=4.0, viscous=3.0) == pytest.approx(1.5)
    assert ratio(line, upper=0.5) == pytest.approx(1.0 + 0.02 * 38 - 0.5, abs=3e-4)
    assert ratio(-line, lower=-0.5) == pytest.approx(1.0 + 0.02 * 38 - 0.5, abs=3e-4)


def test_independent_check_finds_acceleration_duty_and_jerk_violations_of_a_cubic_motion():
    times = 0.01 * np.arange(-1, 39)
    cubic = times**3 - 1e-4 * times  # control points of t^3
    assert ratio(cubic, jerk=4.0) == pytest.approx(1.5)
    assert ratio(cubic, acceleration=1.0) == pytest.approx(6.0 * 0.37, rel=1e-3)
    assert ratio(cubic, duty=1.0, inertial=2.0) == pytest.approx(12.0 * 0.37, rel=1e-3)


def test_independent_check_finds_self_contact_exactly_in_postures_with_negative_clearance(known):
    skeleton = known.robot.skeleton
    postures = np.random.default_rng(0).uniform(skeleton.lower, skeleton.upper, (60, len(skeleton.names)))
    is_near = known.distances.clearance(postures).distances < 0.0
    assert [touches_itself(posture[None], known.robot) for posture in postures] == is_near.tolist()
    assert 5 < is_near.sum() < 55
    assert touches_itself(np.stack([skeleton.rest, postures[is_near.argmax()]]), known.robot)
