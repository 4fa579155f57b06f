"""Encoding of goals, register writes and queries for a servo bus."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.bounds import TickRange
from kinesic.hardware.bus.cycle import Records
from kinesic.hardware.bus.frame_query import FrameQuery
from kinesic.hardware.bus.goals import GoalFrame
from kinesic.hardware.bus.query import Query, make_query
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.frame import FRAME_OVERHEAD, sync_write_frame
from kinesic.hardware.protocol.models import Model
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.tables import FamilyTable
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, BusError

AUDIT_CYCLES = 8  # cycles after which the torque switches are read again, if they do not fit into every cycle
SERVO_TURNAROUND = 50e-6  # [s] assumed pause before the reply of a servo
LATENCY_RESERVE = 0.0015  # [s] time of a cycle for the delays of adapter and host


@dataclass(frozen=True)
class Servo:
    """Servo on a bus: its id, model and goal range."""

    id: int
    model: Model
    span: TickRange = (0, TICKS_PER_TURN - 1)  # [ticks] range of its goal positions

    @property
    def cells(self) -> int:
        """Address of the servo's record in its indirect data area."""
        return self.model.cells[0].data


class Dialect(ABC):
    """Encoder of the packets for the servos of one bus."""

    has_cells: bool  # whether records are read through indirect cells, which a reboot clears
    collective: bool  # whether one query may address several servos

    @abstractmethod
    def goals(self, goals: Ticks) -> bytes | bytearray:
        """Encode the goal positions (n,) [ticks] of all servos."""

    @abstractmethod
    def write(self, register: Register, values: Mapping[int, int]) -> bytes:
        """Encode the write of a register in several servos, id -> value.

        Raises:
            ValueError: a value does not fit into the register.
        """

    @abstractmethod
    def question(self, places: tuple[int, ...]) -> Query:
        """Return the query for the records of some servos, by their indices."""

    def dated(self, question: Query, time: float, places: Sequence[int], records: Records) -> Query:
        """Return the query as it is sent at a time [s].

        It may depend on the last records.
        """
        return question


class PacketDialect(Dialect):
    """Encoder of Protocol 2.0 packets for the X series."""

    has_cells = collective = True

    def __init__(self, servos: Sequence[Servo], *, fast: bool) -> None:
        """Create the encoder of servos in bus order, optionally with fast reads."""
        self._servos, self._fast = tuple(servos), fast
        self._frame = GoalFrame([servo.id for servo in servos])

    def goals(self, goals: Ticks) -> bytes | bytearray:
        """Encode the goal positions of all servos."""
        return self._frame.fill(goals)

    def write(self, register: Register, values: Mapping[int, int]) -> bytes:
        """Encode the write of a register in several servos."""
        field = register.field
        return packet.sync_write(field.address, field.size, {servo: field.pack(v) for servo, v in values.items()})

    def question(self, places: tuple[int, ...]) -> Query:
        """Return the query for the records of some servos."""
        chosen = [self._servos[k] for k in places]
        servos, cells = tuple(servo.id for servo in chosen), tuple(servo.cells for servo in chosen)
        return make_query(servos, cells, fast=self._fast)


class FrameDialect(Dialect):
    """Encoder of Protocol 1.0 frames for one servo family."""

    has_cells = False

    def __init__(self, servos: Sequence[Servo], table: FamilyTable, *, baud: int, period: float) -> None:
        """Create the encoder of servos in bus order.

        The torque switches are read in every cycle if the wire has time for them.

        Args:
            servos: servos of one family.
            table: control table of the family.
            baud: [bit/s] of the wire.
            period: [s] between cycles.
        """
        self._ids, self._table = tuple(servo.id for servo in servos), table
        self.collective = table.collective != "none"
        duration = cycle_size(table, len(servos), full=True) * BITS_PER_BYTE / baud + len(servos) * SERVO_TURNAROUND
        self._always_full = not self.collective or duration + LATENCY_RESERVE <= period
        self._cycles = 0

    def goals(self, goals: Ticks) -> bytes | bytearray:
        """Encode the goal positions of all servos."""
        clipped = np.clip(goals, 0, TICKS_PER_TURN - 1).tolist()
        return self.write(Register.GOAL_POSITION, dict(zip(self._ids, clipped, strict=True)))

    def write(self, register: Register, values: Mapping[int, int]) -> bytes:
        """Encode the write of a register in several servos."""
        field = self._table.fields[register]
        rows = {servo: self._table.pack(register, value) for servo, value in values.items()}
        return sync_write_frame(field.address, field.size, rows)

    def question(self, places: tuple[int, ...]) -> Query:
        """Return the query for the records of some servos."""
        servos = tuple(self._ids[k] for k in places)
        return FrameQuery(servos, (), table=self._table, full=True)

    def dated(self, question: Query, time: float, places: Sequence[int], records: Records) -> Query:
        """Return the query as it is sent at a time [s].

        It reads the torque switches if each cycle has time for them, after a hardware error, and every `AUDIT_CYCLES`
        cycles.
        """
        if not isinstance(question, FrameQuery):
            return question
        self._cycles += 1
        alarmed = bool(records["hardware_error"][list(places)].any())
        full = self._always_full or alarmed or self._cycles % AUDIT_CYCLES == 1
        torque = tuple(records["torque"][list(places)].tolist())
        return FrameQuery(question.servos, (), table=self._table, full=full).at(time, torque)


def cycle_size(table: FamilyTable, count: int, *, full: bool) -> int:
    """Return the bytes on the wire per cycle for a servo family.

    A cycle consists of goals, queries and replies.

    Args:
        table: control table of the family.
        count: number of servos.
        full: whether the torque switches are read.
    """
    goal = table.fields[Register.GOAL_POSITION].size
    goals = FRAME_OVERHEAD + 2 + count * (1 + goal)
    size = (table.record_span if full else table.sensor_span)[1]
    query = {"sync": 2 + count, "bulk": 1 + 3 * count, "none": 0}[table.collective]
    queries = FRAME_OVERHEAD + query if table.collective != "none" else count * (FRAME_OVERHEAD + 2)
    return goals + queries + count * (FRAME_OVERHEAD + size)


def make_dialect(servos: Sequence[Servo], *, baud: int, period: float, fast: bool) -> Dialect:
    """Return the dialect of the servos on a bus.

    Raises:
        BusError: the servos are of several families, which cannot share a wire.
    """
    tables = {servo.model.table for servo in servos}
    if len(tables) > 1:
        names = ", ".join(sorted({servo.model.name for servo in servos}))
        raise BusError(f"servos with different protocols share a bus: {names}; give each family its own [[bus]]")
    (table,) = tables
    if table is None:
        return PacketDialect(servos, fast=fast)
    return FrameDialect(servos, table, baud=baud, period=period)
