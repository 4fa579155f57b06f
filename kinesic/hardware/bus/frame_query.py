"""Queries for the records of servos with Protocol 1.0 frames.

A reply has the sensors of a servo, and in a full query the registers from the torque switch on. These servos have no
clock: the time of the query takes its place, so that replies have an order. Their checksum lets one random error in 256
pass, so the plausibility filter matters more than with Protocol 2.0.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from kinesic.body.arrays import Flags
from kinesic.hardware.bus.cycle import BLOCK_DTYPE, Records
from kinesic.hardware.bus.query import Query, ServoReplies
from kinesic.hardware.protocol.frame import (
    FRAME_OVERHEAD,
    bulk_read_frame,
    find_frames,
    read_frame,
    sync_read_frame,
)
from kinesic.hardware.protocol.packet import ALERT_BIT, Packet
from kinesic.hardware.protocol.registers import CLOCK_WRAP, Register
from kinesic.hardware.protocol.tables import FamilyTable

MILLISECONDS_PER_SECOND = 1000


@dataclass(frozen=True)
class FrameQuery(Query):
    """Query of one or more servos of a family."""

    table: FamilyTable
    full: bool  # whether the query also reads the torque switch
    clock: int = 0  # [ms] time of the query, which takes the place of the servos' clock
    torque: tuple[int, ...] = ()  # torque switch of each servo by its last full record, for a query without it
    chained: ClassVar[bool] = False

    @cached_property
    def span(self) -> tuple[int, int]:
        """First address and size of the registers that are read."""
        return self.table.record_span if self.full else self.table.sensor_span

    @cached_property
    def data(self) -> bytes:
        """Bytes of the read, sync read or bulk read frame."""
        start, size = self.span
        if len(self.servos) == 1:
            return read_frame(self.servos[0], start, size)
        collective = sync_read_frame if self.table.collective == "sync" else bulk_read_frame
        return collective(self.servos, start, size)

    @cached_property
    def length(self) -> int:
        """Total length of all servos' replies [bytes]."""
        return (FRAME_OVERHEAD + self.span[1]) * len(self.servos)

    def at(self, time: float, torque: tuple[int, ...]) -> "FrameQuery":
        """Return the query with its time [s] and last known torque switches."""
        return replace(self, clock=int(time * MILLISECONDS_PER_SECOND) % CLOCK_WRAP, torque=torque)

    def parse(self, raw: bytes) -> ServoReplies:
        """Collect the status frames of the queried servos from received bytes."""
        blocks: Records = np.zeros(len(self.servos), dtype=BLOCK_DTYPE)
        received: Flags = np.zeros(len(self.servos), dtype=np.bool_)
        end = 0
        for status, offset in find_frames(raw):
            if status.id in self.servos and len(status.parameters) == self.span[1]:
                place = self.servos.index(status.id)
                blocks[place] = self._block(place, status)
                received[place], end = True, offset
        missing = int((~received).sum())
        end = len(raw) if missing else end
        lacking = (FRAME_OVERHEAD + self.span[1]) * missing
        return ServoReplies(blocks, received, missing == 0, end + lacking)

    def is_complete(self, raw: bytes) -> bool:
        """Return whether the bytes end with the last servo's intact status."""
        size = FRAME_OVERHEAD + self.span[1]
        return any(
            status.id == self.servos[-1] and offset == size and len(status.parameters) == self.span[1]
            for status, offset in find_frames(raw[-size:])
        )

    def _block(self, place: int, status: Packet) -> tuple[int, ...]:
        """Convert a servo's status frame to a record in X series units."""
        start, data, table = self.span[0], status.parameters, self.table

        def value(register: Register) -> int:
            field = table.fields[register]
            return table.unpack(register, data[field.address - start : field.end - start])

        errors = table.hardware_errors(status.instruction)  # the error byte of a status takes an instruction's place
        if table.has(Register.HARDWARE_ERROR_STATUS):
            errors |= value(Register.HARDWARE_ERROR_STATUS)
        known = self.torque[place] if self.torque else 0
        return (
            ALERT_BIT if errors else 0,
            status.id,
            value(Register.TORQUE_ENABLE) if self.full else known,
            errors,
            0,
            self.clock,
            value(Register.PRESENT_CURRENT),
            value(Register.PRESENT_VELOCITY),
            value(Register.PRESENT_POSITION),
            value(Register.PRESENT_INPUT_VOLTAGE),
            value(Register.PRESENT_TEMPERATURE),
            0,
        )
