"""Drivers that the fault matrix compares: kinesic's bus, and dynamixel-sdk as it comes."""

# ruff: noqa: N802  # overrides bear the names of the SDK

from collections.abc import Sequence
from dataclasses import dataclass
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
from kinesic.hardware.protocol.wire import Wire

NEVER = -inf  # [s] the time of a servo that has not been heard


@dataclass(frozen=True, eq=False)
class DriverReading:
    """What a driver believes at the end of a cycle."""

    positions: Ticks  # (n,)
    times: Floats  # (n,) [s] on the wire's clock when each was taken; NEVER
    fresh: Flags  # (n,) taken in this cycle
    late: Flags  # (n,) of which a position of an earlier cycle has come in this one, with its right time
    alerts: Flags  # (n,) known to have a hardware error


class Driver(Protocol):
    """Goals out, positions back, once a period."""

    def cycle(self, goals: Ticks) -> DriverReading:
        """One cycle; goals are (n,) ticks."""


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
