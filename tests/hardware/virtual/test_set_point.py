"""Reported set point of a servo, and its profile to a goal."""

from collections.abc import Callable
from math import inf, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.packet import Fault, Instruction
from kinesic.hardware.protocol.registers import Mode, Register
from kinesic.hardware.virtual.control_table import REVERSE_BIT, TIME_PROFILE_BIT
from kinesic.hardware.virtual.set_point import Profile, still_profile, time_profile, velocity_profile

from .conftest import Line

SHAFT_ANGLES = st.floats(-6.0, 6.0)  # [rad] angles of a shaft
Lines = Callable[..., Line]


def sampled(profile: Profile) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    times = np.linspace(0.0, profile.duration, 2001)
    places, speeds = np.transpose([profile.at(time) for time in times])
    return times, places, speeds


def test_servo_profile_shape_depends_on_limits_and_distance():
    assert velocity_profile(0.0, 0.0, 1.0, limit=inf, acceleration=1.0).form == "step"
    assert velocity_profile(0.0, 0.0, 1.0, limit=2.0, acceleration=inf).form == "rectangle"
    assert velocity_profile(0.0, 0.0, 1.0, limit=2.0, acceleration=1.0).form == "triangle"
    assert velocity_profile(0.0, 0.0, 9.0, limit=2.0, acceleration=1.0).form == "trapezoid"
    assert time_profile(0.0, 1.0, duration=1.0, rise=0.0).form == "rectangle"
    assert time_profile(0.0, 1.0, duration=1.0, rise=0.7).form == "triangle"
    assert time_profile(0.0, 1.0, duration=1.0, rise=0.2).form == "trapezoid"
    assert time_profile(0.0, 1.0, duration=0.0, rise=0.2).form == "step"


def test_durations_of_servo_profiles_match_closed_form_expressions():
    assert velocity_profile(0.0, 0.0, 9.0, limit=2.0, acceleration=1.0).duration == pytest.approx(9 / 2 + 2 / 1)
    assert velocity_profile(0.0, 0.0, 1.0, limit=2.0, acceleration=1.0).duration == pytest.approx(2 * sqrt(1.0))
    assert velocity_profile(0.0, 0.0, -3.0, limit=2.0, acceleration=inf).duration == 1.5
    assert time_profile(0.0, 5.0, duration=1.25, rise=0.3).duration == 1.25


def test_servo_profile_of_kind_step_reaches_its_goal_immediately():
    assert velocity_profile(0.0, 0.0, 1.0, limit=inf, acceleration=1.0).at(0.0) == (1.0, 0.0)
    assert still_profile(0.3).at(0.0) == (0.3, 0.0)


@given(SHAFT_ANGLES, st.floats(-3.0, 3.0), SHAFT_ANGLES, st.floats(0.1, 5.0), st.floats(0.5, 50.0))
def test_servo_profile_keeps_velocity_and_acceleration_limits_and_reaches_its_goal(
    start: float, speed: float, goal: float, limit: float, acceleration: float
):
    profile = velocity_profile(start, speed, goal, limit=limit, acceleration=acceleration)
    times, places, speeds = sampled(profile)
    assert places[0] == pytest.approx(start, abs=1e-9)
    assert places[-1] == pytest.approx(goal, abs=1e-6)
    assert np.abs(speeds).max() <= max(limit, abs(speed)) + 1e-9
    if profile.duration > 1e-3:
        assert np.abs(np.diff(speeds) / np.diff(times)).max() <= acceleration * (1 + 1e-6) + 1e-6
        assert np.abs(np.diff(places) / np.diff(times)).max() <= max(limit, abs(speed)) + 1e-6


@given(SHAFT_ANGLES, SHAFT_ANGLES, st.floats(0.05, 5.0), st.floats(0.0, 5.0))
def test_time_based_servo_profile_takes_the_requested_duration(start: float, goal: float, duration: float, rise: float):
    profile = time_profile(start, goal, duration=duration, rise=rise)
    assert profile.duration == pytest.approx(duration)
    _, places, _ = sampled(profile)
    assert places[-1] == goal
    assert (np.diff(places) * np.sign(goal - start) >= -1e-9).all()
    assert places[1000] == pytest.approx((start + goal) / 2, abs=1e-6)


