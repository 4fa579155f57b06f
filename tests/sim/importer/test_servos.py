from dataclasses import replace
from math import pi

import numpy as np
import pytest
from msgspec.structs import asdict

from kinesic.body.servo import Drive, ServoModel
from kinesic.sim.importer.model_tree import BASE_INDEX, Joint
from kinesic.sim.importer.servos import servo

UNKNOWN_JOINT = Joint(
    "j", BASE_INDEX, np.zeros(3), np.array([0.0, 0, 1]), 0.0, None, None, None, None, None, None, None, None
)


def drive(table):
    return Drive(ServoModel(name="s", **asdict(table)), 1, 1.0)


def test_unknown_motor_holds_the_worst_posture_with_35_percent_of_its_stall_torque():
    table, why = servo(UNKNOWN_JOINT, gravity=7.0, inertia=0.01)
    assert 7.0 / table.stall_nm == pytest.approx(0.35, rel=1e-4)
    assert why.startswith("stall assumed")
    assert "speed assumed; gain assumed" in why


def test_unloaded_hinge_gets_torque_for_its_acceleration():
    table, _ = servo(UNKNOWN_JOINT, gravity=0.0, inertia=0.2)
    assert 0.35 * table.stall_nm / 0.2 == pytest.approx(25.0, rel=1e-4)


def test_motor_data_of_an_imported_file_are_kept():
    result = replace(UNKNOWN_JOINT, effort=30.0, speed=3.2, gain=120.0, armature=0.05, friction=0.4, damping=0.3)
    table, why = servo(result, gravity=5.0, inertia=0.1)
    assert table.stall_nm == 30.0
    assert (table.armature, table.frictionloss, table.damping) == (0.05, 0.4, 0.3)
    assert drive(table).gain * 30.0 == pytest.approx(120.0, rel=1e-3)
    assert "stall: the file's effort; speed: the file's limit; gain: the file's" in why
    assert why.endswith("armature, friction, damping: the file's")


def test_velocity_limit_of_an_imported_joint_is_80_percent_of_its_no_load_velocity():
    table, _ = servo(replace(UNKNOWN_JOINT, effort=30.0, speed=3.2), gravity=5.0, inertia=0.1)
    assert 0.8 * drive(table).no_load == pytest.approx(3.2, rel=1e-3)


def test_damping_of_a_position_actuator_counts_as_back_emf():
    table, why = servo(replace(UNKNOWN_JOINT, effort=5.0, gain=21.1, damping=1.084), gravity=1.0, inertia=0.01)
    assert table.no_load_rpm * 2 * pi / 60 == pytest.approx(5 / 1.084, rel=1e-3)
    assert "back-EMF" in why


@pytest.mark.parametrize(
    ("effort", "stall", "why"), [(6.0, 14.474, "stall raised"), (50000.0, 15.714, "stall assumed: the file's 50000")]
)
def test_implausible_torque_limits_of_an_imported_file_are_replaced(effort, stall, why):
    table, said = servo(replace(UNKNOWN_JOINT, effort=effort), gravity=5.5, inertia=0.01)
    assert table.stall_nm == pytest.approx(stall, rel=1e-3)
    assert said.startswith(why)


def test_implausible_velocity_limit_of_an_imported_file_is_ignored():
    _, why = servo(replace(UNKNOWN_JOINT, effort=30.0, speed=100.0), gravity=5.0, inertia=0.1)
    assert "speed assumed" in why
