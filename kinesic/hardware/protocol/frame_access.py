"""Slow access to single servos with Protocol 1.0 frames.

Callers use the registers and units of the X series, which the family's table converts. A register that the family
lacks reads as its factory value.
"""

from collections.abc import Collection, Iterator
from contextlib import contextmanager

from kinesic.hardware.protocol.device import MAX_TRIES, TABLE_SIZE, PingReply, ServoAccess
from kinesic.hardware.protocol.frame import (
    FRAME_OVERHEAD,
    find_frames,
    frame,
    ping_frame,
    read_frame,
    write_frame,
)
from kinesic.hardware.protocol.models import MODELS_BY_NUMBER, Model
from kinesic.hardware.protocol.packet import BROADCAST_ID, Instruction, Packet
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.tables import FAMILY_TABLES, FamilyTable
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, BusError, Wire

REPLY_TIMEOUT = 0.010  # [s] wait for a reply, in addition to its transmission time
SLOW_REPLY_TIMEOUT = 0.034  # [s] wait behind an adapter with the default latency timer, used from the second try on
BROADCAST_TIMEOUT = 0.05  # [s] pause without bytes that ends the replies to a ping of all servos
QUIET_TIME = 0.03  # [s] wait for late replies to an abandoned instruction
UNLOCKED_VALUE = 0  # value of the lock register that lets EEPROM writes persist
LOCKED_VALUE = 1  # value of the lock register that makes EEPROM writes temporary
IDENTITY_SIZE = 7  # [bytes] span from address 0 with model number and id of all families
INSTRUCTION_ERRORS = {0x02: "angle limit", 0x08: "range", 0x10: "checksum", 0x40: "instruction"}


