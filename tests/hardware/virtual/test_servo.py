"""Comparison of registers with the e-Manual."""

from collections.abc import Callable

import pytest

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import BROADCAST_ID, Fault, Instruction
from kinesic.hardware.protocol.registers import Mode, Register
from kinesic.hardware.virtual.control_table import TIME_PROFILE_BIT, TORQUE_BY_GOAL_BIT
from kinesic.hardware.virtual.firmware import BOOT_TIME

from .conftest import Line

Lines = Callable[..., Line]


def test_eeprom_is_locked_while_torque_is_on(line: Lines):
    one = line()
    assert one.set(Register.RETURN_DELAY_TIME, 10) == Fault.NONE
    assert one.set(Register.TORQUE_ENABLE, 1) == Fault.NONE
    assert one.set(Register.RETURN_DELAY_TIME, 0) == Fault.ACCESS
    assert one.get(Register.RETURN_DELAY_TIME) == 10
    assert one.set(Register.LED, 1) == Fault.NONE, "RAM is not"


@pytest.mark.parametrize(
    ("address", "data", "fault"),
    [
        (Register.MODEL_NUMBER.field.address, b"\0\0", Fault.ACCESS),
        (Register.PRESENT_POSITION.field.address, bytes(4), Fault.ACCESS),
        (66, b"\1", Fault.ACCESS),
        (5000, b"\1", Fault.ACCESS),
        (Register.GOAL_POSITION.field.address, bytes(2), Fault.LENGTH),
        (Register.GOAL_POSITION.field.address + 1, bytes(3), Fault.ACCESS),
        (Register.GOAL_POSITION.field.address, (4096).to_bytes(4, "little"), Fault.LIMIT),
        (Register.GOAL_PWM.field.address, (886).to_bytes(2, "little"), Fault.LIMIT),
        (Register.OPERATING_MODE.field.address, b"\2", Fault.RANGE),
        (Register.BAUD_RATE.field.address, b"\x08", Fault.RANGE),
        (Register.LED.field.address, b"\2", Fault.RANGE),
        (168, (63).to_bytes(2, "little"), Fault.RANGE),
    ],
)
def test_invalid_register_write_is_refused_without_changes(line: Lines, address: int, data: bytes, fault: Fault):
    one = line()
    before = one.servo.memory.read(0, 120)
    assert one.error(packet.write_packet(1, address, data)) == fault
    assert one.servo.memory.read(0, 120) == before


def test_goals_beyond_the_values_of_limit_registers_are_refused(line: Lines):
    one = line()
    one.set(Register.PWM_LIMIT, 500)
    one.set(Register.CURRENT_LIMIT, 300)
    one.set(Register.MIN_POSITION_LIMIT, 1000)
    one.set(Register.MAX_POSITION_LIMIT, 3000)
    for register, good, bad in (
        (Register.GOAL_PWM, -500, -501),
        (Register.GOAL_CURRENT, 300, 301),
        (Register.GOAL_POSITION, 1000, 999),
        (Register.GOAL_POSITION, 3000, 3001),
        (Register.GOAL_VELOCITY, 350, 351),
    ):
        assert one.set(register, good) == Fault.NONE
        assert one.set(register, bad) == Fault.LIMIT
        assert one.get(register) == good


def test_write_of_several_registers_succeeds_or_fails_as_a_whole(line: Lines):
    one = line()
    good = (7).to_bytes(4, "little")
    assert one.error(packet.write_packet(1, 108, good + good + (5000).to_bytes(4, "little"))) == Fault.LIMIT
    assert one.get(Register.PROFILE_VELOCITY) == 0
    assert one.error(packet.write_packet(1, 108, good + good + (3000).to_bytes(4, "little"))) == Fault.NONE
    assert one.get(Register.PROFILE_VELOCITY) == 7


