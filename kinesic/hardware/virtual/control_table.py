"""Control table of a virtual servo: access rules, values and indirect cells.

Assumed where the manual is silent: a write is checked completely before any byte takes effect, and unused addresses
read as zero.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from kinesic.hardware.protocol.models import MODELS_BY_NUMBER, Model
from kinesic.hardware.protocol.packet import Fault
from kinesic.hardware.protocol.registers import RAM_START, WATCHDOG_TRIPPED, Mode, Register

POINTER_SIZE = 2  # [bytes] size of an indirect address
MAX_MULTI_TURN = 1_048_575  # [ticks] goal limit of multi-turn modes
TIME_PROFILE_FIRMWARE = 42  # First firmware with time-based profiles
GOAL_TORQUE_FIRMWARE = 45  # First firmware that can switch torque on by a goal
REVERSE_BIT = 1  # Bit of DRIVE_MODE for reverse rotation
FOLLOWER_BIT = 2  # Bit of DRIVE_MODE for slave operation
TIME_PROFILE_BIT = 4  # Bit of DRIVE_MODE for time-based profiles
TORQUE_BY_GOAL_BIT = 8  # Bit of DRIVE_MODE for torque switched on by a goal

GOAL_REGISTERS = frozenset({Register.GOAL_PWM, Register.GOAL_CURRENT, Register.GOAL_VELOCITY, Register.GOAL_POSITION})
"""Registers that a servo does not accept after its bus watchdog has tripped."""
_LIMIT_REGISTERS = {  # goal register -> register with the limit of the goal
    Register.GOAL_PWM: Register.PWM_LIMIT,
    Register.GOAL_CURRENT: Register.CURRENT_LIMIT,
    Register.GOAL_VELOCITY: Register.VELOCITY_LIMIT,
}


class RefusalError(Exception):
    """Refusal of an instruction, answered with an error."""

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault.name)
        self.fault = fault


@dataclass(frozen=True)
class TableLayout:
    """Addresses of a model's registers and indirect data, for one firmware."""

    starts: Mapping[int, Register]
    owned: frozenset[int]  # addresses of registers and cells
    shown: Mapping[int, int]  # indirect data address -> address of its pointer
    pointers: frozenset[int]  # addresses of the pointers
    extent: int  # [bytes] size of the control table


@lru_cache
def table_layout(number: int, firmware: int) -> TableLayout:
    """Return the layout of a model, without registers of newer firmware."""
    model = MODELS_BY_NUMBER[number]
    available = [r for r in model.registers if model.family == "330" or r.field.firmware <= firmware]
    shown = {c.data + k: c.addresses + POINTER_SIZE * k for c in model.cells for k in range(c.count)}
    pointers = frozenset(shown.values())
    owned = {a for r in available for a in range(r.field.address, r.field.end)}
    owned |= set(shown) | {a + k for a in pointers for k in range(POINTER_SIZE)}
    return TableLayout(
        starts={register.field.address: register for register in available},
        owned=frozenset(owned),
        shown=shown,
        pointers=pointers,
        extent=max(owned) + 1,
    )


class RegisterWrite(NamedTuple):
    """Data of a write instruction for one register or indirect cell."""

    address: int
    data: bytes
    register: Register | None  # None: a cell or its pointer


class Piece(NamedTuple):
    """Byte range of a write instruction for one register or indirect cell."""

    address: int
    begin: int  # first byte within the data of the instruction
    end: int
    register: Register | None  # None: a cell or its pointer


