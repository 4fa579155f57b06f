"""Limits of a robot under load, and boxes of hinges without a known drive."""

from dataclasses import fields

import numpy as np
import pytest

from kinesic.body.dynamics import Load
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot

ROBOT = Robot.load()
STALL = ROBOT.drives.stall
NAMES = [field.name for field in fields(Limits)]
BOX = {
    "lower": [-1.0, 0.0],
    "upper": [1.0, 2.0],
    "speed": [2.0, 4.0],
    "acceleration": [10.0, 30.0],
    "jerk": [100.0, 900.0],
}


def loaded(holding: float, inertia: float = 0.01) -> Limits:
    return Limits.of(ROBOT, Load(inertia=inertia * STALL, holding=holding * STALL))


def test_accelerating_and_holding_together_take_four_fifths_of_the_stall_torque():
    limits = loaded(0.3)
    torque = limits.acceleration * 0.01 * STALL + 0.3 * STALL + ROBOT.drives.frictionloss
    np.testing.assert_allclose(torque, 0.8 * STALL)
    np.testing.assert_allclose(limits.acceleration / limits.jerk, 0.04)


def test_duty_leaves_room_for_what_holds_still():
    limits = loaded(0.3)
    np.testing.assert_allclose(limits.duty, 0.73 - 0.3 - ROBOT.drives.frictionloss / STALL)
    np.testing.assert_allclose(limits.inertial, 0.01)
    np.testing.assert_allclose(limits.viscous * ROBOT.drives.no_load, 1.0)
    np.testing.assert_array_equal(limits.speed, ROBOT.speed_limits)
    assert limits.lower is ROBOT.skeleton.lower
    assert limits.upper is ROBOT.skeleton.upper


def test_a_hinge_that_can_hardly_hold_itself_may_still_move_slowly():
    limits = loaded(1.5)
    np.testing.assert_array_equal(limits.acceleration, 1.0)
    np.testing.assert_array_equal(limits.duty, 0.1)


def test_more_load_never_widens_a_limit():
    light, heavy = loaded(0.1), loaded(0.4, inertia=0.02)
    for name in ("acceleration", "jerk", "duty"):
        assert (getattr(heavy, name) < getattr(light, name)).all()


def test_a_share_scales_what_a_plan_may_accelerate_and_load():
    limits = Limits.box(**BOX)
    assert limits.times(1.0) is limits
    half, each = limits.times(0.5), limits.times(np.array([0.5, 1.0]))
    for name in NAMES:
        scaled = name in ("acceleration", "jerk", "duty")
        np.testing.assert_allclose(getattr(half, name), getattr(limits, name) * (0.5 if scaled else 1.0))
        np.testing.assert_allclose(getattr(each, name), getattr(limits, name) * ([0.5, 1.0] if scaled else 1.0))


def test_a_part_has_the_limits_of_its_hinges_in_their_order():
    limits = Limits.box(**BOX)
    part = limits.part(np.array([1, 0]))
    for name in NAMES:
        np.testing.assert_array_equal(getattr(part, name), getattr(limits, name)[[1, 0]])


def test_boxes_bound_by_themselves_long_before_their_duty_does():
    limits = Limits.box(**BOX)
    for name, values in BOX.items():
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
def test_a_box_that_is_none_is_refused(wrong, said):
    with pytest.raises(ValueError, match=said):
        Limits.box(**(BOX | wrong))
