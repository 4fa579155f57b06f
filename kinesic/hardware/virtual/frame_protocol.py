"""Replies of several servos to instructions in Protocol 1.0 frames.

Assumed without a source: Feetech servos answer a ping of all in the order of their ids, Dynamixel servos do not; in a
read of several servos, those after a silent one continue.
"""

from collections.abc import Iterator

from kinesic.hardware.protocol.frame import frame
from kinesic.hardware.protocol.packet import BROADCAST_ID, Instruction, Packet
from kinesic.hardware.virtual.frame_servo import FrameServo
from kinesic.hardware.virtual.protocol import TURNAROUND_TIME, Sent, Servos, mix_bits


def frame_answers(packet: Packet, servos: Servos) -> list[Sent]:
    """Execute a frame and return the servos' replies in wire order."""
    parameters = packet.parameters
    if packet.instruction == Instruction.SYNC_WRITE:
        _sync_write(parameters, servos)
        return []
    if packet.instruction == Instruction.SYNC_READ:
        return [sent for servo in parameters[2:] for sent in _plain(servo, Instruction.READ, parameters[:2], servos)]
    if packet.instruction == Instruction.BULK_READ:
        rows = [parameters[k : k + 3] for k in range(1, len(parameters) - 2, 3)]
        spans = [(servo, bytes((address, size))) for size, servo, address in rows]
        return [sent for servo, span in spans for sent in _plain(servo, Instruction.READ, span, servos)]
    if packet.id == BROADCAST_ID:
        return _broadcast(packet, servos)
    return list(_plain(packet.id, packet.instruction, parameters, servos))


def _broadcast(packet: Packet, servos: Servos) -> list[Sent]:
    replies = [
        sent
        for servo in sorted(servos)
        for sent in _plain(servo, packet.instruction, packet.parameters, servos)
        if packet.instruction != Instruction.READ
    ]
    is_answered = packet.instruction == Instruction.PING and all(
        isinstance(servo, FrameServo) and servo.table.maker == "Feetech" for same in servos.values() for servo in same
    )
    return replies if is_answered else []


def _plain(servo: int, instruction: int, parameters: bytes, servos: Servos) -> Iterator[Sent]:
    """Execute an instruction on servos with one id, and yield the reply.

    Statuses of several servos with the same id are mixed.
    """
    reply, delay = b"", 0.0
    for requested in servos.get(servo, ()):
        has_reply, delay = requested.answers(instruction) and not requested.mute, requested.delay
        error, data = requested.execute(instruction, parameters)
        if has_reply:
            reply = mix_bits(reply, frame(servo, error, data))
    if reply:
        yield Sent(servo, reply, TURNAROUND_TIME + delay)


def _sync_write(parameters: bytes, servos: Servos) -> None:
    address, size, rows = parameters[:1], parameters[1], parameters[2:]
    for k in range(0, len(rows) - size, size + 1):
        for servo in servos.get(rows[k], ()):
            servo.execute(Instruction.WRITE, address + rows[k + 1 : k + 1 + size])
