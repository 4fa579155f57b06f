"""Drivers that the fault matrix compares: kinesic's bus, dynamixel-sdk and lerobot."""

# ruff: noqa: N802  # overridden methods keep the SDK's names

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from math import inf
from typing import Protocol

import numpy as np
from dynamixel_sdk import COMM_SUCCESS, GroupSyncRead, GroupSyncWrite, PortHandler, Protocol2PacketHandler

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.sdk import WirePort
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError, Wire

NEVER_READ = -inf  # [s] reading time of a servo that has not answered yet
LEROBOT_MODULE = "lerobot.motors"
LEROBOT_BUS_MODULE = "lerobot.motors.dynamixel"


@dataclass(frozen=True, eq=False)
class DriverReading:
    """Servo positions with timestamps, and hardware errors, reported by a driver."""

    positions: Ticks  # (n,)
    times: Floats  # (n,) [s] time on the wire's clock when each position was taken; NEVER_READ if none was
    fresh: Flags  # (n,) whether the position was taken in this cycle
    late: Flags  # (n,) whether an earlier cycle's position arrived in this cycle, with its correct time
    alerts: Flags  # (n,) whether a hardware error is reported


class Driver(Protocol):
    """A servo driver that writes goals and reads positions once per period."""

    def cycle(self, goals: Ticks) -> DriverReading:
        """Send goals to all servos and read their positions.

        Goals are (n,) ticks.
        """


class KinesicDriver:
    """Driver on top of kinesic's own bus."""

    name = "kinesic"

    def __init__(self, wire: Wire, servos: Sequence[Servo], period: float) -> None:
        """Check and prepare the servos.

        Raises:
            BusError: the servos differ from the expected ones.
        """
        self._bus = open_bus(wire, servos, period=period)

    def cycle(self, goals: Ticks) -> DriverReading:
        """Send goals and read positions in one cycle of kinesic's bus."""
        cycle = self._bus.cycle(goals)
        alerts = cycle.raw_values("hardware_error") != 0
        return DriverReading(cycle.positions, cycle.times, cycle.fresh, cycle.late, alerts)


class PlainPort(WirePort):
    """Port of dynamixel-sdk on a virtual wire, with the SDK's own timeouts.

    The timeout is the bytes' time plus twice the latency timer of 16 ms plus 2 ms.
    """

    def setPacketTimeout(self, packet_length: int) -> None:
        """Set the timeout exactly as the SDK does."""
        PortHandler.setPacketTimeout(self, packet_length)


class SdkDriver:
    """Driver of the unmodified dynamixel-sdk on a virtual wire."""

    name = "dynamixel-sdk"

    def __init__(self, wire: Wire, servos: Sequence[Servo], period: float, *, fast: bool = False) -> None:
        """Prepare the SDK's group instructions without checking any servo.

        The SDK's examples do the same.
        """
        del period
        self._wire, self._ids, self._fast = wire, [servo.id for servo in servos], fast
        port, protocol = PlainPort(wire), Protocol2PacketHandler()
        goal, position = Register.GOAL_POSITION.field, Register.PRESENT_POSITION.field
        self._goals = GroupSyncWrite(port, protocol, goal.address, goal.size)
        self._position_group = GroupSyncRead(port, protocol, position.address, position.size)
        for servo in self._ids:
            self._position_group.addParam(servo)
        self._positions: Ticks = np.zeros(len(servos), dtype=np.int64)
        self._times: Floats = np.full(len(servos), NEVER_READ)

    def cycle(self, goals: Ticks) -> DriverReading:
        """Send goals and read positions with the SDK's group instructions."""
        self._goals.clearParam()
        for servo, goal in zip(self._ids, goals.tolist(), strict=True):
            self._goals.addParam(servo, list(Register.GOAL_POSITION.field.pack(goal)))
        self._goals.txPacket()
        result = self._position_group.fastSyncRead() if self._fast else self._position_group.txRxPacket()
        fresh: Flags = np.full(len(self._ids), result == COMM_SUCCESS)
        if result == COMM_SUCCESS:
            field = Register.PRESENT_POSITION.field
            raw = [self._position_group.getData(servo, field.address, field.size) for servo in self._ids]
            self._positions = np.array(raw, dtype=np.uint32).astype(np.int32).astype(np.int64)
            self._times = np.full(len(self._ids), self._wire.now())
        none: Flags = np.zeros(len(self._ids), dtype=np.bool_)
        return DriverReading(self._positions, self._times, fresh, none, none)