@pytest.mark.parametrize(("level", "answers"), [(0, (1, 0, 0)), (1, (1, 1, 0)), (2, (1, 1, 1))])
def test_status_return_level_controls_replies(line: Lines, level: int, answers: tuple[int, int, int]):
    one = line()
    one.bytes(packet.write_packet(1, Register.STATUS_RETURN_LEVEL.field.address, bytes((level,))))
    asked = (packet.ping(1), packet.read_packet(1, 132, 4), packet.write_packet(1, 65, b"\1"))
    assert tuple(len(one.ask(data)) for data in asked) == answers
    assert one.servo.memory[Register.LED] == 1, "it obeys all the same"


def test_servo_reply_is_delayed_by_the_return_delay_time(line: Lines):
    slow, quick = line(return_delay=250), line()
    waits = []
    for one in (slow, quick):
        one.wire.write(packet.ping(1))
        one.wire.read(1.0)
        waits.append(one.wire.now())
    assert waits[0] - waits[1] == pytest.approx(500e-6)


def test_unknown_servo_instruction_causes_an_error_reply(line: Lines):
    assert line().error(packet.packet(1, 0x77)) == Fault.INSTRUCTION


def test_broadcast_instruction_is_executed_without_a_reply(line: Lines):
    two = line(1, 2)
    assert two.ask(packet.write_packet(BROADCAST_ID, Register.TORQUE_ENABLE.field.address, b"\1")) == []
    assert [servo.memory[Register.TORQUE_ENABLE] for servo in two.plant.servos] == [1, 1]


@pytest.mark.parametrize(("option", "servo", "baud"), [(0xFF, 1, 57_600), (1, 7, 57_600), (2, 7, 1_000_000)])
def test_factory_reset_option_determines_whether_id_and_baud_rate_are_kept(
    line: Lines, option: int, servo: int, baud: int
):
    one = line(7)
    one.set(Register.HOMING_OFFSET, 100, servo=7)
    assert one.error(packet.packet(7, Instruction.FACTORY_RESET, bytes((option,)))) == Fault.NONE
    one.pass_time(BOOT_TIME)
    assert (one.servo.id, one.servo.baud) == (servo, baud)
    assert one.servo.memory[Register.HOMING_OFFSET] == 0
    assert one.servo.memory[Register.RETURN_DELAY_TIME] == 250
    one.bus.baud = baud
    assert one.bytes(packet.ping(servo), wait=0.02), "it answers under its new id at its new baud rate"


def test_broadcast_factory_reset_of_everything_is_ignored(line: Lines):
    two = line(1, 2)
    two.bytes(packet.packet(BROADCAST_ID, Instruction.FACTORY_RESET, b"\xff"))
    assert [servo.id for servo in two.plant.servos] == [1, 2]


def test_operating_mode_change_of_a_virtual_servo_resets_gains_profile_and_pwm_goal(line: Lines):
    one = line()
    one.set(Register.POSITION_P_GAIN, 100)
    one.set(Register.PROFILE_VELOCITY, 100)
    one.set(Register.GOAL_PWM, 100)
    one.set(Register.OPERATING_MODE, Mode.EXTENDED_POSITION.value)
    assert one.get(Register.POSITION_P_GAIN) == 800
    assert one.get(Register.PROFILE_VELOCITY) == 0
    assert one.get(Register.GOAL_PWM) == 885


def test_goal_position_enables_torque_in_the_torque_by_goal_drive_mode(line: Lines):
    one = line()
    one.set(Register.DRIVE_MODE, TORQUE_BY_GOAL_BIT)
    one.set(Register.GOAL_POSITION, 2100)
    assert one.get(Register.TORQUE_ENABLE) == 1
    assert line(firmware=44).set(Register.DRIVE_MODE, TORQUE_BY_GOAL_BIT) == Fault.RANGE
    assert line(firmware=41).set(Register.DRIVE_MODE, TIME_PROFILE_BIT) == Fault.RANGE
    assert line(model="xl330_m288", firmware=41).set(Register.DRIVE_MODE, TIME_PROFILE_BIT) == Fault.NONE