class FrameAccess(ServoAccess):
    """Access to Feetech servos, or to Dynamixel servos with Protocol 1.0."""

    def __init__(self, wire: Wire, table: FamilyTable | None = None, *, tries: int = MAX_TRIES) -> None:
        """Use a wire, with at most `tries` attempts per instruction.

        Args:
            wire: an open wire.
            table: control table of its servos; None: identified from the first reply of each servo.
            tries: attempts per instruction.
        """
        super().__init__(wire, tries=tries)
        self._table_of_all, self._frame_tries = table, tries
        self._models: dict[int, Model] = {}  # id -> identified model

    def enable_replies(self) -> None:
        """Do nothing, because `configure` sets the EEPROM register that permits replies."""

    def release_all(self) -> None:
        """Switch the torque of all servos on the wire off, without verification."""
        tables = (self._table_of_all,) if self._table_of_all is not None else tuple(FAMILY_TABLES.values())
        for address in sorted({table.fields[Register.TORQUE_ENABLE].address for table in tables}):
            self.wire.write(write_frame(BROADCAST_ID, address, b"\0"))

    def ping_all(self) -> tuple[PingReply, ...]:
        """Ping all servos and return the identified ones, sorted by id."""
        self._discard_input()
        data, raw = ping_frame(BROADCAST_ID), b""
        self.wire.write(data)
        sent_at = self.wire.now() + self._wire_time(len(data))
        while chunk := self.wire.read(max(sent_at, self.wire.now()) + BROADCAST_TIMEOUT):
            raw += chunk
        ids = sorted({status.id for status, _ in find_frames(raw) if not status.parameters})
        replies = (self.ping(servo) for servo in ids)
        return tuple(reply for reply in replies if reply is not None)

    def ping(self, servo: int) -> PingReply | None:
        """Ping one servo and return its reply.

        The reply is None if the servo is silent or of another family.
        """
        try:
            self._exchange(servo, "ping", ping_frame(servo), 0, tries=min(2, self._frame_tries))
            return self._identify(servo)
        except BusError:
            return None

    def is_shared(self, servo: int) -> bool:
        """Return whether several servos have this id, so that their replies collide."""
        try:
            start, size = self._model(servo).native_table.sensor_span
        except BusError:  # of an unknown model, but its identity was read
            return False
        try:
            self._exchange(servo, "read of sensors", read_frame(servo, start, size), size)
        except BusError:
            return True
        return False

    def read(self, servo: int, register: Register) -> int:
        """Read a register in units of the X series.

        Raises:
            BusError: the servo does not answer.
        """
        return self.read_several(servo, (register,))[register]

    def read_several(self, servo: int, registers: Collection[Register]) -> dict[Register, int]:
        """Read several registers in one span.

        Raises:
            BusError: the servo does not answer.
        """
        model = self._model(servo)
        table = model.native_table
        known = [table.fields[register] for register in registers if table.has(register)]
        begin, data = 0, b""
        if known:
            begin = min(field.address for field in known)
            size = max(field.end for field in known) - begin
            action = f"read of {size} bytes at {begin}"
            data = self._exchange(servo, action, read_frame(servo, begin, size), size).parameters
        values: dict[Register, int] = {}
        for register in registers:
            if table.has(register):
                field = table.fields[register]
                values[register] = table.unpack(register, data[field.address - begin : field.end - begin])
            else:
                values[register] = model.factory_value(register)
        return values

    def read_table(self, servo: int) -> bytes:
        """Read all registers of a servo into an X series layout.

        Raises:
            BusError: the servo does not answer.
        """
        registers = [register for register in Register if register.field.end <= TABLE_SIZE]
        image = bytearray(TABLE_SIZE)
        for register, value in self.read_several(servo, registers).items():
            image[register.field.address : register.field.end] = register.field.pack(value)
        return bytes(image)

    def read_span(self, servo: int, address: int, size: int) -> bytes:
        """Read bytes at a native address.

        Raises:
            BusError: the servo does not answer.
        """
        action = f"read of {size} bytes at {address}"
        return self._exchange(servo, action, read_frame(servo, address, size), size).parameters

    def write(self, servo: int, register: Register, value: int) -> None:
        """Set a register to a value in X series units.

        The EEPROM is unlocked for the write.

        Raises:
            BusError: the servo does not answer, refuses, or lacks the register.
        """
        table = self._model(servo).native_table
        if not table.has(register):
            raise BusError(f"{self._label(servo)}: has no register {register.name}")
        field = table.fields[register]
        with self._unlocked(servo, table, persistent=field.address < table.ram_start):
            self.write_span(servo, field.address, table.pack(register, value), name=register.name)

    def write_span(self, servo: int, address: int, data: bytes, *, name: str = "") -> None:
        """Write bytes at a native address.

        A servo that answers only reads is checked by a read.

        Raises:
            BusError: the servo does not answer, or refuses.
        """
        action = f"write of {name or f'{len(data)} bytes'} at {address}"
        try:
            self._exchange(servo, action, write_frame(servo, address, data), 0)
        except BusError:
            if self.read_span(servo, address, len(data)) != data:
                raise

    def reboot(self, servo: int) -> None:
        """Restart a servo.

        Raises:
            BusError: the servo does not answer, or has no such instruction.
        """
        self._exchange(servo, "reboot", frame(servo, Instruction.REBOOT), 0)

    @contextmanager
    def _unlocked(self, servo: int, table: FamilyTable, *, persistent: bool) -> Iterator[None]:
        """Unlock a servo's EEPROM during a `with` block, so that writes persist."""
        if not persistent or table.lock is None:
            yield
            return
        self.write_span(servo, table.lock, bytes((UNLOCKED_VALUE,)), name="LOCK")
        try:
            yield
        finally:
            if self.ping(servo) is not None:  # the block may have changed its id
                self.write_span(servo, table.lock, bytes((LOCKED_VALUE,)), name="LOCK")

    def _model(self, servo: int) -> Model:
        """Return the model of a servo, identified by its first reply.

        Raises:
            BusError: the servo does not answer, or is of an unknown model.
        """
        model = self._models.get(servo)
        if model is None:
            reply = self._identify(servo)
            model = MODELS_BY_NUMBER.get(reply.number)
            if model is None or model.table is None:
                raise BusError(f"{self._label(servo)}: is a {reply.name}, which has no table of registers")
            if self._table_of_all not in (None, model.table):
                raise BusError(f"{self._label(servo)}: is a {reply.name}, of another family than this bus")
            self._models[servo] = model
        return model

    def _identify(self, servo: int) -> PingReply:
        """Read a servo's model number and firmware, which determine its family.

        Raises:
            BusError: the servo does not answer.
        """
        data = self.read_span(servo, 0, IDENTITY_SIZE)
        candidates: list[tuple[FamilyTable, int]] = []
        for table in FAMILY_TABLES.values():
            field, place = table.fields[Register.MODEL_NUMBER], table.fields[Register.ID].address
            if data[place] == servo:
                candidates.append((table, table.unpack(Register.MODEL_NUMBER, data[field.address : field.end])))
        numbered = [(table, number) for table, number in candidates if _is_of(number, table)]
        known = [(table, number) for table, number in candidates if number in MODELS_BY_NUMBER]
        for table, number in numbered or known or candidates:
            return PingReply(servo, number, data[table.fields[Register.FIRMWARE_VERSION].address])
        return PingReply(servo, int.from_bytes(data[:2], "little"), 0)

    def _exchange(self, servo: int, action: str, data: bytes, size: int, *, tries: int | None = None) -> Packet:
        """Send a frame and return the servo's status with `size` bytes.

        The frame is sent again if no such status arrives.

        Raises:
            BusError: it does not answer, or reports a wrong instruction.
        """
        for attempt in range(self._frame_tries if tries is None else tries):
            if attempt:
                self.wire.sleep(self.wire.now() + QUIET_TIME)
            self._discard_input()
            self.wire.write(data)
            timeout = SLOW_REPLY_TIMEOUT if attempt else REPLY_TIMEOUT
            limit = self.wire.now() + self._wire_time(len(data) + FRAME_OVERHEAD + size) + timeout
            raw = b""
            while chunk := self.wire.read(limit):
                raw += chunk
                for status, _ in find_frames(raw):
                    if status.id == servo and len(status.parameters) == size:
                        return status
                    if status.id == servo and (refusal := _refusal(status.instruction)):
                        raise BusError(f"{self._label(servo)}: {action} refused ({refusal} error)")
        raise BusError(
            f"{self._label(servo)}: {action}: no status packet in {self._frame_tries} tries; "
            "is it powered, wired, at this baud rate?"
        )

    def _discard_input(self) -> None:
        self.wire.read(self.wire.now())

    def _wire_time(self, octets: int) -> float:
        return octets * BITS_PER_BYTE / self.wire.baud


def _is_of(number: int, table: FamilyTable) -> bool:
    """Return whether a model number belongs to a family."""
    model = MODELS_BY_NUMBER.get(number)
    return model is not None and model.table is table


def _refusal(error: int) -> str:
    """Return the names of the instruction errors in an error byte."""
    return ", ".join(name for bit, name in INSTRUCTION_ERRORS.items() if bit & error)


def open_access(wire: Wire, table: FamilyTable | None, *, tries: int = MAX_TRIES) -> ServoAccess:
    """Return slow access to the servos of a wire.

    Args:
        wire: an open wire.
        table: control table of its family; None: X series with Protocol 2.0.
        tries: attempts per instruction.
    """
    return ServoAccess(wire, tries=tries) if table is None else FrameAccess(wire, table, tries=tries)
