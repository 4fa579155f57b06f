"""Independent servos on one wire in memory."""

from collections.abc import Callable, Sequence

import pytest

from ...manual_servo import packet as p
from ...manual_servo.device import Device
from ...manual_servo.line import Line, World
from ...manual_servo.packet import Decoder, Packet

REPLY_WAIT = 0.02  # [s] time during which the host waits for replies


class Bench:
    """Wire with independent servos, and a host that waits for replies."""

    def __init__(self, ids: Sequence[int], model: str) -> None:
        self.devices = [Device(servo, model) for servo in ids]
        self.line = Line(World(self.devices), self.devices)

    @property
    def device(self) -> Device:
        return self.devices[0]

    def raw(self, data: bytes, wait: float = REPLY_WAIT) -> bytes:
        """Send bytes, and return all received bytes."""
        self.line.send(data, self.line.world.time)
        self.rest(wait)
        return self.line.receive(self.line.world.time)

    def ask(self, servo: int, instruction: int, parameters: bytes = b"") -> list[Packet]:
        """Send bytes, and return the received packets."""
        return Decoder().feed(self.raw(p.instruct(servo, instruction, parameters)), self.line.world.time)

    def read(self, name: str, servo: int = 1) -> tuple[int, int]:
        """Read a register over the wire, and return error byte and value."""
        item = self.device.memory.item(name)
        (said,) = self.ask(servo, p.READ, words(item.address, item.size))
        return said.parameters[0], int.from_bytes(said.parameters[1:], "little", signed=item.signed)

    def write(self, name: str, value: int, servo: int = 1) -> int:
        """Write a register, and return the error byte (-1: no reply)."""
        item = self.device.memory.item(name)
        octets = value.to_bytes(item.size, "little", signed=value < 0)
        said = self.ask(servo, p.WRITE, words(item.address) + octets)
        return said[0].parameters[0] if said else -1

    def rest(self, seconds: float) -> None:
        self.line.world.advance(self.line.world.time + seconds)


def words(*values: int) -> bytes:
    """Encode 16-bit words with the low byte first."""
    return b"".join(value.to_bytes(2, "little") for value in values)


@pytest.fixture
def bench() -> Callable[..., Bench]:
    """Return a function that makes a wire with servos of the given ids."""
    return lambda *ids, model="xm430_w210": Bench(ids or (1,), model)
