"""Refusals and required registers of single servos, without a bus."""

import numpy as np
import pytest

from kinesic.hardware.protocol.device import RegisterChange
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor import preflight
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.preflight import (
    VITAL_REGISTERS,
    RegisterTable,
    find_refusals,
    open_wires,
    required_registers,
)

TABLE_SIZE = Register.PRESENT_TEMPERATURE.field.end
XM430, XC430, XC330 = 0, 2, 3  # index of a servo of this model


@pytest.fixture(scope="session")
def manifest(robot) -> Manifest:
    return Manifest.of(robot)


def table(member: Member, **changes: int) -> RegisterTable:
    """Return the registers of a configured servo in mid-range."""
    fields = [register for register in Register if register.field.end <= TABLE_SIZE]
    values = {register: member.model.factory_value(register) for register in fields} | member.eeprom_values
    values |= {Register.FIRMWARE_VERSION: 50, Register.PRESENT_POSITION: (member.lower + member.upper) // 2}
    values |= {Register[name]: value for name, value in changes.items()}
    data = bytearray(TABLE_SIZE)
    for register, value in values.items():
        data[register.field.address : register.field.end] = register.field.pack(value)
    return RegisterTable(member, bytes(data))


def test_configured_servos_with_factory_limits_are_accepted(manifest):
    assert all(not find_refusals(table(member)) for member in manifest.members)


@pytest.mark.parametrize(
    ("register", "least"),
    [("PWM_LIMIT", 647), ("CURRENT_LIMIT", 597), ("VELOCITY_LIMIT", 269), ("TEMPERATURE_LIMIT", 50)],
)
def test_servo_limit_one_count_below_the_required_value_is_refused(manifest, register, least):
    member = manifest.members[XM430]
    assert find_refusals(table(member, **{register: least})) == ()
    (reason,) = find_refusals(table(member, **{register: least - 1}))
    assert f"limit is {least - 1}" in reason or "velocity limit is" in reason


def test_servo_without_a_current_limit_is_accepted(manifest):
    assert find_refusals(table(manifest.members[XC430], CURRENT_LIMIT=0)) == ()


def test_position_limits_of_a_servo_must_contain_the_hinge_range(manifest):
    member = manifest.members[XM430]
    lower, upper = member.lower, member.upper
    assert find_refusals(table(member, MIN_POSITION_LIMIT=lower, MAX_POSITION_LIMIT=upper)) == ()
    for narrower in ({"MIN_POSITION_LIMIT": lower + 1}, {"MAX_POSITION_LIMIT": upper - 1}):
        (reason,) = find_refusals(table(member, **narrower))
        assert f"its hinge needs {lower}..{upper}" in reason


@pytest.mark.parametrize("turn", [0, 4096])
def test_servo_outside_its_goal_range_is_refused_in_any_turn(manifest, turn):
    member = manifest.members[XM430]
    lower, upper = member.span
    for position, is_refused in ((lower, False), (upper, False), (lower - 1, True), (upper + 1, True)):
        refusals = find_refusals(table(member, PRESENT_POSITION=position + turn))
        assert [f"is at {position} ticks" in reason for reason in refusals] == [True] * is_refused


@pytest.mark.parametrize("register", ["DRIVE_MODE", "OPERATING_MODE", "HOMING_OFFSET"])
def test_servo_position_is_not_checked_while_a_register_that_defines_it_is_wrong(manifest, register):
    assert find_refusals(table(manifest.members[XM430], PRESENT_POSITION=0, **{register: 1})) == ()


@pytest.mark.parametrize("register", [register.name for register in VITAL_REGISTERS])
def test_servo_with_torque_is_refused_if_a_vital_register_is_wrong(manifest, register):
    member = manifest.members[XM430]
    (reason,) = find_refusals(table(member, TORQUE_ENABLE=1, **{register: 1}))
    assert f" {register}; release it" in reason
    assert find_refusals(table(member, TORQUE_ENABLE=1)) == ()
    assert find_refusals(table(member, TORQUE_ENABLE=0, **{register: 1})) == ()


def test_required_limits_of_a_servo_only_narrow_its_present_limits(manifest):
    member, limits = manifest.members[XM430], ("MIN_VOLTAGE_LIMIT", "MAX_VOLTAGE_LIMIT", "TEMPERATURE_LIMIT")
    lower, upper = member.span
    for present, required in (((90, 170, 90), (95, 160, 80)), ((100, 150, 70), (100, 150, 70))):
        registers = required_registers(table(member, **dict(zip(limits, present, strict=True))))
        assert tuple(registers[Register[name]] for name in limits) == required
        assert (registers[Register.MIN_POSITION_LIMIT], registers[Register.MAX_POSITION_LIMIT]) == (lower, upper)
    narrow = required_registers(table(member, MIN_POSITION_LIMIT=lower + 5, MAX_POSITION_LIMIT=upper - 5))
    assert (narrow[Register.MIN_POSITION_LIMIT], narrow[Register.MAX_POSITION_LIMIT]) == (lower + 5, upper - 5)


@pytest.mark.parametrize(
    ("place", "firmware", "is_required"), [(XM430, 44, False), (XM430, 45, True), (XC330, 44, True)]
)
def test_startup_configuration_is_cleared_if_model_and_firmware_have_the_register(
    manifest, place, firmware, is_required
):
    registers = required_registers(table(manifest.members[place], FIRMWARE_VERSION=firmware))
    assert registers.get(Register.STARTUP_CONFIGURATION) == (0 if is_required else None)


def test_open_ports_are_closed_if_another_does_not_open(manifest):
    closed = []

    class Port:
        def close(self) -> None:
            closed.append("left")

    def open_port(name: str) -> Port:
        if name == "right":
            raise BusError("right: no such port")
        return Port()

    with pytest.raises(BusError, match=r"^right: no such port$"):
        open_wires(manifest, open_port)
    assert closed == ["left"]


class RecordingAxes:
    """Buses that record the values that servos are given, in their order."""

    def __init__(self) -> None:
        self.written: list[tuple[int, dict[Register, int]]] = []

    def access(self, bus: str) -> "RecordingAxes":
        return self

    def configure(self, servo: int, values: dict[Register, int]) -> list[RegisterChange]:
        self.written += [(servo, values)] if values else []
        return []


def test_secondary_ids_of_all_servos_are_disabled_before_other_registers_are_written(manifest, monkeypatch):
    monkeypatch.setattr(preflight, "check_servos", lambda *_: None)
    first, second = manifest.members[:2]
    axes = RecordingAxes()
    wrong = {"SECONDARY_ID": 9, "RETURN_DELAY_TIME": 99}
    tables = (table(first, **wrong), table(second, **wrong), table(manifest.members[2], **wrong, TORQUE_ENABLE=1))
    preflight.configure(axes, tables)
    others = {Register.RETURN_DELAY_TIME, Register.MIN_POSITION_LIMIT, Register.MAX_POSITION_LIMIT}
    assert [(servo, set(values)) for servo, values in axes.written] == [
        (first.id, {Register.SECONDARY_ID}),
        (second.id, {Register.SECONDARY_ID}),
        (first.id, others),
        (second.id, others),
    ]
    assert axes.written[0][1][Register.SECONDARY_ID] == first.eeprom_values[Register.SECONDARY_ID] == 255


@pytest.mark.parametrize(("angle", "is_refused"), [(np.pi, False), (0.1, True)])
def test_servo_position_is_checked_again_after_its_homing_offset_was_cleared(desk, angle, is_refused):
    made = desk()
    made.plant.servos[2].memory[Register.HOMING_OFFSET] = 900
    made.plant.physics.turn(2, angle)
    made.open()
    made.cycle()
    refused = [note.text for note in made.notes() if note.kind == "refused"]
    assert ["is at 65 ticks, outside 1894..3624" in text for text in refused] == [True] * is_refused
    assert made.plant.servos[2].memory[Register.HOMING_OFFSET] == 0
