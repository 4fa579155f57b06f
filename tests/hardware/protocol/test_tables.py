"""Conversion between registers of the X series and those of other families."""

import pytest

from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import TICK_ANGLE, VELOCITY_UNIT, Register
from kinesic.hardware.protocol.tables import AX_TABLE, FAMILY_TABLES, MX_TABLE, SCS_TABLE, STS_TABLE

from ...naming import about


@pytest.mark.parametrize(
    ("table", "register", "value", "data"),
    [
        (STS_TABLE, Register.GOAL_POSITION, 2048, "00 08"),
        (STS_TABLE, Register.PRESENT_POSITION, -100, "64 80"),  # sign in bit 15
        (STS_TABLE, Register.HOMING_OFFSET, -85, "55 00"),  # the servo subtracts its offset
        (STS_TABLE, Register.HOMING_OFFSET, 85, "55 08"),  # sign in bit 11
        (STS_TABLE, Register.GOAL_PWM, 885, "E8 03"),
        (STS_TABLE, Register.STATUS_RETURN_LEVEL, 2, "01"),
        (STS_TABLE, Register.OPERATING_MODE, 3, "00"),
        (STS_TABLE, Register.SHUTDOWN, 52, "2C"),  # 4 overheating, 8 current, 32 overload
        (SCS_TABLE, Register.GOAL_POSITION, 2048, "02 00"),  # high byte first
        (AX_TABLE, Register.GOAL_POSITION, 2048, "00 02"),
        (AX_TABLE, Register.PRESENT_CURRENT, -100, "66 04"),  # sign in bit 10
        (MX_TABLE, Register.GOAL_POSITION, 4095, "FF 0F"),
        (MX_TABLE, Register.SHUTDOWN, 36, "24"),
    ],
)
def test_register_values_are_encoded_as_bytes_of_their_servo_family(table, register: Register, value: int, data: str):
    assert table.pack(register, value) == bytes.fromhex(data)
    assert table.unpack(register, bytes.fromhex(data)) == value


def test_register_velocities_of_each_servo_family_have_the_unit_of_the_manual():
    for table, native, speed in (
        (STS_TABLE, 1000, 1000 * TICK_ANGLE),  # steps/s
        (AX_TABLE, 100, 11.1 * 0.10472),  # 0.111 rev/min
        (MX_TABLE, 100, 11.4 * 0.10472),  # 0.114 rev/min
    ):
        with about(table.name):
            counts = table.fields[Register.PRESENT_VELOCITY].from_native(native)
            assert counts * VELOCITY_UNIT == pytest.approx(speed, abs=VELOCITY_UNIT)


def test_register_value_that_is_read_and_written_back_stays_equal():
    """Write each read-back value again and compare.

    A conversion to coarser counts must not shift a value twice.
    """
    for table in FAMILY_TABLES.values():
        for register, field in table.fields.items():
            for native in range(0, 1 << min(8 * field.size, 11), 7):
                value = field.from_native(native)
                with about(f"{table.name} {register.name} {native}"):
                    assert table.quantise(register, table.quantise(register, value)) == table.quantise(register, value)


def test_positions_converted_to_coarser_servo_families_are_within_half_a_count():
    for name in ("ax12", "scs0009"):
        model = SERVO_MODELS[name]
        lowest, highest = model.allowed_range(Register.GOAL_POSITION)
        for value in range(lowest, highest, 11):
            assert abs(model.quantise(Register.GOAL_POSITION, value) - value) <= 2


def test_register_addresses_of_a_family_do_not_overlap():
    for table in FAMILY_TABLES.values():
        used = [address for field in table.fields.values() for address in range(field.address, field.end)]
        assert len(used) == len(set(used)), table.name
        start, size = table.record_span
        for register in (Register.TORQUE_ENABLE, Register.PRESENT_POSITION, Register.PRESENT_TEMPERATURE):
            assert start <= table.fields[register].address < start + size
