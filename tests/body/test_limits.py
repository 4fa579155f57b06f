"""Tests of motion limits derived from loads or given directly."""

from dataclasses import fields

import numpy as np
import pytest

from kinesic.body.dynamics import Load
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot

DEFAULT_ROBOT = Robot.load()
STALL_TORQUES = DEFAULT_ROBOT.drives.stall
LIMIT_NAMES = [field.name for field in fields(Limits)]
BOX_LIMITS = {
    "lower": [-1.0, 0.0],
    "upper": [1.0, 2.0],
    "speed": [2.0, 4.0],
    "acceleration": [10.0, 30.0],
    "jerk": [100.0, 900.0],
}


def loaded(holding: float, inertia: float = 0.01) -> Limits:
    return Limits.of(DEFAULT_ROBOT, Load(inertia=inertia * STALL_TORQUES, holding=holding * STALL_TORQUES))


def test_acceleration_limit_and_load_use_80_percent_of_stall_torque():
    limits = loaded(0.3)
    torque = limits.acceleration * 0.01 * STALL_TORQUES + 0.3 * STALL_TORQUES + DEFAULT_ROBOT.drives.frictionloss
    np.testing.assert_allclose(torque, 0.8 * STALL_TORQUES)
    np.testing.assert_allclose(limits.acceleration / limits.jerk, 0.04)


def test_duty_limit_subtracts_holding_duty():
    limits = loaded(0.3)
    np.testing.assert_allclose(limits.duty, 0.73 - 0.3 - DEFAULT_ROBOT.drives.frictionloss / STALL_TORQUES)
    np.testing.assert_allclose(limits.inertial, 0.01)
    np.testing.assert_allclose(limits.viscous * DEFAULT_ROBOT.drives.no_load, 1.0)
    np.testing.assert_array_equal(limits.speed, DEFAULT_ROBOT.velocity_limits)
    assert limits.lower is DEFAULT_ROBOT.skeleton.lower
    assert limits.upper is DEFAULT_ROBOT.skeleton.upper


def test_overloaded_hinge_has_the_minimum_acceleration_and_duty_limits():
    limits = loaded(1.5)
    np.testing.assert_array_equal(limits.acceleration, 1.0)
    np.testing.assert_array_equal(limits.duty, 0.1)


def test_more_load_reduces_acceleration_jerk_and_duty_limits():
    light, heavy = loaded(0.1), loaded(0.4, inertia=0.02)
    for name in ("acceleration", "jerk", "duty"):
        assert (getattr(heavy, name) < getattr(light, name)).all()


def test_scaled_motion_limits_differ_only_in_acceleration_jerk_and_duty():
    limits = Limits.box(**BOX_LIMITS)
    assert limits.scaled(1.0) is limits
    half, result = limits.scaled(0.5), limits.scaled(np.array([0.5, 1.0]))
    for name in LIMIT_NAMES:
        scaled = name in ("acceleration", "jerk", "duty")
        np.testing.assert_allclose(getattr(half, name), getattr(limits, name) * (0.5 if scaled else 1.0))
        np.testing.assert_allclose(getattr(result, name), getattr(limits, name) * ([0.5, 1.0] if scaled else 1.0))


def test_motion_limits_of_selected_joints_are_returned_in_the_selected_order():
    limits = Limits.box(**BOX_LIMITS)
    part = limits.part(np.array([1, 0]))
    for name in LIMIT_NAMES:
        np.testing.assert_array_equal(getattr(part, name), getattr(limits, name)[[1, 0]])


def test_box_limits_have_a_duty_limit_that_never_binds():
    limits = Limits.box(**BOX_LIMITS)
    for name, values in BOX_LIMITS.items():
        np.testing.assert_array_equal(getattr(limits, name), values)
    duty = limits.inertial * limits.acceleration + limits.viscous * limits.speed
    assert (duty < 1e-3 * limits.duty).all()
    assert (duty > 0.0).all()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"speed": [1.0]}, "give one number per hinge in each"),
        ({"lower": 0.0, "upper": 1.0, "speed": 1.0, "acceleration": 1.0, "jerk": 1.0}, "give one number per hinge"),
        ({"upper": [1.0, 0.0]}, r"lower \[-1.0, 0.0\] must be below upper \[1.0, 0.0\]"),
        ({"lower": [np.nan, 0.0]}, "must be below"),
        ({"speed": [0.0, 1.0]}, r"speed is \[0.0, 1.0\]; every limit must be finite and above 0"),
        ({"acceleration": [-1.0, 1.0]}, "acceleration is"),
        ({"jerk": [np.inf, 1.0]}, "jerk is"),
    ],
)
def test_invalid_motion_limits_are_refused(wrong, said):
    with pytest.raises(ValueError, match=said):
        Limits.box(**(BOX_LIMITS | wrong))
