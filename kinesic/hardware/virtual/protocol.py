"""Replies of several servos to instructions of Protocol 2.0.

Assumed without a source: in a fast read each servo waits for the bytes before its own, so a silent servo ends the
reply; in a plain sync read the other servos continue.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from kinesic.hardware.protocol.packet import BROADCAST_ID, PACKET_HEADER, Instruction, Packet, crc16, status
from kinesic.hardware.virtual.servo import VirtualServo

TURNAROUND_TIME = 20e-6  # [s] time from the end of a packet to the first byte of the reply

Servos = Mapping[int, Sequence[VirtualServo]]  # by id; several if an id is given twice


@dataclass(frozen=True)
class Sent:
    """Bytes that one servo transmits."""

    servo: int
    data: bytes
    delay: float = 0.0  # [s] silence on the wire before the first byte
    chained: bool = False  # whether later servos wait for its bytes


def answers(packet: Packet, servos: Servos) -> list[Sent]:
    """Execute a packet on the servos, and return their replies.

    Args:
        packet: received packet.
        servos: servos that receive it, by id.

    Returns:
        Replies in the order of the wire.
    """
    collective = _COLLECTIVE_INSTRUCTIONS.get(packet.instruction)
    if collective is not None:
        return list(collective(packet, servos)) if packet.id == BROADCAST_ID else []
    if packet.id == BROADCAST_ID:
        return list(_broadcast(packet, servos))
    return list(_plain(packet.id, packet.instruction, packet.parameters, servos))


def obey_aliases(packet: Packet, aliases: Servos) -> None:
    """Execute a packet on servos addressed by their secondary id.

    They never reply.
    """
    if aliases and (packet.id != BROADCAST_ID or packet.instruction in _WRITE_INSTRUCTIONS):
        answers(packet, aliases)


def _plain(servo: int, instruction: int, parameters: bytes, servos: Servos) -> Iterator[Sent]:
    """Execute an instruction on servos with one id, and yield the reply.

    Statuses of several servos with the same id are mixed.
    """
    reply, delay = b"", 0.0
    for requested in servos.get(servo, ()):
        has_reply, delay = requested.answers(instruction) and not requested.mute, requested.delay
        error, data = requested.execute(instruction, parameters)
        if has_reply:
            reply = mix_bits(reply, status(servo, error, data))
    if reply:
        yield Sent(servo, reply, TURNAROUND_TIME + delay)


def mix_bits(one: bytes, other: bytes) -> bytes:
    """Combine two simultaneous transmissions bit by bit (a low level wins)."""
    if not one:
        return other
    return bytes(a & b for a, b in zip_longest(one, other, fillvalue=0xFF))


def _broadcast(packet: Packet, servos: Servos) -> Iterator[Sent]:
    """Execute a broadcast on all servos.

    Only a ping is answered, by id.
    """
    if packet.instruction == Instruction.PING:
        for requested in sorted(servos):
            yield from _plain(requested, Instruction.PING, b"", servos)
        return
    everything = packet.instruction == Instruction.FACTORY_RESET and packet.parameters == b"\xff"
    if packet.instruction == Instruction.READ or everything:  # the firmware refuses these for all servos at once
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
    """Return servo id and register span of each queried servo.

    A span is address and size in four bytes.
    """
    rows = packet.parameters
    if packet.instruction in (Instruction.SYNC_READ, Instruction.FAST_SYNC_READ):
        return [(servo, rows[:4]) for servo in rows[4:]]
    return [(rows[k], rows[k + 1 : k + 5]) for k in range(0, len(rows) - 4, 5)]


def _read_each(packet: Packet, servos: Servos) -> Iterator[Sent]:
    for servo, span in _requested(packet):
        yield from _plain(servo, Instruction.READ, span, servos)


def _read_fast(packet: Packet, servos: Servos) -> Iterator[Sent]:
    """Yield the blocks of the reply to a fast read.

    Each block ends with the CRC of everything before it, earlier CRCs included.
    """
    requested = _requested(packet)
    sizes = [int.from_bytes(span[2:4], "little") for _, span in requested]
    length = 1 + sum(size + 4 for size in sizes)
    head = PACKET_HEADER + bytes((BROADCAST_ID, length & 0xFF, length >> 8 & 0xFF, Instruction.STATUS))
    crc = 0
    for k, ((servo, span), size) in enumerate(zip(requested, sizes, strict=True)):
        block, delay = b"", 0.0
        for candidate in servos.get(servo, ()):
            if candidate.fast and candidate.answers(Instruction.READ) and not candidate.mute:
                error, data = candidate.execute(Instruction.READ, span)
                begun = (b"" if k else head) + bytes((error, servo)) + data.ljust(size, b"\0")
                block, delay = mix_bits(block, begun), candidate.delay
        if not block:
            return
        crc = crc16(block, crc)
        ended = block + crc.to_bytes(2, "little")
        crc = crc16(ended[-2:], crc)
        yield Sent(servo, ended, 0.0 if k else TURNAROUND_TIME + delay, chained=True)


_WRITE_INSTRUCTIONS = (Instruction.SYNC_WRITE, Instruction.BULK_WRITE)  # writes to several servos, without reply
_COLLECTIVE_INSTRUCTIONS: Mapping[int, Callable[[Packet, Servos], Iterator[Sent]]] = {
    Instruction.SYNC_READ: _read_each,
    Instruction.BULK_READ: _read_each,
    Instruction.FAST_SYNC_READ: _read_fast,
    Instruction.FAST_BULK_READ: _read_fast,
    Instruction.SYNC_WRITE: _sync_write,
    Instruction.BULK_WRITE: _bulk_write,
}
