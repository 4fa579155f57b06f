"""Comparison with packets printed in ROBOTIS's e-Manual."""

from collections.abc import Callable

import pytest

from kinesic.hardware.protocol.packet import Fault
from kinesic.hardware.protocol.registers import Mode, Register

from .conftest import Line

Lines = Callable[..., Line]

# Ids 1 and 2, XM430-W210 with firmware 38.
PING = "FF FF FD 00 01 03 00 01 19 4E", "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D"
PING_ALL = (
    "FF FF FD 00 FE 03 00 01 31 42",
    "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D FF FF FD 00 02 07 00 55 00 06 04 26 6F 6D",
)
WRITE = "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89", "FF FF FD 00 01 04 00 55 00 A1 0C"
REG_WRITE = "FF FF FD 00 01 09 00 04 68 00 C8 00 00 00 AE 8E", "FF FF FD 00 01 04 00 55 00 A1 0C"
ACTION = "FF FF FD 00 01 03 00 05 02 CE", "FF FF FD 00 01 04 00 55 00 A1 0C"
RESET = "FF FF FD 00 01 04 00 06 01 A1 E6", "FF FF FD 00 01 04 00 55 00 A1 0C"
REBOOT = "FF FF FD 00 01 03 00 08 2F 4E", "FF FF FD 00 01 04 00 55 00 A1 0C"
READ = "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15", "FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0"
SYNC_READ = (
    "FF FF FD 00 FE 09 00 82 84 00 04 00 01 02 CE FA",
    "FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0 FF FF FD 00 02 08 00 55 00 1F 08 00 00 BA BE",
)


def octets(text: str) -> bytes:
    return bytes.fromhex(text)


@pytest.fixture
def manual(line: Lines) -> Line:
    """Return the two servos of the manual's examples."""
    both = line(1, 2, model="xm430_w210", firmware=38)
    both.plant.physics.turn(0, 166 * Register.PRESENT_POSITION.field.scale)
    both.plant.physics.turn(1, 2079 * Register.PRESENT_POSITION.field.scale)
    return both


@pytest.mark.parametrize(
    "example",
    [PING, PING_ALL, WRITE, REG_WRITE, RESET, REBOOT, READ, SYNC_READ],
    ids=["ping", "ping all", "write", "reg write", "reset", "reboot", "read", "sync read"],
)
def test_virtual_servo_replies_match_the_manual(manual: Line, example: tuple[str, str]):
    asked, answered = example
    assert manual.bytes(octets(asked)) == octets(answered)


def test_action_instruction_executes_the_registered_write(manual: Line):
    manual.set(Register.OPERATING_MODE, Mode.VELOCITY.value)
    manual.set(Register.TORQUE_ENABLE, 1)
    manual.bytes(octets(REG_WRITE[0]))
    assert (manual.get(Register.REGISTERED_INSTRUCTION), manual.get(Register.GOAL_VELOCITY)) == (1, 0)
    assert manual.bytes(octets(ACTION[0])) == octets(ACTION[1])
    assert (manual.get(Register.REGISTERED_INSTRUCTION), manual.get(Register.GOAL_VELOCITY)) == (0, 200)
    assert manual.error(octets(ACTION[0])) == Fault.INSTRUCTION, "nothing is registered any more"