class _Group(Protocol):
    port: PlainPort


class _Motors(Protocol):
    """Attributes and methods of lerobot's motor bus that the driver uses."""

    port_handler: PlainPort
    sync_reader: _Group
    sync_writer: _Group

    def connect(self, handshake: bool = True) -> None: ...

    def sync_write(self, data_name: str, values: Mapping[str, int], *, normalize: bool, num_retry: int) -> None: ...

    def sync_read(self, data_name: str, *, normalize: bool, num_retry: int) -> dict[str, int]: ...


class LerobotPort(PlainPort):
    """Port of dynamixel-sdk on a virtual wire, opened by lerobot."""

    def __init__(self, wire: Wire) -> None:
        super().__init__(wire)
        self.is_open = False

    def openPort(self) -> bool:
        """Mark lerobot's port as open.

        Its wire exists already.
        """
        self.is_open = True
        return True


def why_lerobot_is_missing() -> str:
    """Return the reason why lerobot cannot be used.

    The result is empty if it can.
    """
    try:
        import_module(LEROBOT_BUS_MODULE)
    except ImportError as error:
        return f"lerobot is not installed: {error}"
    return ""


class LerobotDriver:
    """Driver by lerobot's `sync_write` of goals and `sync_read` of positions.

    It runs on a virtual wire's clock.
    """

    name = "lerobot"

    def __init__(self, wire: Wire, servos: Sequence[Servo], period: float, *, retries: int = 0) -> None:
        """Connect as lerobot does, which pings every servo.

        Raises:
            BusError: lerobot refuses these servos.
            ImportError: lerobot is not installed.
        """
        del period
        self._wire, self._retries = wire, retries
        self._names = [f"servo{servo.id}" for servo in servos]
        self._make_motor_bus = _make_motor_bus(wire, dict(zip(self._names, servos, strict=True)))
        try:
            self._make_motor_bus.connect()
        except (RuntimeError, ConnectionError) as error:
            raise BusError(" ".join(str(error).partition("\nFull expected")[0].split())) from None

    def cycle(self, goals: Ticks) -> DriverReading:
        """Send goals and read positions with lerobot's group instructions."""
        goals_by_name = dict(zip(self._names, goals.tolist(), strict=True))
        self._make_motor_bus.sync_write("Goal_Position", goals_by_name, normalize=False, num_retry=self._retries)
        answers = self._make_motor_bus.sync_read("Present_Position", normalize=False, num_retry=self._retries)
        positions: Ticks = np.array([answers[name] for name in self._names], dtype=np.int64)
        fresh: Flags = np.ones(len(self._names), dtype=np.bool_)
        return DriverReading(positions, np.full(len(self._names), self._wire.now()), fresh, ~fresh, ~fresh)


def _make_motor_bus(wire: Wire, servos: Mapping[str, Servo]) -> _Motors:
    """Return lerobot's motor bus with a virtual wire as its port."""
    dynamixel, motors = import_module(LEROBOT_BUS_MODULE), import_module(LEROBOT_MODULE)
    mode = motors.MotorNormMode.DEGREES
    listed = {name: motors.Motor(servo.id, servo.model.name.replace("_", "-"), mode) for name, servo in servos.items()}
    bus: _Motors = dynamixel.DynamixelMotorsBus(port=wire.name, motors=listed)
    bus.port_handler = bus.sync_reader.port = bus.sync_writer.port = LerobotPort(wire)
    return bus
