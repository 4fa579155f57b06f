"""Half-duplex wire with virtual servos.

It takes bytes with their send times and returns bytes with their arrival times. The caller owns the clock, so time may
be real or virtual. A byte takes ten bits; the host's adapter delivers bytes once `USB_PACKET_SIZE` of them are there,
or when its latency timer has run since the last delivery (FTDI, AN232B-04); the last bytes wait for the full timer. A
host that transmits during a reply destroys both: the servos do not understand the packet, and the adapter does not
receive the overlapped part of the reply.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from math import inf
from typing import NamedTuple

from kinesic.hardware.protocol.frame import FrameReader, split_frames
from kinesic.hardware.protocol.packet import PACKET_HEADER, Packet, Reader
from kinesic.hardware.protocol.wire import BITS_PER_BYTE
from kinesic.hardware.virtual.faults import NO_FAULTS, FaultPlan, Transmission, WireFaults
from kinesic.hardware.virtual.frame_protocol import frame_answers
from kinesic.hardware.virtual.protocol import answers, obey_aliases
from kinesic.hardware.virtual.servo import VirtualServo
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation

USB_PACKET_SIZE = 62  # [bytes] payload of a USB packet of a common adapter
ADAPTER_LATENCY = 0.001  # [s] latency timer of the adapter in its recommended setting


class VirtualBus:
    """Simulated half-duplex wire, on which all servos receive every packet."""

    def __init__(
        self,
        plant: ShaftSimulation,
        servos: Sequence[VirtualServo],
        *,
        baud: int,
        latency: float = ADAPTER_LATENCY,
        faults: FaultPlan = NO_FAULTS,
    ) -> None:
        """Connect simulated servos to the wire.

        Args:
            plant: simulation of all servos.
            servos: servos on this wire.
            baud: [bit/s] of the host.
            latency: [s] of the adapter's timer.
            faults: faults of this wire and its servos.
        """
        self.baud = baud
        self._plant, self._servos = plant, tuple(servos)
        self._latency = latency
        self._uses_frames = any(servo.memory.model.table is not None for servo in servos)
        self._reader = FrameReader() if self._uses_frames else Reader()
        self._sent_until = self._replied_until = plant.time  # [s] end of the transmissions of host and servos
        self._coming: deque[Burst] = deque()  # bursts in transit to the host
        self.expose(faults)

    def expose(self, faults: FaultPlan) -> None:
        """Simulate the faults of a plan from now on.

        Wire faults replace the earlier ones.
        """
        now = self._plant.time
        self._wire_faults = WireFaults(faults, since=now)
        self._outages = [(now + fault.start, now + fault.end) for fault in faults.of(frozenset({"unplug"}))]
        self._plant.expose(self._servos, faults)

    def plugged(self, time: float) -> bool:
        """Return whether the adapter is plugged in at a time [s]."""
        return not any(start <= time < end for start, end in self._outages)

    def next_outage(self, time: float) -> float:
        """Return the time [s] of the adapter's next unplugging, or infinity."""
        return min((start for start, _ in self._outages if start > time), default=inf)

    def unplug(self) -> None:
        """Discard all bytes in transit when the adapter is unplugged."""
        self._coming.clear()
        self._reader.clear()

    def advance(self, time: float) -> None:
        """Advance the servos to a time [s]."""
        self._plant.advance(time)

    def send(self, data: bytes | bytearray, time: float) -> None:
        """Transmit bytes of the host to the servos, and queue replies.

        Args:
            data: the bytes.
            time: [s] when the host passes them on.
        """
        byte = BITS_PER_BYTE / self.baud
        clock = max(time, self._sent_until)
        for part in split_frames(bytes(data)) if self._uses_frames else _parts(bytes(data)):
            begun, clock = clock, clock + byte * len(part)
            if begun < self._replied_until:
                self._collide(begun, clock)
                continue
            for packet in self._reader.feed(self._wire_faults.request(part, clock)):
                self._replied_until = self._answer(packet, clock, byte)
        self._sent_until = clock

    def arrives(self) -> float:
        """Return the time [s] at which the next bytes arrive, or infinity."""
        return self._coming[0].arrival if self._coming else inf

    def receive(self, time: float) -> bytes:
        """Return all bytes that have arrived by a time [s]."""
        coming, received = self._coming, bytearray()
        while coming and coming[0].arrival <= time:
            received += coming.popleft().data
        return bytes(received)

    def _collide(self, begun: float, ended: float) -> None:
        """Drop unparsed host bytes, and reply bytes sent during an overlap [s]."""
        self._reader.clear()
        remaining = (piece.without(begun, ended) for piece in self._coming)
        self._coming = deque(piece for piece in remaining if piece.data)

    def _answer(self, packet: Packet, clock: float, byte: float) -> float:
        """Execute a packet on the servos and queue their replies.

        Returns the end [s] of their replies.
        """
        self._plant.advance(clock)
        hearing: dict[int, list[VirtualServo]] = {}
        aliases: dict[int, list[VirtualServo]] = {}
        for servo in self._servos:
            baud, id, alias = servo.station
            if baud == self.baud and servo.electronics.up:
                servo.electronics.hear(clock)
                hearing.setdefault(id, []).append(servo)
                if alias is not None:
                    aliases.setdefault(alias, []).append(servo)
        replies = frame_answers(packet, hearing) if self._uses_frames else answers(packet, hearing)
        transmissions = self._wire_faults.replies(replies, clock)
        obey_aliases(packet, aliases)
        return self._deliver(transmissions, clock, byte)

    def _deliver(self, transmissions: list[Transmission], clock: float, byte: float) -> float:
        """Split transmissions into the adapter's bursts, and return the end time [s]."""
        piece, late = bytearray(), 0.0
        full = min(USB_PACKET_SIZE, max(1, int(self._latency / byte))) if self._latency else USB_PACKET_SIZE
        for part in transmissions:
            clock += part.delay
            late = max(late, part.late)
            data = part.data
            while len(piece) + len(data) >= full:
                room = full - len(piece)
                clock += byte * room
                self._post(Burst(clock + late, clock, byte, bytes(piece + data[:room])))
                piece.clear()
                data = data[room:]
            clock += byte * len(data)
            piece += data
        if piece:
            self._post(Burst(clock + self._latency + late, clock, byte, bytes(piece)))
        return clock

    def _post(self, piece: "Burst") -> None:
        """Queue a burst of bytes for delivery to the host.

        It never arrives before an earlier one.
        """
        last = self._coming[-1].arrival if self._coming else -inf
        self._coming.append(piece._replace(arrival=max(piece.arrival, last)))


class Burst(NamedTuple):
    """Bytes that the adapter delivers at once."""

    arrival: float  # [s] time of arrival at the host
    ended: float  # [s] time at which the last byte ends on the wire
    byte: float  # [s] transmission time of a byte
    data: bytes

    def without(self, begun: float, ended: float) -> "Burst":
        """Remove the bytes transmitted between two times [s].

        Pauses inside the burst are neglected.
        """
        count = len(self.data)
        first, last = (count - round((self.ended - time) / self.byte) for time in (begun, ended))
        first, last = max(0, min(first, count)), max(0, min(last, count))
        return self._replace(data=self.data[:first] + self.data[last:])


def _parts(data: bytes) -> Iterator[bytes]:
    """Split transmitted bytes into packets.

    Every packet then has its own end time.
    """
    start = 0
    while (end := data.find(PACKET_HEADER, start + 1)) >= 0:
        yield data[start:end]
        start = end
    if start < len(data):
        yield data[start:]
