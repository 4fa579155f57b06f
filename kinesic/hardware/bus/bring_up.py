"""Brings up a bus on an open wire: checks that all servos are there and show their records. Nothing is energised."""

from collections.abc import Sequence

import numpy as np

from kinesic.hardware.bus.bus import Bus, Servo
from kinesic.hardware.bus.cycle import CELLS, HEALTH, SIZE
from kinesic.hardware.bus.query import FastQuery
from kinesic.hardware.protocol.device import Cold
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, BusError, Wire

FAST_TRIES = 3
FAST_WAIT = 0.02  # [s] beyond the bytes


def open_bus(wire: Wire, servos: Sequence[Servo], *, period: float = 0.01) -> Bus:
    """Checks the servos, lets them show their records, and finds out whether they answer fast reads.

    Args:
        wire: an open one.
        servos: that must be there, in the order of goals and records.
        period: [s] between cycles.

    Raises:
        BusError: servos are missing or not as they should be; one line each.
    """
    cold = Cold(wire)
    wrong = problems(cold, servos)
    if wrong:
        raise BusError("\n".join(wrong))
    for servo in servos:
        show_record(cold, servo)
    return Bus(wire, servos, period=period, fast=answers_fast(wire, servos))


def problems(cold: Cold, servos: Sequence[Servo]) -> tuple[str, ...]:
    """Returns what is wrong with the servos that must be there: one line each, empty if nothing."""
    found = {servo.id: line for servo in servos if (line := _problem(cold, servo))}
    if len(found) == len(servos) and all("no answer" in line for line in found.values()):
        others = ", ".join(f"{other.id} ({other.name})" for other in cold.everyone())
        answering = f"; those who answer: {others}" if others else "; is the power on, is the baud rate right?"
        ids = ", ".join(str(servo.id) for servo in servos)
        return (f"{cold.wire.name}: no servo of ids {ids} at {cold.wire.baud} baud{answering}",)
    return tuple(found.values())


def _problem(cold: Cold, servo: Servo) -> str:
    where, model = f"{cold.wire.name}: servo {servo.id}", servo.model
    found = cold.ping(servo.id)
    if found is None:
        return f"{where}: no answer at {cold.wire.baud} baud; `kinesic servos scan` tells who is there"
    if found.number != model.number:
        return f"{where}: is a {found.name}, must be a {model.name}; wrong id, or wrong robot?"
    if found.firmware < model.least_firmware:
        return (
            f"{where}: firmware {found.firmware} has no bus watchdog, must be {model.least_firmware} or newer; "
            "update it with DYNAMIXEL Wizard"
        )
    if cold.is_shared(servo.id):
        return f"{where}: several servos have this id; connect them one at a time and give each its own"
    volts = cold.read(servo.id, Register.PRESENT_INPUT_VOLTAGE)
    least = cold.read(servo.id, Register.MIN_VOLTAGE_LIMIT)
    if volts < least:
        return f"{where}: supply is {volts / 10:.1f} V, must be {least / 10:.1f} V at least"
    return ""


def show_record(cold: Cold, servo: Servo) -> None:
    """Maps a servo's indirect cells to the registers of its record, and checks that they return these.

    Raises:
        BusError: they do not.
    """
    cells = servo.model.cells[0]
    if cold.read_span(servo.id, cells.addresses, len(CELLS)) != CELLS:
        cold.write_span(servo.id, cells.addresses, CELLS, name="indirect addresses")
    shown = np.frombuffer(cold.read_span(servo.id, cells.data, SIZE), HEALTH)[0]
    direct = cold.read(servo.id, Register.PRESENT_INPUT_VOLTAGE)
    if abs(int(shown["volts"]) - direct) > direct // 4:
        raise BusError(
            f"{cold.wire.name}: servo {servo.id}: its indirect data at {cells.data} does not show its registers; "
            "update its firmware with DYNAMIXEL Wizard"
        )


def answers_fast(wire: Wire, servos: Sequence[Servo]) -> bool:
    """Returns whether all servos answer one fast read together, which older firmware does not."""
    question = FastQuery(tuple(servo.id for servo in servos), tuple(servo.cells for servo in servos))
    if len(question.servos) == 1:
        return False
    for _ in range(FAST_TRIES):
        wire.read(wire.now())
        wire.write(question.data)
        octets = len(question.data) + question.length
        limit, raw = wire.now() + octets * BITS_PER_BYTE / wire.baud + FAST_WAIT, b""
        while len(raw) < question.length and (chunk := wire.read(limit)):
            raw += chunk
        if raw and question.answer(raw).whole:
            return True
    return False
