"""Faults of the wire: lost, changed, added and delayed bytes, pulled plugs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from random import Random
from typing import TYPE_CHECKING

from . import packet as p

if TYPE_CHECKING:
    from .device import Answer, Device
    from .line import Line

Flying = list[tuple[float, bytes]]  # (delay [s], bytes) of each part of a transmission


class Fault:
    """Temporary fault; the base class changes nothing."""

    def begin(self, line: Line) -> None:
        """Apply the fault to a wire when it starts."""

    def end(self, line: Line) -> None:
        """Undo the fault on a wire when it ends."""

    def echo(self, line: Line, data: bytes, time: float) -> None:
        """React to bytes of the host whose transmission ends at a time [s]."""

    def request(self, data: bytes) -> bytes:
        """Return the bytes that servos receive from the host."""
        return data

    def say(self, device: Device, answer: Answer) -> Answer | None:
        """Return the answer that a servo sends instead of its own."""
        return answer

    def frame(self, device: Device, data: bytes) -> bytes:
        """Return the bytes that a servo sends instead of its packet."""
        return data

    def carry(self, device: Device, data: bytes) -> Flying:
        """Return the bytes of a servo that reach the host."""
        return [(0.0, data)]


@dataclass
class Spoiled(Fault):
    """Fault that changes a fraction of the transmissions with its method `spoil`."""

    share: float = 1.0
    servos: tuple[int, ...] = ()  # ids of the affected servos; empty means all
    seed: int = 1
    rng: Random = field(init=False)

    def __post_init__(self) -> None:
        self.rng = Random(self.seed)

    def carry(self, device: Device, data: bytes) -> Flying:
        mine = not self.servos or device.id in self.servos
        return self.spoil(data) if mine and self.rng.random() < self.share else [(0.0, data)]

    def spoil(self, data: bytes) -> Flying:
        """Return the changed bytes."""
        return [(0.0, data)]


class Garble(Spoiled):
    """Transmission with flipped bits."""

    def spoil(self, data: bytes) -> Flying:
        spoiled = bytearray(data)
        for _ in range(self.rng.randint(1, 3)):
            spoiled[self.rng.randrange(len(data))] ^= 1 << self.rng.randrange(8)
        return [(0.0, bytes(spoiled))]


class Truncate(Spoiled):
    """Transmission without its end."""

    def spoil(self, data: bytes) -> Flying:
        return [(0.0, data[: self.rng.randrange(len(data))])]


class DropByte(Spoiled):
    """Transmission with one byte missing."""

    def spoil(self, data: bytes) -> Flying:
        at = self.rng.randrange(len(data))
        return [(0.0, data[:at] + data[at + 1 :])]


class Insert(Spoiled):
    """Transmission with additional bytes inside."""

    def spoil(self, data: bytes) -> Flying:
        at = self.rng.randrange(len(data))
        return [(0.0, data[:at] + self.rng.randbytes(self.rng.randint(1, 4)) + data[at:])]


class Duplicate(Spoiled):
    """Transmission that is sent twice."""

    def spoil(self, data: bytes) -> Flying:
        return [(0.0, data), (0.0, data)]


class Lose(Spoiled):
    """Transmission that is lost."""

    def spoil(self, data: bytes) -> Flying:
        return []


class Mirror(Spoiled):
    """Transmission whose bytes have reversed bit order."""

    def spoil(self, data: bytes) -> Flying:
        return [(0.0, bytes(int(f"{byte:08b}"[::-1], 2) for byte in data))]


@dataclass
class Late(Spoiled):
    """Transmission that arrives late."""

    delay: float = 0.012  # [s]

    def spoil(self, data: bytes) -> Flying:
        return [(self.delay, data)]


@dataclass
class Replay(Spoiled):
    """Transmission replaced by an earlier transmission of the servo."""

    age: int = 5
    kept: list[bytes] = field(default_factory=list)

    def carry(self, device: Device, data: bytes) -> Flying:
        if self.servos and device.id not in self.servos:
            return [(0.0, data)]
        self.kept.append(data)
        return [(0.0, self.kept[-self.age] if len(self.kept) >= self.age else data)]


class LostRequest(Spoiled):
    """Loss of a fraction of the host's requests."""

    def carry(self, device: Device, data: bytes) -> Flying:
        return [(0.0, data)]

    def request(self, data: bytes) -> bytes:
        return data[: self.rng.randrange(len(data))] if self.rng.random() < self.share else data


class Echo(Fault):
    """Echo of the host's bytes, as from an adapter with an open receiver."""

    def echo(self, line: Line, data: bytes, time: float) -> None:
        line.post(data, time + line.latency)


@dataclass
class Flood(Fault):
    """Unterminated line that adds noise between packets."""

    octets: int = 200
    seed: int = 1

    def echo(self, line: Line, data: bytes, time: float) -> None:
        line.post(Random(self.seed + round(1e6 * time)).randbytes(self.octets), time + line.latency / 2)


@dataclass
class FrozenLink(Fault):
    """Adapter that delays all bytes in both directions until the fault ends."""

    held: list[bytes] = field(default_factory=list)

    def request(self, data: bytes) -> bytes:
        return b""

    def carry(self, device: Device, data: bytes) -> Flying:
        self.held.append(data)
        return []

    def end(self, line: Line) -> None:
        line.post(b"".join(self.held), line.world.time + line.latency)


class SilentAll(Fault):
    """Servos that all receive without replying."""

    def say(self, device: Device, answer: Answer) -> None:
        return None


class Unplugged(Fault):
    """Adapter that is unplugged and plugged in again."""

    def begin(self, line: Line) -> None:
        line.plugged = False
        line.drop()

    def request(self, data: bytes) -> bytes:
        return b""

    def end(self, line: Line) -> None:
        line.plugged = True


@dataclass
class Replugged(Unplugged):
    """Adapter replaced under the same device name by the adapter of another robot."""

    others: Sequence[Device]

    def end(self, line: Line) -> None:
        line.world.devices += tuple(self.others)
        line.devices = list(self.others)
        super().end(line)


@dataclass
class WrongId(Fault):
    """Servo that replies with another servo's id."""

    servo: int
    instead: int

    def say(self, device: Device, answer: Answer) -> Answer:
        return replace(answer, servo=self.instead) if device.id == self.servo else answer


@dataclass
class BadCrc(Fault):
    """Servo that always sends a wrong CRC."""

    servo: int

    def frame(self, device: Device, data: bytes) -> bytes:
        return data[:-1] + bytes([data[-1] ^ 0x5A]) if device.id == self.servo else data


@dataclass
class WrongLength(Fault):
    """Intact replies with one byte less than requested."""

    servo: int

    def say(self, device: Device, answer: Answer) -> Answer:
        short = len(answer.parameters) > 1 and device.id == self.servo
        return replace(answer, parameters=answer.parameters[:-1]) if short else answer


@dataclass
class Misquoted(Fault):
    """Replies whose length field does not equal their length."""

    servo: int

    def frame(self, device: Device, data: bytes) -> bytes:
        if device.id != self.servo or not data.startswith(p.PACKET_HEADER):
            return data
        return p.sealed(data[:5] + (data[5] + 3 & 0xFF).to_bytes(1, "little") + data[6:-2])
