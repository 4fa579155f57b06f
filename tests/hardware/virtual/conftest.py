from collections.abc import Callable

import pytest

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import Packet, Reader
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.servo import VirtualServo
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

REPLY_WAIT = 0.004  # [s] time during which the host waits for replies


class Line:
    """Wire in memory with servos."""

    def __init__(self, cable: Cable) -> None:
        self.plant, buses = build_bus([cable])
        self.bus = buses[cable.name]
        self.wire = MemoryWire(self.bus)

    @property
    def servo(self) -> VirtualServo:
        return self.plant.servos[0]

    def bytes(self, data: bytes, wait: float = REPLY_WAIT) -> bytes:
        """Send bytes, and return all received bytes."""
        self.wire.write(data)
        limit, got = self.wire.now() + wait, b""
        while came := self.wire.read(limit):
            got += came
        return got

    def ask(self, data: bytes) -> list[Packet]:
        """Send bytes, and return the received packets."""
        return list(Reader().feed(self.bytes(data)))

    def error(self, data: bytes) -> int:
        (status,) = self.ask(data)
        return status.error

    def set(self, register: Register, value: int, servo: int = 1) -> int:
        """Write a register, and return the error byte."""
        return self.error(packet.write_packet(servo, register.field.address, register.field.pack(value)))

    def get(self, register: Register, servo: int = 1) -> int:
        """Read a register."""
        (status,) = self.ask(packet.read_packet(servo, register.field.address, register.field.size))
        return register.field.unpack(status.data)

    def pass_time(self, seconds: float) -> None:
        """Let time pass without instructions."""
        self.wire.sleep(self.wire.now() + seconds)
        self.bus.advance(self.wire.now())


def line_of(*servos: int, **changes: object) -> Line:
    fittings = [ServoFitting(servo, **changes) for servo in servos or (1,)]
    return Line(Cable("body", tuple(fittings)))


@pytest.fixture
def line() -> Callable[..., Line]:
    """Return a function that makes a line of new servos with the given ids."""
    return line_of
