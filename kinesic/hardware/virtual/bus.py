"""Simulates a half-duplex wire with virtual servos on it: bytes and their times in, bytes and their times out.

The clock is the caller's, so that time may be real or virtual. Bytes take ten bits each; the host's adapter hands on
what it has when `PIECE` bytes are full, or when its latency timer has run since it did so last (FTDI, AN232B-04); the
last ones wait for the whole timer. Who talks into a reply spoils both: the servos do not understand the packet, and the
adapter does not hear what they say meanwhile.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from math import inf
from typing import NamedTuple

from kinesic.hardware.protocol.packet import HEADER, Packet, Reader
from kinesic.hardware.protocol.wire import BITS_PER_BYTE
from kinesic.hardware.virtual.faults import CALM, FaultPlan, Transmission, WireFaults
from kinesic.hardware.virtual.protocol import answers, obey_aliases
from kinesic.hardware.virtual.servo import VirtualServo
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation

PIECE = 62  # [bytes] of one USB packet of a common adapter
LATENCY = 0.001  # [s] of its timer, set low as it should be


class VirtualBus:
    """A wire whose servos hear everything that is said on it."""

    def __init__(
        self,
        plant: ShaftSimulation,
        servos: Sequence[VirtualServo],
        *,
        baud: int,
        latency: float = LATENCY,
        faults: FaultPlan = CALM,
    ) -> None:
        """Connects servos of a plant.

        Args:
            plant: moves them through time.
            servos: on this wire.
            baud: [bit/s] that the host talks.
            latency: [s] of the adapter's timer.
            faults: of this wire and its servos.
        """
        self.baud = baud
        self._plant, self._servos = plant, tuple(servos)
        self._latency = latency
        self._reader = Reader()
        self._said = self._answered = plant.time  # [s] when host and servos have said all
        self._coming: deque[Piece] = deque()  # to the host
        self.expose(faults)

    def expose(self, faults: FaultPlan) -> None:
        """Exposes the wire and its servos to faults from now on; those of the wire replace earlier ones."""
        now = self._plant.time
        self._wire_faults = WireFaults(faults, since=now)
        self._outages = [(now + fault.start, now + fault.end) for fault in faults.of(frozenset({"unplug"}))]
        self._plant.expose(self._servos, faults)

    def plugged(self, time: float) -> bool:
        """Returns whether the adapter is there at a time [s]."""
        return not any(start <= time < end for start, end in self._outages)

    def next_outage(self, time: float) -> float:
        """Returns when [s] the adapter is pulled next; infinite if it stays."""
        return min((start for start, _ in self._outages if start > time), default=inf)

    def unplug(self) -> None:
        """Forgets everything that is under way."""
        self._coming.clear()
        self._reader.clear()

    def advance(self, time: float) -> None:
        """Lets time pass for the servos [s]."""
        self._plant.advance(time)

    def send(self, data: bytes | bytearray, time: float) -> None:
        """Takes what the host sends.

        Args:
            data: its bytes.
            time: [s] when it hands them over.
        """
        byte = BITS_PER_BYTE / self.baud
        clock = max(time, self._said)
        for part in _parts(bytes(data)):
            begun, clock = clock, clock + byte * len(part)
            if begun < self._answered:
                self._collide(begun, clock)
                continue
            for packet in self._reader.feed(self._wire_faults.request(part, clock)):
                self._answered = self._answer(packet, clock, byte)
        self._said = clock

    def arrives(self) -> float:
        """Returns when [s] the host gets the next bytes; infinite if none are under way."""
        return self._coming[0].arrival if self._coming else inf

    def receive(self, time: float) -> bytes:
        """Returns all that the host has got by a time [s]."""
        coming, had = self._coming, bytearray()
        while coming and coming[0].arrival <= time:
            had += coming.popleft().data
        return bytes(had)

    def _collide(self, begun: float, ended: float) -> None:
        """The host talks while servos do: nobody hears what is said meanwhile."""
        self._reader.clear()
        spoilt = (piece.without(begun, ended) for piece in self._coming)
        self._coming = deque(piece for piece in spoilt if piece.data)

    def _answer(self, packet: Packet, clock: float, byte: float) -> float:
        """Lets the servos obey and answer; the time [s] when the wire is silent again."""
        self._plant.advance(clock)
        hearing: dict[int, list[VirtualServo]] = {}
        aliases: dict[int, list[VirtualServo]] = {}
        for servo in self._servos:
            if servo.electronics.up and servo.baud == self.baud:
                servo.electronics.hear(clock)
                hearing.setdefault(servo.id, []).append(servo)
                if servo.alias is not None:
                    aliases.setdefault(servo.alias, []).append(servo)
        transmissions = self._wire_faults.replies(answers(packet, hearing), clock)
        obey_aliases(packet, aliases)
        return self._deliver(transmissions, clock, byte)

    def _deliver(self, transmissions: list[Transmission], clock: float, byte: float) -> float:
        """Cuts what comes along the wire into the adapter's pieces."""
        piece, late = bytearray(), 0.0
        full = min(PIECE, max(1, int(self._latency / byte))) if self._latency else PIECE
        for part in transmissions:
            clock += part.delay
            late = max(late, part.late)
            data = part.data
            while len(piece) + len(data) >= full:
                room = full - len(piece)
                clock += byte * room
                self._post(Piece(clock + late, clock, byte, bytes(piece + data[:room])))
                piece.clear()
                data = data[room:]
            clock += byte * len(data)
            piece += data
        if piece:
            self._post(Piece(clock + self._latency + late, clock, byte, bytes(piece)))
        return clock

    def _post(self, piece: "Piece") -> None:
        """Nothing overtakes."""
        last = self._coming[-1].arrival if self._coming else -inf
        self._coming.append(piece._replace(arrival=max(piece.arrival, last)))


class Piece(NamedTuple):
    """What the adapter hands to the host at once."""

    arrival: float  # [s]
    ended: float  # [s] when its last byte was on the wire
    byte: float  # [s] of each
    data: bytes

    def without(self, begun: float, ended: float) -> "Piece":
        """Drops the bytes that were on the wire between two times [s]; gaps in it are neglected."""
        count = len(self.data)
        first, last = (count - round((self.ended - time) / self.byte) for time in (begun, ended))
        first, last = max(0, min(first, count)), max(0, min(last, count))
        return self._replace(data=self.data[:first] + self.data[last:])


def _parts(data: bytes) -> Iterator[bytes]:
    """Cuts bytes before each header, so that every packet ends at its own time."""
    start = 0
    while (end := data.find(HEADER, start + 1)) >= 0:
        yield data[start:end]
        start = end
    if start < len(data):
        yield data[start:]
