"""Drives servos as the fault matrix compares it: by kinesic's bus, by dynamixel-sdk as it comes, and by lerobot."""

# ruff: noqa: N802  # overrides bear the names of the SDK

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from math import inf
from typing import Protocol

import numpy as np
from dynamixel_sdk import COMM_SUCCESS, GroupSyncRead, GroupSyncWrite, PortHandler, Protocol2PacketHandler

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.bus import Servo
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.sdk import WirePort
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError, Wire

NEVER = -inf  # [s] the time of a servo that has not answered
LEROBOT, LEROBOT_BUS = "lerobot.motors", "lerobot.motors.dynamixel"


@dataclass(frozen=True, eq=False)
class DriverReading:
    """What a driver believes at the end of a cycle."""

    positions: Ticks  # (n,)
    times: Floats  # (n,) [s] on the wire's clock when each was taken; NEVER
    fresh: Flags  # (n,) taken in this cycle
    late: Flags  # (n,) of which a position of an earlier cycle has come in this one, with its right time
    alerts: Flags  # (n,) known to have a hardware error


class Driver(Protocol):
    """A driver of servos: goals out, positions back, once a period."""

    def cycle(self, goals: Ticks) -> DriverReading:
        """Runs one cycle; goals are (n,) ticks."""


class KinesicDriver:
    """The bus of this package."""

    name = "kinesic"

    def __init__(self, wire: Wire, servos: Sequence[Servo], period: float) -> None:
        """Checks and prepares the servos.

        Raises:
            BusError: they are not what they should be.
        """
        self._bus = open_bus(wire, servos, period=period)

    def cycle(self, goals: Ticks) -> DriverReading:
        """See `Driver`."""
        cycle = self._bus.cycle(goals)
        alerts = cycle.each("hardware_error") != 0
        return DriverReading(cycle.positions, cycle.times, cycle.fresh, cycle.late, alerts)


class PlainPort(WirePort):
    """The SDK's port with the SDK's own timeouts: bytes, twice its latency timer of 16 ms, and 2 ms."""

    def setPacketTimeout(self, packet_length: int) -> None:
        """As the SDK does."""
        PortHandler.setPacketTimeout(self, packet_length)


class SdkDriver:
    """Group sync write and group sync read of the unmodified dynamixel-sdk, on a virtual wire's clock."""

    name = "dynamixel-sdk"

    def __init__(self, wire: Wire, servos: Sequence[Servo], period: float, *, fast: bool = False) -> None:
        """Nothing is checked, as the SDK's examples do."""
        del period
        self._wire, self._ids, self._fast = wire, [servo.id for servo in servos], fast
        port, protocol = PlainPort(wire), Protocol2PacketHandler()
        goal, place = Register.GOAL_POSITION.field, Register.PRESENT_POSITION.field
        self._goals = GroupSyncWrite(port, protocol, goal.address, goal.size)
        self._places = GroupSyncRead(port, protocol, place.address, place.size)
        for servo in self._ids:
            self._places.addParam(servo)
        self._positions: Ticks = np.zeros(len(servos), dtype=np.int64)
        self._times: Floats = np.full(len(servos), NEVER)

    def cycle(self, goals: Ticks) -> DriverReading:
        """See `Driver`."""
        self._goals.clearParam()
        for servo, goal in zip(self._ids, goals.tolist(), strict=True):
            self._goals.addParam(servo, list(Register.GOAL_POSITION.field.pack(goal)))
        self._goals.txPacket()
        result = self._places.fastSyncRead() if self._fast else self._places.txRxPacket()
        fresh: Flags = np.full(len(self._ids), result == COMM_SUCCESS)
        if result == COMM_SUCCESS:
            field = Register.PRESENT_POSITION.field
            raw = [self._places.getData(servo, field.address, field.size) for servo in self._ids]
            self._positions = np.array(raw, dtype=np.uint32).astype(np.int32).astype(np.int64)
            self._times = np.full(len(self._ids), self._wire.now())
        none: Flags = np.zeros(len(self._ids), dtype=np.bool_)
        return DriverReading(self._positions, self._times, fresh, none, none)


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
        super().__init__(wire)
        self.is_open = False

    def openPort(self) -> bool:
        """Opens the port, whose wire is there already."""
        self.is_open = True
        return True


def lerobot_missing() -> str:
    """Returns why lerobot cannot be driven; empty if it can."""
    try:
        import_module(LEROBOT_BUS)
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
        self._motors = _motors(wire, dict(zip(self._names, servos, strict=True)))
        try:
            self._motors.connect()
        except (RuntimeError, ConnectionError) as error:
            raise BusError(" ".join(str(error).partition("\nFull expected")[0].split())) from None

    def cycle(self, goals: Ticks) -> DriverReading:
        """See `Driver`."""
        named = dict(zip(self._names, goals.tolist(), strict=True))
        self._motors.sync_write("Goal_Position", named, normalize=False, num_retry=self._retries)
        found = self._motors.sync_read("Present_Position", normalize=False, num_retry=self._retries)
        positions: Ticks = np.array([found[name] for name in self._names], dtype=np.int64)
        every: Flags = np.ones(len(self._names), dtype=np.bool_)
        return DriverReading(positions, np.full(len(self._names), self._wire.now()), every, ~every, ~every)


def _motors(wire: Wire, servos: Mapping[str, Servo]) -> _Motors:
    """Lerobot's bus, whose port is a wire."""
    dynamixel, motors = import_module(LEROBOT_BUS), import_module(LEROBOT)
    way = motors.MotorNormMode.DEGREES
    known = {name: motors.Motor(each.id, each.model.name.replace("_", "-"), way) for name, each in servos.items()}
    found: _Motors = dynamixel.DynamixelMotorsBus(port=wire.name, motors=known)
    found.port_handler = found.sync_reader.port = found.sync_writer.port = LerobotPort(wire)
    return found
