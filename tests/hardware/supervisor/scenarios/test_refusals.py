"""Refusals of the supervisor, one line each, without torque."""

from collections.abc import Callable

import pytest

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault

Make = Callable  # of a desk, see conftest
PERIOD = 0.01
TORQUE, GOAL, WATCHDOG = Register.TORQUE_ENABLE, Register.GOAL_POSITION, Register.BUS_WATCHDOG


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (PlannedFault("wrong_model", (3,)), "is a xl430_w250, must be a xc430_w240"),
        (PlannedFault("old_firmware", (3,), value=37), "firmware 37 has no bus watchdog"),
        (PlannedFault("duplicate_id", (3,)), "several servos have this id"),
        (PlannedFault("silent", (3,)), "no answer"),
        (PlannedFault("undervoltage", (3,), value=5.0), "supply is 5.0 V"),
        (PlannedFault("silent"), "no servo of ids"),
        (PlannedFault("alert", (3,), value=32), "has shut down (overload)"),
    ],
    ids=lambda value: value.kind if isinstance(value, PlannedFault) else None,
)
def test_wrong_servos_are_refused_in_one_line_and_no_servo_gets_torque(desk: Make, fault: PlannedFault, message: str):
    made = desk(faults=FaultPlan((fault,)))
    made.open()
    assert made.stage is Stage.CLOSED
    assert made.supervisor.done
    refused = [note.text for note in made.notes() if note.kind == "refused"]
    assert len(refused) == 1
    assert message in refused[0]
    assert "\n" not in refused[0]
    assert not made.true(TORQUE).any()


@pytest.mark.parametrize(
    ("register", "value", "message"),
    [
        (Register.MAX_POSITION_LIMIT, 2500, "its hinge needs"),
        (Register.MIN_POSITION_LIMIT, 2100, "its hinge needs"),
        (Register.VELOCITY_LIMIT, 10, "velocity limit"),
    ],
)
def test_servo_limits_too_low_for_the_joint_are_refused(desk: Make, register: Register, value: int, message: str):
    made = desk()
    made.plant.servos[2].memory[register] = value
    made.open()
    (refused,) = [note.text for note in made.notes() if note.kind == "refused"]
    assert message in refused
    assert "l_flexion" in refused
    assert not made.true(TORQUE).any()


def test_servo_positioned_outside_its_range_is_refused(desk: Make):
    made = desk()
    made.plant.physics.turn(2, 0.1)
    made.open()
    (refused,) = [note.text for note in made.notes() if note.kind == "refused"]
    assert "is at 65 ticks, outside 1894..3624" in refused


def test_servo_with_torque_in_another_mode_is_refused(desk: Make):
    made = desk()
    servo = made.plant.servos[2]
    servo.memory[Register.OPERATING_MODE] = 1
    servo.memory[TORQUE] = 1
    made.open()
    (refused,) = [note.text for note in made.notes() if note.kind == "refused"]
    assert "has torque, but other values of OPERATING_MODE" in refused
