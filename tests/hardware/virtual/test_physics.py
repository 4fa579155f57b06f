from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.robot import Robot
from kinesic.hardware.virtual.physics import NO_TORQUE, Demand, FirstOrder, Motor

MOTOR = Motor(no_load=8.0, gain=4.0)


def turned(demand: Demand, seconds: float, *, load: float = 0.0, steps: int = 1, angle: float = 0.0) -> FirstOrder:
    physics = FirstOrder([MOTOR], [angle])
    physics.loads[0] = load
    for _ in range(steps):
        physics.advance(seconds / steps, [demand])
    return physics


@given(st.floats(-3, 3), st.floats(0.001, 0.5), st.floats(0.05, 1.0), st.floats(-0.04, 0.04), st.integers(2, 20))
def test_motor_model_is_integrated_exactly(goal: float, seconds: float, cap: float, load: float, steps: int):
    demand = Demand("angle", goal, cap)
    once, often = (turned(demand, seconds, load=load, steps=count).shafts()[0] for count in (1, steps))
    assert often.angle == pytest.approx(once.angle, abs=1e-9)


def test_first_order_motor_model_reaches_its_goal_without_overshoot():
    physics = FirstOrder([MOTOR], [0.0])
    before = 0.0
    for _ in range(300):
        physics.advance(0.01, [Demand("angle", 2.0)])
        here = physics.shafts()[0].angle
        assert before <= here <= 2.0
        before = here
    assert before == pytest.approx(2.0, abs=1e-9)


def test_shaft_velocity_is_limited_by_motor_and_duty_cap():
    assert turned(Demand("angle", 9.0), 0.1).shafts()[0].speed == pytest.approx(8.0)
    assert turned(Demand("angle", 9.0, 0.25), 0.1).shafts()[0].speed == pytest.approx(2.0)


def test_external_load_causes_a_position_error_of_the_motor():
    held = turned(Demand("angle", 1.0), 5.0, load=0.2).shafts()[0]
    assert held.angle == pytest.approx(1.0 - 0.2 / 4.0)
    assert held.duty == pytest.approx(0.2)
    assert held.load == 0.2


def test_shaft_without_torque_keeps_its_angle_and_a_jammed_shaft_has_full_load():
    assert turned(NO_TORQUE, 1.0, load=0.5, angle=0.7).shafts()[0].angle == 0.7
    physics = FirstOrder([MOTOR], [0.0])
    physics.jammed[0] = True
    physics.advance(0.1, [Demand("angle", 1.0)])
    assert physics.shafts()[0] == (0.0, 0.0, 1.0, 1.0)


def test_motor_follows_velocity_current_and_duty_commands():
    assert turned(Demand("speed", 3.0), 0.5).shafts()[0].angle == pytest.approx(1.5)
    assert turned(Demand("duty", -0.5), 0.5).shafts()[0].angle == pytest.approx(-2.0)
    jammed = FirstOrder([MOTOR], [0.0])
    jammed.jammed[0] = True
    jammed.advance(0.1, [Demand("current", 0.3)])
    assert jammed.shafts()[0].load == pytest.approx(0.3)


def test_motor_velocity_and_gain_come_from_the_servo_of_the_drive():
    drive = Robot.load().drives[0]
    motor = Motor.of(drive.servo)
    assert motor.no_load == pytest.approx(drive.servo.no_load_rpm * pi / 30)
    assert motor.gain == pytest.approx(drive.gain / drive.reduction)


def test_motor_simulation_refuses_more_start_angles_than_motors():
    with pytest.raises(ValueError, match="2 angles for 1 motors"):
        FirstOrder([MOTOR], [0.0, 0.0])