class Memory:
    """Control table of one servo, as bytes with access rules."""

    def __init__(self, model: Model, firmware: int) -> None:
        self.model, self.firmware = model, firmware
        self._layout = table_layout(model.number, firmware)
        self._bytes = bytearray(self._layout.extent)
        self._values: dict[Register, int] = {}  # cached values of writable registers
        self._views: dict[tuple[int, int], tuple[int, ...]] = {}  # span -> addresses behind its indirect cells
        self._splits: dict[tuple[int, int], list[Piece]] = {}  # span -> registers and cells that a write changes
        self.eeprom_version = 0  # number of changes of the EEPROM
        self.restore_eeprom()
        self.restore_ram()

    def __contains__(self, register: Register) -> bool:
        return register.field.address in self._layout.starts

    def __getitem__(self, register: Register) -> int:
        """Return the value of a register.

        0 if model or firmware lack it.
        """
        value = self._values.get(register)
        if value is None:
            field = register.field
            value = int.from_bytes(self._bytes[field.address : field.end], "little", signed=field.signed)
            if field.writable:
                self._values[register] = value
        return value

    def __setitem__(self, register: Register, value: int) -> None:
        field = register.field
        self._bytes[field.address : field.end] = value.to_bytes(field.size, "little", signed=field.signed)
        self._values.pop(register, None)
        if field.eeprom:
            self.eeprom_version += 1

    def put(self, address: int, data: bytes) -> None:
        """Write bytes without access checks, leaving cached register values unchanged."""
        self._bytes[address : address + len(data)] = data

    def restore_eeprom(self) -> None:
        """Restore the factory values of the EEPROM."""
        self._restore(r for r in self._layout.starts.values() if r.field.eeprom)
        self[Register.FIRMWARE_VERSION] = self.firmware

    def restore_ram(self) -> None:
        """Reset RAM as a reboot does.

        Registers get their initial values, and cells point to themselves.
        """
        self._bytes[RAM_START:] = bytes(self._layout.extent - RAM_START)
        self._values.clear()
        self._restore(r for r in self._layout.starts.values() if not r.field.eeprom)
        for cell, pointer in self._layout.shown.items():
            self.put(pointer, cell.to_bytes(POINTER_SIZE, "little"))
        self._forget_pointers()

    def _restore(self, registers: Iterator[Register]) -> None:
        for register in registers:
            self[register] = self.model.factory_value(register)

    def read(self, address: int, size: int) -> bytes:
        """Read a span of bytes, resolving indirect cells.

        Raises:
            RefusalError: the span begins at no register, or exceeds the table.
        """
        origins = self._views.get((address, size))
        if origins is None:
            if size < 1:
                raise RefusalError(Fault.LENGTH)
            if address not in self._layout.owned or address + size > self._layout.extent:
                raise RefusalError(Fault.ACCESS)
            origins = tuple(self._origin(a) for a in range(address, address + size))
            self._views[address, size] = origins
        memory = self._bytes
        return bytes([memory[origin] for origin in origins])

    def _origin(self, address: int) -> int:
        """Return an indirect cell's target address, or another address unchanged."""
        pointer = self._layout.shown.get(address)
        return address if pointer is None else int.from_bytes(self._bytes[pointer : pointer + POINTER_SIZE], "little")

    def entries(self, address: int, data: bytes) -> list[RegisterWrite]:
        """Split a write instruction into single register changes.

        Raises:
            RefusalError: the write touches an unused address (ACCESS) or a part of a register (LENGTH).
        """
        pieces = self._splits.get((address, len(data)))
        if pieces is None:
            pieces = self._splits[address, len(data)] = self._split(address, len(data))
        return [RegisterWrite(place, data[begin:end], register) for place, begin, end, register in pieces]

    def _split(self, address: int, size: int) -> list["Piece"]:
        if size < 1:
            raise RefusalError(Fault.LENGTH)
        places = [self._origin(address + k) for k in range(size)]
        pieces, k = [], 0
        while k < size:
            piece = self._piece(places, k)
            pieces.append(piece)
            k = piece.end
        return pieces

    def _piece(self, places: list[int], k: int) -> "Piece":
        place, register = places[k], self._layout.starts.get(places[k])
        if register is not None:
            size = register.field.size
        elif place in self._layout.pointers:
            size = POINTER_SIZE
        elif place in self._layout.shown:
            size = 1
        else:
            raise RefusalError(Fault.ACCESS)
        if places[k : k + size] != list(range(place, place + size)):
            raise RefusalError(Fault.LENGTH)
        return Piece(place, k, k + size, register)

    def is_valid_pointer(self, entry: RegisterWrite) -> bool:
        """Return whether an entry is valid: a register, or pointer into RAM.

        True for all other entries.
        """
        if entry.address not in self._layout.pointers:
            return True
        return RAM_START <= int.from_bytes(entry.data, "little") < self._layout.extent

    def store(self, entry: RegisterWrite) -> None:
        """Store one write that was already checked."""
        self.put(entry.address, entry.data)
        if entry.register is not None:
            self._values.pop(entry.register, None)
            if entry.register.field.eeprom:
                self.eeprom_version += 1
        elif entry.address in self._layout.pointers:
            self._forget_pointers()

    def _forget_pointers(self) -> None:
        """Discard all values derived from the indirect addresses."""
        self._views.clear()
        self._splits.clear()

    def ram(self) -> bytes:
        """Return the bytes of RAM, for the servo's backup."""
        return bytes(self._bytes[RAM_START:])

    def put_ram(self, saved: bytes) -> None:
        """Restore RAM from a backup."""
        self._bytes[RAM_START:] = saved
        self._values.clear()
        self._forget_pointers()