def test_torque_on_discards_whole_turns_in_position_mode_but_not_in_extended_position_mode(line: Lines):
    one = line()
    turn = 4096 * Register.PRESENT_POSITION.field.scale
    one.plant.physics.turn(0, 1.5 * turn)
    one.pass_time(0.02)
    assert one.get(Register.PRESENT_POSITION) == 6144, "limp, it counts on"
    one.set(Register.TORQUE_ENABLE, 1)
    assert one.get(Register.PRESENT_POSITION) == 2048
    other = line(latches_goal=True)
    other.set(Register.OPERATING_MODE, Mode.EXTENDED_POSITION.value)
    other.plant.physics.turn(0, 1.5 * turn)
    other.set(Register.TORQUE_ENABLE, 1)
    assert other.get(Register.PRESENT_POSITION) == 6144
    assert other.set(Register.GOAL_POSITION, -5000) == Fault.NONE
    assert other.set(Register.GOAL_POSITION, 1_048_576) == Fault.RANGE


def test_clear_instruction_resets_the_turn_count_only_at_standstill(line: Lines):
    one = line()
    one.set(Register.OPERATING_MODE, Mode.EXTENDED_POSITION.value)
    one.set(Register.TORQUE_ENABLE, 1)
    one.set(Register.GOAL_POSITION, 2048 + 4096)
    clear = packet.packet(1, Instruction.CLEAR, bytes.fromhex("01 44 58 4C 22"))
    assert clear == bytes.fromhex("FF FF FD 00 01 08 00 10 01 44 58 4C 22 B1 DC"), "as the manual prints it"
    assert one.error(clear) == Fault.RESULT
    one.pass_time(3.0)
    assert one.error(clear) == Fault.NONE
    assert one.get(Register.PRESENT_POSITION) == pytest.approx(2048, abs=1)


def test_homing_offset_above_1024_is_ignored_in_position_mode(line: Lines):
    one = line()
    one.set(Register.HOMING_OFFSET, 100)
    assert one.get(Register.PRESENT_POSITION) == 2148
    one.set(Register.HOMING_OFFSET, 1025)
    assert one.get(Register.PRESENT_POSITION) == 2048
    one.set(Register.OPERATING_MODE, Mode.EXTENDED_POSITION.value)
    assert one.get(Register.PRESENT_POSITION) == 2048 + 1025


def test_reverse_mode_of_a_servo_inverts_rotation_but_not_the_homing_offset(line: Lines):
    one = line(ticks=1000)
    one.set(Register.DRIVE_MODE, REVERSE_BIT)
    assert one.get(Register.PRESENT_POSITION) == 3096
    one.set(Register.HOMING_OFFSET, 50)
    assert one.get(Register.PRESENT_POSITION) == 3146
    one.set(Register.TORQUE_ENABLE, 1)
    one.set(Register.GOAL_POSITION, 3246)
    one.pass_time(1.0)
    assert one.get(Register.PRESENT_POSITION) == 3246
    assert one.servo.electronics.shaft.angle == pytest.approx(900 * Register.PRESENT_POSITION.field.scale, abs=1e-3)


def test_outdated_goal_causes_a_jump_at_torque_on_unless_the_firmware_resets_the_goal(line: Lines):
    for latches, ended in ((False, 1000), (True, 2048)):
        one = line(latches_goal=latches)
        one.set(Register.GOAL_POSITION, 1000)
        one.set(Register.TORQUE_ENABLE, 1)
        one.pass_time(1.0)
        assert one.get(Register.PRESENT_POSITION) == ended


@pytest.mark.parametrize("name", sorted(name for name, model in SERVO_MODELS.items() if model.table is None))
def test_virtual_servo_of_every_model_answers_with_its_model_number_and_moves(line: Lines, name: str):
    one = line(model=name)
    (status,) = one.ask(packet.ping(1))
    assert int.from_bytes(status.data[:2], "little") == SERVO_MODELS[name].number
    one.set(Register.TORQUE_ENABLE, 1)
    one.set(Register.GOAL_POSITION, 1500)
    one.pass_time(1.0)
    assert one.get(Register.PRESENT_POSITION) == 1500
    assert one.get(Register.MOVING) == 0
    assert one.get(Register.MOVING_STATUS) & 1, "in position"


def watched(one: Line, seconds: float, step: float = 0.01) -> tuple[np.ndarray, np.ndarray]:
    """Return set point (k,) [ticks] and velocity (k,) [counts] of every step."""
    places, speeds = [], []
    for _ in range(round(seconds / step)):
        one.bus.advance(one.plant.time + step)
        one.servo.electronics.show()
        places.append(one.servo.memory[Register.POSITION_TRAJECTORY])
        speeds.append(one.servo.memory[Register.VELOCITY_TRAJECTORY])
    return np.array(places), np.array(speeds)


