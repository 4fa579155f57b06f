"""lerobot's Dynamixel bus as a driver of the fault matrix, where lerobot is installed."""

# ruff: noqa: N802  # overrides bear the names of the SDK

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.bus.bus import Servo
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.virtual.drivers import NEVER, DriverReading, PlainPort

MODULE = "lerobot.motors.dynamixel"
MOTORS = "lerobot.motors"


class _Group(Protocol):
    port: PlainPort


class _Motors(Protocol):
    """What is used of lerobot's bus."""

    port_handler: PlainPort
    sync_reader: _Group
    sync_writer: _Group

    def connect(self, handshake: bool = True) -> None: ...

    def sync_write(self, data_name: str, values: Mapping[str, int], *, normalize: bool, num_retry: int) -> None: ...

    def sync_read(self, data_name: str, *, normalize: bool, num_retry: int) -> dict[str, int]: ...


class LerobotPort(PlainPort):
    """The SDK's port, on a wire that opens when lerobot says so."""

    def __init__(self, wire: Wire) -> None:
        """Not open yet."""
        super().__init__(wire)
        self.is_open = False

    def openPort(self) -> bool:
        """The wire is there."""
        self.is_open = True
        return True


def missing() -> str:
    """Why lerobot cannot be driven; empty if it can."""
    try:
        import_module(MODULE)
    except ImportError as error:
        return f"lerobot is not installed: {error}"
    return ""


class LerobotDriver:
    """`sync_write` of goals and `sync_read` of positions, on a virtual wire's clock."""

    name = "lerobot"

    def __init__(self, wire: Wire, servos: Sequence[Servo], period: float, *, retries: int = 0) -> None:
        """Connects as lerobot does, which asks every servo who it is.

        Raises:
            BusError: lerobot refuses these servos.
            ImportError: it is not installed.
        """
        del period
        self._wire, self._retries = wire, retries
        self._names = [f"servo{servo.id}" for servo in servos]
        self._positions: Ticks = np.zeros(len(servos), dtype=np.int64)
        self._times: Floats = np.full(len(servos), NEVER)
        self._motors = _motors(wire, dict(zip(self._names, servos, strict=True)))
        try:
            self._motors.connect()
        except (RuntimeError, ConnectionError) as error:
            raise BusError(" ".join(str(error).partition("\nFull expected")[0].split())) from None

    def cycle(self, goals: Ticks) -> DriverReading:
        """See `Driver`."""
        told = dict(zip(self._names, goals.tolist(), strict=True))
        self._motors.sync_write("Goal_Position", told, normalize=False, num_retry=self._retries)
        found = self._motors.sync_read("Present_Position", normalize=False, num_retry=self._retries)
        self._positions = np.array([found[name] for name in self._names], dtype=np.int64)
        self._times = np.full(len(self._names), self._wire.now())
        every: Flags = np.ones(len(self._names), dtype=np.bool_)
        return DriverReading(self._positions, self._times, every, ~every, ~every)


def _motors(wire: Wire, servos: Mapping[str, Servo]) -> _Motors:
    """Lerobot's bus, whose port is a wire."""
    dynamixel, motors = import_module(MODULE), import_module(MOTORS)
    way = motors.MotorNormMode.DEGREES
    known = {name: motors.Motor(each.id, each.model.name.replace("_", "-"), way) for name, each in servos.items()}
    found: _Motors = dynamixel.DynamixelMotorsBus(port=wire.name, motors=known)
    found.port_handler = found.sync_reader.port = found.sync_writer.port = LerobotPort(wire)
    return found
