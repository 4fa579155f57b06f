from dataclasses import replace

import msgspec
import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import (
    NOMINAL_FACTORS,
    PESSIMISTIC_FACTORS,
    DriveFactors,
    Factors,
    join_factors,
    read_twins,
)

ROBOT = Robot.load()


def test_nominal_and_pessimistic_servo_factors_have_the_documented_values():
    assert Factors(stall=1.0, no_load=1.0, friction=1.0, armature=1.0, mass=1.0) == NOMINAL_FACTORS
    assert Factors(stall=0.8, no_load=0.9, friction=1.5, armature=1.3, mass=1.1) == PESSIMISTIC_FACTORS


def test_pessimistic_servo_factors_scale_torque_velocity_friction_and_mass_but_not_gain():
    weak = PESSIMISTIC_FACTORS.applied(ROBOT)
    for changed, drive in zip(weak.drives, ROBOT.drives, strict=True):
        assert changed.stall == pytest.approx(0.8 * drive.stall)
        assert changed.no_load == pytest.approx(0.9 * drive.no_load)
        assert changed.frictionloss == pytest.approx(1.5 * drive.frictionloss)
        assert changed.damping == pytest.approx(1.5 * drive.damping)
        assert changed.armature == pytest.approx(1.3 * drive.armature)
        assert changed.servo.mass == pytest.approx(1.1 * drive.servo.mass)
        assert changed.gain == drive.gain
        assert changed.tick == drive.tick
    for changed_segment, segment in zip(weak.skeleton.segments, ROBOT.skeleton.segments, strict=True):
        assert changed_segment.mass == pytest.approx(1.1 * segment.mass)


def test_nominal_servo_factors_leave_drives_and_joint_ranges_unchanged():
    same = NOMINAL_FACTORS.applied(ROBOT)
    assert same.drives == ROBOT.drives
    assert np.array_equal(same.skeleton.lower, ROBOT.skeleton.lower)


def test_servo_factors_are_read_from_toml(tmp_path):
    path = tmp_path / "tired.toml"
    path.write_text("stall = 0.7\nmass = 1.2\n")
    assert Factors.read(path) == Factors(stall=0.7, mass=1.2)


@pytest.mark.parametrize("text", ["stal = 0.7", "stall = 0.0", "mass = -1.0", "mass = 'heavy'", "mass = nan"])
def test_invalid_servo_factors_are_rejected(tmp_path, text):
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"wrong\.toml"):
        Factors.read(path)


def test_error_of_a_servo_factor_of_zero_names_the_factor():
    with pytest.raises(ValueError, match="factor armature is 0"):
        Factors(armature=0.0)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("resistance = -0.1", "resistance is -0.1 ohm"),
        ("resistance = 5.0", r"must be in \[0, 5.0\)"),
        ("amps = 0.0", "factor amps is 0.0"),
    ],
)
def test_impossible_supply_values_in_a_factor_file_are_rejected(tmp_path, text, why):
    path = tmp_path / "weak.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=why):
        Factors.read(path)


def test_servo_factors_have_the_documented_names_and_neutral_defaults():
    figures = ("stall", "no_load", "friction", "armature", "gain")
    assert DriveFactors.__struct_fields__ == figures
    assert Factors.__struct_fields__ == (*figures, "mass", "supply", "resistance", "amps", "latency", "play", "servos")
    assert all(getattr(NOMINAL_FACTORS, name) == 1.0 for name in (*figures, "mass", "supply"))
    assert NOMINAL_FACTORS.latency == NOMINAL_FACTORS.play == 0.0
    assert NOMINAL_FACTORS.servos == {}


def test_gain_factor_scales_duty_per_error():
    for changed, drive in zip(Factors(gain=0.9).applied(ROBOT).drives, ROBOT.drives, strict=True):
        assert changed.gain == pytest.approx(0.9 * drive.gain)
        assert changed.stall == drive.stall


def test_torque_current_and_velocity_scale_with_supply_voltage():
    low = Factors(supply=11.1 / 12)
    for changed, drive in zip(low.applied(ROBOT).drives, ROBOT.drives, strict=True):
        assert changed.servo.volt == pytest.approx(11.1 / 12 * drive.servo.volt)
        for name in ("stall_nm", "stall_a", "no_load_rpm"):
            assert getattr(changed.servo, name) == pytest.approx(11.1 / 12 * getattr(drive.servo, name))
        winding, same = ((d.servo.volt / d.servo.stall_a, d.servo.volt / d.servo.no_load_rpm) for d in (changed, drive))
        assert winding == pytest.approx(same)


