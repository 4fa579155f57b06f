"""Answers instructions as several servos together do by Protocol 2.0: who answers, when, and with which bytes.

Assumed where no source says: in a fast read each servo waits for the bytes before its own, so that one who keeps silent
ends the reply; in a plain sync read the others go on without him.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from kinesic.hardware.protocol.packet import BROADCAST, HEADER, Instruction, Packet, crc16, status
from kinesic.hardware.virtual.servo import VirtualServo

TURNAROUND = 20e-6  # [s] that a servo takes between the end of what it waits for and its own first byte

Servos = Mapping[int, Sequence[VirtualServo]]  # by id; more than one where an id is given twice


@dataclass(frozen=True)
class Sent:
    """What one servo puts on the wire."""

    servo: int
    data: bytes
    delay: float = 0.0  # [s] of silence before
    chained: bool = False  # the ones behind it wait for its bytes


def answers(packet: Packet, servos: Servos) -> list[Sent]:
    """Lets the servos do what a packet says, and returns their answers.

    Args:
        packet: as it came along the wire.
        servos: those that hear it.

    Returns:
        Their answers in the order of the wire.
    """
    collective = _COLLECTIVE.get(packet.instruction)
    if collective is not None:
        return list(collective(packet, servos)) if packet.id == BROADCAST else []
    if packet.id == BROADCAST:
        return list(_broadcast(packet, servos))
    return list(_plain(packet.id, packet.instruction, packet.parameters, servos))


def obey_aliases(packet: Packet, aliases: Servos) -> None:
    """Lets servos do what their secondary id is told, which they never answer."""
    if aliases and (packet.id != BROADCAST or packet.instruction in _WRITING):
        answers(packet, aliases)


def _plain(servo: int, instruction: int, parameters: bytes, servos: Servos) -> Iterator[Sent]:
    """One status of one servo, or of several with one id, who talk at the same time."""
    talking, delay = b"", 0.0
    for requested in servos.get(servo, ()):
        answering, delay = requested.answers(instruction) and not requested.mute, requested.delay
        error, data = requested.execute(instruction, parameters)
        if answering:
            talking = _mixed(talking, status(servo, error, data))
    if talking:
        yield Sent(servo, talking, TURNAROUND + delay)


def _mixed(one: bytes, other: bytes) -> bytes:
    """Two servos talking at once: a low level wins."""
    if not one:
        return other
    return bytes(a & b for a, b in zip_longest(one, other, fillvalue=0xFF))


def _broadcast(packet: Packet, servos: Servos) -> Iterator[Sent]:
    """All obey, and only a ping is answered, in the order of ids."""
    if packet.instruction == Instruction.PING:
        for requested in sorted(servos):
            yield from _plain(requested, Instruction.PING, b"", servos)
        return
    everything = packet.instruction == Instruction.FACTORY_RESET and packet.parameters == b"\xff"
    if packet.instruction == Instruction.READ or everything:  # all at once: the firmware refuses
        return
    for same in list(servos.values()):
        for servo in same:
            servo.execute(packet.instruction, packet.parameters)


def _sync_write(packet: Packet, servos: Servos) -> Iterator[Sent]:
    address, size = packet.parameters[:2], int.from_bytes(packet.parameters[2:4], "little")
    rows = packet.parameters[4:]
    for k in range(0, len(rows) - size, size + 1):
        for servo in servos.get(rows[k], ()):
            servo.execute(Instruction.WRITE, address + rows[k + 1 : k + 1 + size])
    yield from ()


def _bulk_write(packet: Packet, servos: Servos) -> Iterator[Sent]:
    rows, k = packet.parameters, 0
    while k + 5 <= len(rows):
        size = int.from_bytes(rows[k + 3 : k + 5], "little")
        for servo in servos.get(rows[k], ()):
            servo.execute(Instruction.WRITE, rows[k + 1 : k + 3] + rows[k + 5 : k + 5 + size])
        k += 5 + size
    yield from ()


def _requested(packet: Packet) -> list[tuple[int, bytes]]:
    """Id and span (address and size, four bytes) of each servo that a collective read asks."""
    rows = packet.parameters
    if packet.instruction in (Instruction.SYNC_READ, Instruction.FAST_SYNC_READ):
        return [(servo, rows[:4]) for servo in rows[4:]]
    return [(rows[k], rows[k + 1 : k + 5]) for k in range(0, len(rows) - 4, 5)]


def _read_each(packet: Packet, servos: Servos) -> Iterator[Sent]:
    for servo, span in _requested(packet):
        yield from _plain(servo, Instruction.READ, span, servos)


def _read_fast(packet: Packet, servos: Servos) -> Iterator[Sent]:
    """One joint reply; each block ends with the CRC of everything before it, earlier CRCs included."""
    requested = _requested(packet)
    sizes = [int.from_bytes(span[2:4], "little") for _, span in requested]
    length = 1 + sum(size + 4 for size in sizes)
    head = HEADER + bytes((BROADCAST, length & 0xFF, length >> 8 & 0xFF, Instruction.STATUS))
    crc = 0
    for k, ((servo, span), size) in enumerate(zip(requested, sizes, strict=True)):
        block, delay = b"", 0.0
        for candidate in servos.get(servo, ()):
            if candidate.fast and candidate.answers(Instruction.READ) and not candidate.mute:
                error, data = candidate.execute(Instruction.READ, span)
                begun = (b"" if k else head) + bytes((error, servo)) + data.ljust(size, b"\0")
                block, delay = _mixed(block, begun), candidate.delay
        if not block:
            return
        crc = crc16(block, crc)
        ended = block + crc.to_bytes(2, "little")
        crc = crc16(ended[-2:], crc)
        yield Sent(servo, ended, 0.0 if k else TURNAROUND + delay, chained=True)


_WRITING = (Instruction.SYNC_WRITE, Instruction.BULK_WRITE)
_COLLECTIVE: Mapping[int, Callable[[Packet, Servos], Iterator[Sent]]] = {
    Instruction.SYNC_READ: _read_each,
    Instruction.BULK_READ: _read_each,
    Instruction.FAST_SYNC_READ: _read_fast,
    Instruction.FAST_BULK_READ: _read_fast,
    Instruction.SYNC_WRITE: _sync_write,
    Instruction.BULK_WRITE: _bulk_write,
}