def profiled(line: Lines, *, mode: int, acceleration: int, velocity: int, goal: int) -> Line:
    one = line()
    one.set(Register.DRIVE_MODE, mode)
    one.set(Register.TORQUE_ENABLE, 1)
    one.set(Register.PROFILE_ACCELERATION, acceleration)
    one.set(Register.PROFILE_VELOCITY, velocity)
    one.set(Register.GOAL_POSITION, goal)
    return one


def test_velocity_based_profile_has_the_configured_velocity_and_acceleration(line: Lines):
    """100 counts are 22.9 rpm (a quarter turn in 0.66 s); 10 counts are 2145.77 rev/min^2."""
    one = profiled(line, mode=0, acceleration=10, velocity=100, goal=3072)
    places, speeds = watched(one, 1.5)
    assert places[-1] == 3072
    assert speeds.max() == 100
    assert speeds[-1] == 0
    rise = 22.9 / 2145.77 * 60  # [s] until it is at full speed
    assert np.diff(speeds).max() <= 0.01 / rise * 100 + 1
    ended = 0.01 * np.flatnonzero(places == 3072)[0]
    assert ended == pytest.approx(1024 / 4096 / (22.9 / 60) + rise, abs=0.03)


def test_time_based_profile_takes_the_requested_time(line: Lines):
    one = profiled(line, mode=TIME_PROFILE_BIT, acceleration=200, velocity=1000, goal=1048)
    places, speeds = watched(one, 1.2)
    assert places[50] == pytest.approx(1548, abs=15)
    assert 0.97 <= 0.01 * (np.flatnonzero(places == 1048)[0] + 1) <= 1.01
    assert speeds.min() == pytest.approx(-1000 / 4096 / 0.8 * 60 / 0.229, abs=1)


def test_moving_registers_show_profile_state(line: Lines):
    one = profiled(line, mode=0, acceleration=10, velocity=50, goal=3072)
    assert one.get(Register.MOVING) == 1
    assert one.get(Register.MOVING_STATUS) == 0b110010, "a trapezoid, going on, not there, following"
    one.plant.physics.jammed[0] = True
    one.pass_time(0.9)
    assert one.get(Register.MOVING_STATUS) & 0b1000, "it does not follow"
    one.plant.physics.jammed[0] = False
    one.pass_time(4.0)
    assert (one.get(Register.MOVING), one.get(Register.MOVING_STATUS)) == (0, 1)


def test_new_goal_reverses_a_moving_profile_without_a_velocity_jump(line: Lines):
    one = profiled(line, mode=0, acceleration=5, velocity=100, goal=4000)
    watched(one, 0.5)
    one.set(Register.GOAL_POSITION, 2048)
    places, speeds = watched(one, 4.0)
    assert np.abs(np.diff(speeds)).max() <= 5
    assert places[0] < places.max() <= 4000
    assert places[-1] == 2048


def test_servo_in_velocity_mode_accelerates_evenly_to_its_goal_velocity(line: Lines):
    one = line()
    one.set(Register.OPERATING_MODE, Mode.VELOCITY.value)
    one.set(Register.TORQUE_ENABLE, 1)
    one.set(Register.PROFILE_ACCELERATION, 1)
    one.set(Register.GOAL_VELOCITY, 100)
    one.pass_time(22.9 / 214.577 * 60 / 2 - 0.02)
    assert one.get(Register.PRESENT_VELOCITY) == pytest.approx(50, abs=2)
    one.pass_time(10.0)
    assert one.get(Register.PRESENT_VELOCITY) == 100
    assert one.get(Register.PRESENT_POSITION) > 4096, "it turns and turns"


def test_pwm_goal_of_a_servo_limits_the_velocity_of_its_motion(line: Lines):
    one = line()
    one.set(Register.TORQUE_ENABLE, 1)
    one.set(Register.GOAL_PWM, 88)
    one.set(Register.GOAL_POSITION, 4000)
    one.pass_time(0.2)
    assert one.get(Register.PRESENT_PWM) == 88
    assert one.get(Register.PRESENT_VELOCITY) * 0.229 / 60 * 2 * np.pi == pytest.approx(8.0 * 88 / 885, rel=0.05)


def test_current_mode_applies_the_goal_current_to_a_jammed_shaft(line: Lines):
    one = line()
    one.set(Register.OPERATING_MODE, Mode.CURRENT.value)
    one.set(Register.TORQUE_ENABLE, 1)
    one.plant.physics.jammed[0] = True
    one.set(Register.GOAL_CURRENT, -400)
    one.pass_time(0.1)
    assert one.get(Register.PRESENT_CURRENT) == -400
