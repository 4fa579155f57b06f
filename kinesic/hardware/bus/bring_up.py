"""Start-up of a bus with checks of its servos.

No torque is switched on.
"""

from collections.abc import Sequence

import numpy as np

from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.cycle import CELL_CONTENTS, RECORD_DTYPE, RECORD_SIZE
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.bus.query import FastQuery
from kinesic.hardware.protocol.device import ServoAccess
from kinesic.hardware.protocol.frame_access import open_access
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, BusError, Wire

FAST_TRIES = 3  # attempts of a fast read before the bus uses plain reads
FAST_TIMEOUT = 0.02  # [s] longest wait for the reply to a fast read, in addition to the transmission time


def open_bus(wire: Wire, servos: Sequence[Servo], *, period: float = 0.01) -> Bus:
    """Check and prepare the servos of a wire, and return their bus.

    Args:
        wire: an open wire.
        servos: required servos, in the order of goals and records.
        period: [s] between cycles.

    Raises:
        BusError: servos are missing or unsuitable; one line each.
    """
    table = servos[0].model.table if servos else None
    access = open_access(wire, table)
    found_problems = find_problems(access, servos)
    if found_problems:
        raise BusError("\n".join(found_problems))
    if table is not None:
        return Bus(wire, servos, period=period, fast=False)
    for servo in servos:
        map_record(access, servo)
    return Bus(wire, servos, period=period, fast=supports_fast_reads(wire, servos))


def find_problems(access: ServoAccess, servos: Sequence[Servo]) -> tuple[str, ...]:
    """Return one line per missing or unsuitable servo.

    If no required servo answers, a single line lists the other servos that do.
    """
    problems = {servo.id: line for servo in servos if (line := _problem(access, servo))}
    if len(problems) == len(servos) and all("no answer" in line for line in problems.values()):
        others = ", ".join(f"{other.id} ({other.name})" for other in access.ping_all())
        answering = f"; answering: {others}" if others else "; is the power on, is the baud rate right?"
        ids = ", ".join(str(servo.id) for servo in servos)
        return (f"{access.wire.name}: no servo of ids {ids} at {access.wire.baud} baud{answering}",)
    return tuple(problems.values())


def _problem(access: ServoAccess, servo: Servo) -> str:
    where, model = f"{access.wire.name}: servo {servo.id}", servo.model
    reply = access.ping(servo.id)
    if reply is None:
        return f"{where}: no answer at {access.wire.baud} baud; `kinesic servos scan` lists the servos"
    if reply.number != model.number:
        return f"{where}: is a {reply.name}, must be a {model.name}; wrong id, or wrong robot?"
    if reply.firmware < model.min_firmware:
        return (
            f"{where}: firmware {reply.firmware} has no bus watchdog, must be {model.min_firmware} or newer; "
            "update it with DYNAMIXEL Wizard"
        )
    if access.is_shared(servo.id):
        return f"{where}: several servos have this id; connect them one at a time and give each its own"
    volts = access.read(servo.id, Register.PRESENT_INPUT_VOLTAGE)
    least = access.read(servo.id, Register.MIN_VOLTAGE_LIMIT)
    if volts < least:
        return f"{where}: supply is {volts / 10:.1f} V, must be at least {least / 10:.1f} V"
    return ""


def map_record(access: ServoAccess, servo: Servo) -> None:
    """Point a servo's indirect addresses at the registers that each cycle reads.

    The mapping is read back and checked.

    Raises:
        BusError: the cells do not show the registers.
    """
    cells = servo.model.cells[0]
    if access.read_span(servo.id, cells.addresses, len(CELL_CONTENTS)) != CELL_CONTENTS:
        access.write_span(servo.id, cells.addresses, CELL_CONTENTS, name="indirect addresses")
    shown = np.frombuffer(access.read_span(servo.id, cells.data, RECORD_SIZE), RECORD_DTYPE)[0]
    direct = access.read(servo.id, Register.PRESENT_INPUT_VOLTAGE)
    if abs(int(shown["volts"]) - direct) > direct // 4:
        raise BusError(
            f"{access.wire.name}: servo {servo.id}: its indirect data at {cells.data} does not show its registers; "
            "update its firmware with DYNAMIXEL Wizard"
        )


def supports_fast_reads(wire: Wire, servos: Sequence[Servo]) -> bool:
    """Return whether all servos answer a common fast read.

    Older firmware does not. A single servo is read plainly, which gives False.
    """
    question = FastQuery(tuple(servo.id for servo in servos), tuple(servo.cells for servo in servos))
    if len(question.servos) == 1:
        return False
    for _ in range(FAST_TRIES):
        wire.read(wire.now())
        wire.write(question.data)
        octets = len(question.data) + question.length
        limit, raw = wire.now() + octets * BITS_PER_BYTE / wire.baud + FAST_TIMEOUT, b""
        while len(raw) < question.length and (chunk := wire.read(limit)):
            raw += chunk
        if raw and question.parse(raw).whole:
            return True
    return False