def value_fault(memory: Memory, register: Register, value: int, *, latched: bool) -> Fault:
    """Return the protocol fault of writing a register value, or Fault.NONE.

    Args:
        memory: the servo's registers.
        register: register to write.
        value: raw value.
        latched: whether the servo has shut down until a reboot.
    """
    field = register.field
    if not field.writable or (field.eeprom and memory[Register.TORQUE_ENABLE]):
        return Fault.ACCESS
    if register in GOAL_REGISTERS and memory[Register.BUS_WATCHDOG] == WATCHDOG_TRIPPED:
        return Fault.RANGE
    if register is Register.TORQUE_ENABLE and value == 1 and latched:
        return Fault.RESULT
    if register is Register.GOAL_POSITION:
        return _goal_fault(memory, value)
    if register in _LIMIT_REGISTERS:  # its limit is the value of another register
        return Fault.LIMIT if abs(value) > memory[_LIMIT_REGISTERS[register]] else Fault.NONE
    lower, upper = memory.model.allowed_range(register)
    inside = lower <= value <= upper and _is_defined(memory, register, value)
    return Fault.NONE if inside else Fault.RANGE


def _goal_fault(memory: Memory, value: int) -> Fault:
    """Return the fault of a goal position beyond its limits, or Fault.NONE.

    These are the position limits in position mode, and 256 turns in the other modes.
    """
    if memory[Register.OPERATING_MODE] != Mode.POSITION.value:
        return Fault.NONE if abs(value) <= MAX_MULTI_TURN else Fault.RANGE
    inside = memory[Register.MIN_POSITION_LIMIT] <= value <= memory[Register.MAX_POSITION_LIMIT]
    return Fault.NONE if inside else Fault.LIMIT


def _is_defined(memory: Memory, register: Register, value: int) -> bool:
    """Return whether model and firmware support a mode or drive mode.

    True for other registers.
    """
    model, firmware = memory.model, memory.firmware
    small = model.family == "330"
    if register is Register.OPERATING_MODE:
        return any(mode.value == value for mode in model.modes)
    if register is Register.DRIVE_MODE:
        available = REVERSE_BIT | (FOLLOWER_BIT if model.family == "540" else 0)
        available |= TIME_PROFILE_BIT if small or firmware >= TIME_PROFILE_FIRMWARE else 0
        available |= TORQUE_BY_GOAL_BIT if firmware >= GOAL_TORQUE_FIRMWARE + small else 0
        return not value & ~available
    return True
