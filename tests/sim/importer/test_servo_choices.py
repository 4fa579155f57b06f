"""Stall torque, velocity, gain and losses chosen for synthetic motor data."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from kinesic.sim.importer.model_tree import BASE_INDEX, Joint
from kinesic.sim.importer.servos import _choose_no_load, _choose_p_gain, _choose_stall, _round, servo

UNKNOWN_MOTOR = Joint(
    "j", BASE_INDEX, np.zeros(3), np.array([0.0, 0, 1]), 0.0, None, None, None, None, None, None, None, None
)
STALL_ASSUMED_NOTE = "stall assumed: holds the worst posture with a third"
STALL_RAISED_NOTE = "stall raised: the file's 10 Nm cannot hold the worst posture at ease"


@pytest.mark.parametrize(
    ("effort", "gravity", "inertia", "stall", "why"),
    [
        (None, 7.0, 0.0, 20.0, STALL_ASSUMED_NOTE),
        (None, 0.0, 0.7, 50.0, STALL_ASSUMED_NOTE),
        (None, 14.0, 0.14, 40.0, STALL_ASSUMED_NOTE),
        (1000.0, 7.0, 0.0, 1000.0, "stall: the file's effort"),
        (1001.0, 7.0, 0.0, 20.0, "stall assumed: the file's 1001 Nm is no limit"),
        (10.0, 3.8, 9.0, 10.0, "stall: the file's effort"),
        (10.0, 3.9, 9.0, 3.9 / 0.38, STALL_RAISED_NOTE),
    ],
)
def test_stall_torque_holds_the_worst_posture_and_accelerates_the_arm(effort, gravity, inertia, stall, why):
    assert _choose_stall(effort, gravity, inertia) == (pytest.approx(stall), why)


BACK_EMF_NOTE = "speed: from the file's damping, taken as back-EMF"
VELOCITY_LIMIT_NOTE = "speed: the file's limit"


@pytest.mark.parametrize(
    ("gain", "damping", "speed", "no_load", "why"),
    [
        (9.0, 2.0, 4.0, 5.0, BACK_EMF_NOTE),
        (9.0, 10 / 11.9, 4.0, 11.9, BACK_EMF_NOTE),
        (9.0, 10 / 12.0, 4.0, 5.0, VELOCITY_LIMIT_NOTE),
        (9.0, 25.0, 4.0, 5.0, VELOCITY_LIMIT_NOTE),
        (9.0, 24.0, 4.0, 10 / 24, BACK_EMF_NOTE),
        (None, 2.0, 4.0, 5.0, VELOCITY_LIMIT_NOTE),
        (9.0, None, 4.0, 5.0, VELOCITY_LIMIT_NOTE),
        (None, None, None, 8.0, "speed assumed"),
        (None, None, 50.1, 8.0, "speed assumed"),
        (None, None, 50.0, 12.0, f"{VELOCITY_LIMIT_NOTE}, capped"),
        (None, None, 9.6, 12.0, VELOCITY_LIMIT_NOTE),
        (None, None, 9.7, 12.0, f"{VELOCITY_LIMIT_NOTE}, capped"),
        (None, None, 0.1, 0.4, VELOCITY_LIMIT_NOTE),
    ],
)
def test_no_load_velocity_comes_from_damping_or_limit_within_plausible_bounds(gain, damping, speed, no_load, why):
    joint = replace(UNKNOWN_MOTOR, gain=gain, damping=damping, speed=speed)
    assert _choose_no_load(joint, 10.0) == (pytest.approx(no_load), why)


@pytest.mark.parametrize(
    ("gain", "kept"), [(None, False), (19.9, False), (20.0, True), (100.0, True), (300.0, True), (301.0, False)]
)
def test_gain_of_an_imported_file_is_kept_if_full_duty_is_reached_at_a_plausible_angle(gain, kept):
    # The register of 128 is a gain of 1 PWM unit per tick: 885 units are the stall torque, 4096 ticks a turn.
    register = 128.0 * (gain / 10.0) * 885.0 * 2 * pi / 4096 if kept else 800.0
    why = "gain: the file's" if kept else "gain assumed"
    assert _choose_p_gain(gain, 10.0) == (pytest.approx(register), why)


def test_servo_values_are_rounded_to_five_significant_digits():
    assert (_round(1.234567), _round(123456.7), _round(0.00012345678)) == (1.2346, 123460.0, 0.00012346)


def test_unknown_losses_are_proportional_to_stall_torque_and_back_emf():
    table, why = servo(replace(UNKNOWN_MOTOR, effort=48.0, speed=8.0), gravity=1.0, inertia=0.1)
    assert (table.armature, table.frictionloss, table.damping) == pytest.approx((0.096, 0.96, 0.02 * 4.8))
    assert (table.volt, table.stall_nm, table.stall_a) == (48.0, 48.0, 10.0)
    assert table.no_load_rpm == pytest.approx(300 / pi, rel=1e-4)
    assert (table.model, table.gear, table.mass, table.size) == (0, 1.0, 0.0, (0.01, 0.01, 0.01))
    assert (table.p_gain, table.d_gain, table.kp_divisor) == (800.0, 0.0, 128.0)
    assert why == f"stall: the file's effort; {VELOCITY_LIMIT_NOTE}; gain assumed; inertia and friction assumed"


def test_friction_and_damping_of_the_file_are_bounded_but_its_armature_is_not():
    joint = replace(UNKNOWN_MOTOR, effort=48.0, speed=8.0, armature=9.0, friction=9.0, damping=9.0)
    table, why = servo(joint, gravity=1.0, inertia=0.1)
    assert (table.armature, table.frictionloss, table.damping) == pytest.approx((9.0, 4.8, 0.2 * 4.8))
    assert why.endswith("; armature, friction, damping: the file's")
    small, why = servo(replace(joint, armature=None, friction=0.3, damping=0.4), gravity=1.0, inertia=0.1)
    assert (small.armature, small.frictionloss, small.damping) == pytest.approx((0.096, 0.3, 0.4))
    assert why.endswith("; friction, damping: the file's")


def test_armature_of_the_file_adds_to_the_accelerated_inertia():
    table, _ = servo(replace(UNKNOWN_MOTOR, armature=0.5), gravity=0.0, inertia=0.2)
    assert table.stall_nm == pytest.approx(50.0)
