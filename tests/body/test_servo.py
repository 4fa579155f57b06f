from dataclasses import replace
from math import pi

import numpy as np
import pytest

from kinesic.body.robot_file import servo_models
from kinesic.body.servo import Drive, Drives, tracking_lags


@pytest.fixture(scope="module")
def xm540() -> Drive:
    return Drive(servo_models()["xm540_w270"], count=1, reduction=1.0)


def test_stiffness_and_back_emf_of_the_xm540_match_the_data_sheet(xm540: Drive):
    """Expect 10.6 Nm x 4.60 duty/rad, and 10.6 Nm over 30 rpm."""
    assert xm540.gain * xm540.stall == pytest.approx(48.8, abs=0.05)
    assert xm540.stall / xm540.no_load == pytest.approx(3.37, abs=0.005)


@pytest.mark.parametrize(
    ("name", "lag_ms"),
    [("xm540_w270", 69.1), ("xm540_w150", 39.1), ("xm430_w210", 26.9), ("xc430_w240", 33.9), ("xc330_t288", 26.0)],
)
def test_tracking_lags_of_servo_models_at_constant_velocity_have_the_expected_values(name: str, lag_ms: float):
    """Expect a lag of 1 / (gain * no-load velocity)."""
    drive = Drive(servo_models()[name], count=1, reduction=1.0)
    assert 1000 / (drive.gain * drive.no_load) == pytest.approx(lag_ms, abs=0.1)


def test_two_servos_on_one_joint_double_torque_and_inertia_but_not_velocity(xm540: Drive):
    pair = Drive(xm540.servo, count=2, reduction=1.0)
    assert (pair.stall, pair.armature) == (2 * xm540.stall, 2 * xm540.armature)
    assert (pair.frictionloss, pair.damping) == (2 * xm540.frictionloss, 2 * xm540.damping)
    assert (pair.no_load, pair.gain) == (xm540.no_load, xm540.gain)


def test_belt_reduction_trades_velocity_for_torque(xm540: Drive):
    belt = Drive(xm540.servo, count=1, reduction=2.5)
    assert belt.stall == pytest.approx(26.5)
    assert belt.no_load == pytest.approx(pi / 2.5)
    assert belt.stall * belt.no_load == pytest.approx(xm540.stall * xm540.no_load)
    assert belt.armature == pytest.approx(0.10 * 6.25)
    assert belt.gain == pytest.approx(2.5 * xm540.gain)
    assert belt.tick == pytest.approx(xm540.tick / 2.5)
    assert 1 / (belt.gain * belt.no_load) == pytest.approx(1 / (xm540.gain * xm540.no_load))


def test_position_tick_of_a_servo_is_a_4096th_of_a_turn(xm540: Drive):
    assert xm540.tick * 4096 == pytest.approx(2 * pi)


def test_factory_setting_of_the_servo_d_gain_adds_no_damping(xm540: Drive):
    assert xm540.servo.d_gain == 0
    assert xm540.rate_gain == 0.0


@pytest.mark.parametrize("name", servo_models())
def test_servo_models_have_physically_plausible_voltage_power_friction_and_size(name: str):
    model, file = servo_models()[name], "edit kinesic/configs/servos.toml"
    assert 3.0 <= model.volt <= 30.0, file  # 5 V, 12 V and 24 V models of the X series
    mechanical = model.stall_nm * model.no_load_rpm * 2 * pi / 60 / 4  # [W] at half speed
    assert 0.1 < mechanical / (model.volt * model.stall_a) < 0.5, file
    assert 0 < model.frictionloss < 0.1 * model.stall_nm, file
    assert all(0.01 < side < 0.1 for side in model.size), file


def test_rate_gain_is_d_divided_by_16_pwm_counts_per_tick_of_change_per_millisecond(xm540: Drive):
    """Expect D / 16 PWM counts per tick of change in 1 ms."""
    damped = replace(xm540, servo=replace(xm540.servo, d_gain=1600.0))
    ticks = 4096 / (2 * pi) / 1000  # in a millisecond at 1 rad/s
    assert damped.rate_gain == pytest.approx(damped.stall * 100 * ticks / 885)
    assert replace(damped, reduction=2.5).rate_gain == pytest.approx(6.25 * damped.rate_gain)


def test_belt_reduction_increases_friction_and_reduces_velocity(xm540: Drive):
    rubbing = replace(xm540, servo=replace(xm540.servo, damping=0.2, frictionloss=0.3))
    belt = replace(rubbing, reduction=3.0)
    assert (belt.damping, belt.frictionloss) == pytest.approx((9 * rubbing.damping, 3 * rubbing.frictionloss))
    assert rubbing.damping == 0.2
    assert belt.speed == pytest.approx(0.8 * xm540.no_load / 3.0)


def test_lag_feedforward_gives_zero_torque_at_constant_velocity(xm540: Drive):
    damped = replace(xm540, servo=replace(xm540.servo, d_gain=1600.0), reduction=2.5)
    drives, speeds = Drives((xm540, damped)), np.array([[0.5, -0.3]])
    lags = tracking_lags(drives)
    duties = drives.demanded_duties(lags * speeds, speeds)
    np.testing.assert_allclose(drives.torque_ratios(duties, speeds, np.ones(1)), 0.0, atol=1e-12)
    assert lags[1] > lags[0] > 0.01
    weak = drives.torque_ratios(np.ones((1, 2)), np.zeros((1, 2)), np.array([0.5]))
    np.testing.assert_array_equal(weak, 0.5)


def test_drive_properties_are_arrays_in_joint_order(xm540: Drive):
    pair = replace(xm540, count=2)
    drives = Drives((xm540, pair))
    assert drives.stall.tolist() == [xm540.stall, pair.stall]
    assert drives.servo_current.tolist() == [xm540.servo.stall_a] * 2
    assert drives.stall_current.tolist() == [xm540.servo.stall_a, 2 * xm540.servo.stall_a]
    assert drives.idle_current.tolist() == [xm540.servo.idle_a, 2 * xm540.servo.idle_a]
    assert drives.volt.tolist() == [xm540.servo.volt] * 2