def test_factors_of_one_servo_model_replace_the_common_factors():
    some = Factors(stall=0.8, mass=1.1, servos={"xm430_w210": DriveFactors(friction=2.0)})
    for changed, drive in zip(some.applied(ROBOT).drives, ROBOT.drives, strict=True):
        own = drive.servo.name == "xm430_w210"
        assert changed.stall == pytest.approx((1.0 if own else 0.8) * drive.stall)
        assert changed.frictionloss == pytest.approx((2.0 if own else 1.0) * drive.frictionloss)
        assert changed.servo.mass == pytest.approx(1.1 * drive.servo.mass)


def test_factor_file_with_supply_latency_gain_and_servo_keys_is_read(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("supply = 0.95\nlatency = 0.004\ngain = 0.9\n[servos.xc430_w240]\nstall = 0.7\n")
    read = Factors.read(path)
    assert read == Factors(supply=0.95, latency=0.004, gain=0.9, servos={"xc430_w240": DriveFactors(stall=0.7)})
    assert hash(read) == hash(Factors.read(path)) != hash(NOMINAL_FACTORS)


def test_written_servo_factors_are_read_back_unchanged(tmp_path):
    own = {"xm540_w270": DriveFactors(gain=0.5), "a b": DriveFactors()}
    path = tmp_path / "own.toml"
    for factors in (NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors(mass=1.1, latency=0.01, amps=3.0, servos=own)):
        path.write_text(factors.text(), encoding="utf-8")
        assert Factors.read(path) == factors
    assert "stall" not in path.read_text(encoding="utf-8")


def test_factors_of_an_unknown_servo_are_rejected():
    with pytest.raises(ConfigError, match="xm430_w21: upper22 has none; did you mean xm430_w210"):
        Factors(servos={"xm430_w21": DriveFactors()}).applied(ROBOT)


def test_negative_servo_latency_is_rejected():
    with pytest.raises(ValueError, match=r"latency is -0\.001"):
        Factors(latency=-0.001)


@pytest.mark.parametrize("play", [-0.001, 0.5])
def test_implausible_servo_backlash_is_rejected(play):
    with pytest.raises(ValueError, match=f"play is {play} rad"):
        Factors(play=play)


def test_robot_with_applied_servo_factors_is_cached_per_robot():
    robot = Robot.load()
    assert PESSIMISTIC_FACTORS.applied(robot) is Factors(**msgspec.structs.asdict(PESSIMISTIC_FACTORS)).applied(robot)
    assert PESSIMISTIC_FACTORS.applied(replace(robot)) is not PESSIMISTIC_FACTORS.applied(robot)


def test_nominal_factors_return_the_robot_itself_and_equal_factors_the_same_object():
    assert NOMINAL_FACTORS.applied(ROBOT) is ROBOT
    assert PESSIMISTIC_FACTORS.applied(ROBOT) is PESSIMISTIC_FACTORS.applied(ROBOT)


@pytest.mark.parametrize("factors", [PESSIMISTIC_FACTORS, Factors(gain=0.9, servos={"a": DriveFactors(stall=0.5)})])
def test_joining_neutral_servo_factors_before_or_after_others_changes_nothing(factors):
    assert join_factors(factors, NOMINAL_FACTORS) == join_factors(NOMINAL_FACTORS, factors) == factors


def test_joined_factors_take_the_second_value_where_both_differ_from_neutral():
    first, second = Factors(stall=0.8, friction=1.5, latency=0.01), Factors(stall=0.7, mass=1.2)
    assert join_factors(first, second) == Factors(stall=0.7, friction=1.5, latency=0.01, mass=1.2)
    assert join_factors(second, first) == Factors(stall=0.8, friction=1.5, latency=0.01, mass=1.2)


def test_twin_factors_are_read_by_name_or_from_a_file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("stall = 0.7\n")
    assert read_twins("nominal") == (NOMINAL_FACTORS,)
    assert read_twins("pessimistic") == (PESSIMISTIC_FACTORS,)
    assert read_twins("both") == (NOMINAL_FACTORS, PESSIMISTIC_FACTORS)
    assert read_twins(str(path)) == (Factors(stall=0.7),)
    with pytest.raises(ConfigError, match="absent"):
        read_twins(str(tmp_path / "absent.toml"))
