from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import VELOCITY_UNIT, Register
from kinesic.hardware.supervisor.manifest import GOAL_MARGIN, Manifest, describe_raised_joints


def test_manifest_lists_servos_bus_by_bus(robot: Robot):
    manifest = Manifest.of(robot)
    assert [(m.bus, m.id, m.hinge) for m in manifest.members] == [
        ("left", 1, "torsion"),
        ("left", 2, "torsion"),
        ("left", 3, "l_flexion"),
        ("left", 4, "l_twist"),
        ("right", 3, "r_flexion"),
    ]
    assert manifest.joints.tolist() == [0, 0, 1, 2, 3]
    assert manifest.bauds == {"left": 1_000_000, "right": 1_000_000}


def test_joint_angle_is_the_mean_of_its_tandem_servos_and_converts_back_to_their_ticks(robot: Robot):
    manifest = Manifest.of(robot)
    angles = np.array([0.3, 0.5, -0.7, 1.1])
    ticks = manifest.scale.ticks(angles[manifest.joints]).astype(float)
    assert manifest.angles(ticks) == pytest.approx(angles, abs=1e-3)
    ticks[0] += 20
    assert manifest.angles(ticks)[0] == pytest.approx(0.3 + 10 * 2 * np.pi / 4096, abs=1e-3)


def test_joint_angle_needs_the_position_of_at_least_one_tandem_servo(robot: Robot):
    manifest = Manifest.of(robot)
    ticks = np.full(5, 2048.0)
    ticks[[0, 2]] = np.nan
    assert np.isnan(manifest.angles(ticks)).tolist() == [False, True, False, False]


def test_joint_means_of_values_without_nan_are_the_same_with_and_without_the_search_for_nan(robot: Robot):
    manifest, values = Manifest.of(robot), np.array([3.0, 5.0, -1.0, 0.25, 7.0])
    np.testing.assert_allclose(manifest.means(values, whole=True), manifest.means(values), rtol=1e-12)


def test_joint_without_a_servo_has_no_angle(robot: Robot):
    whole = Manifest.of(robot)
    manifest = replace(whole, members=whole.members[:4])
    for is_whole in (False, True):
        assert np.isnan(manifest.angles(np.full(4, 2048.0), whole=is_whole)).tolist() == [False, False, False, True]


def test_joints_away_from_rest_and_joints_of_silent_servos_are_described(robot: Robot):
    manifest = Manifest.of(robot)
    rest = np.degrees(manifest.rest).round()
    offsets = np.radians([4.9, 30.0, -30.0, np.nan])
    assert describe_raised_joints(manifest, manifest.rest + offsets) == (
        f"l_flexion at {rest[1] + 30:.0f} deg (rest: {rest[1]:.0f})",
        f"l_twist at {rest[2] - 30:.0f} deg (rest: {rest[2]:.0f})",
        "r_flexion (silent)",
    )


def test_secondary_id_of_each_servo_is_set_to_an_inactive_value(robot: Robot):
    """ROBOTIS: a secondary id above 252 is inactive."""
    for member in Manifest.of(robot).members:
        assert 252 < member.eeprom_values[Register.SECONDARY_ID] < 256


def test_inverted_servo_has_mirrored_range(robot: Robot):
    twist = Manifest.of(robot).members[3]
    assert (twist.lower, twist.upper) == (2048 - 967, 2048 + 967)
    assert twist.span == (twist.lower - GOAL_MARGIN, twist.upper + GOAL_MARGIN)
    assert twist.turns == -1.0


def test_profile_velocity_is_the_no_load_velocity_up_to_its_factory_limit(robot: Robot):
    for member in Manifest.of(robot).members:
        pace = member.ram_values[Register.PROFILE_VELOCITY] * VELOCITY_UNIT
        assert 0.97 * member.speed <= pace <= member.model.factory_value(Register.VELOCITY_LIMIT) * VELOCITY_UNIT
        assert member.ram_values[Register.PROFILE_ACCELERATION] == 0


def test_default_robot_has_23_servos_and_all_joints_in_its_chains():
    manifest = Manifest.of(Robot.load())
    assert len(manifest.members) == 23
    assert manifest.chains[0] == frozenset({0, 1, 2})
    assert frozenset().union(*manifest.chains) == frozenset(range(22))


def test_robot_without_a_bus_is_refused(robot: Robot, tmp_path):
    path = tmp_path / "bare.toml"
    path.write_text(robot.path.read_text().split("[[bus]]")[0])
    with pytest.raises(ConfigError, match=r"no \[\[bus\]\]"):
        Manifest.of(Robot.load(path))


def test_servo_gets_gains_and_no_profile_acceleration(robot: Robot):
    for member in Manifest.of(robot).members:
        proportional, derivative, *_ = member.gains
        ram_values = member.ram_values
        assert (ram_values[Register.POSITION_P_GAIN], ram_values[Register.POSITION_D_GAIN]) == (
            proportional,
            derivative,
        )
        others = Register.POSITION_I_GAIN, Register.FEEDFORWARD_1ST_GAIN, Register.FEEDFORWARD_2ND_GAIN
        assert {ram_values[register] for register in (*others, Register.PROFILE_ACCELERATION)} == {0}
