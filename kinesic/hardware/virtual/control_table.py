"""A servo's control table as bytes: what may be read and written where, which values it takes, and its indirect cells.

Where the manual is silent: a write is checked as a whole before any byte of it counts, and unused addresses inside a
read are zeros.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from kinesic.hardware.protocol.models import BY_NUMBER, Model
from kinesic.hardware.protocol.packet import Fault
from kinesic.hardware.protocol.registers import RAM_START, WATCHDOG_TRIPPED, Mode, Register

CELL = 2  # [bytes] of an indirect address
TURNS_MAX = 1_048_575  # [ticks] of goals beyond one turn
TIME_PROFILE_FIRMWARE = 42
GOAL_TORQUE_FIRMWARE = 45  # drive mode's torque by goal update
REVERSE, FOLLOWER, BY_TIME, BY_GOAL = 1, 2, 4, 8  # bits of DRIVE_MODE

GOALS = frozenset({Register.GOAL_PWM, Register.GOAL_CURRENT, Register.GOAL_VELOCITY, Register.GOAL_POSITION})
_LIMITED = {
    Register.GOAL_PWM: Register.PWM_LIMIT,
    Register.GOAL_CURRENT: Register.CURRENT_LIMIT,
    Register.GOAL_VELOCITY: Register.VELOCITY_LIMIT,
}


class RefusalError(Exception):
    """An instruction that the servo answers with an error."""

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault.name)
        self.fault = fault


@dataclass(frozen=True)
class TableLayout:
    """Where everything of a model stands, for one firmware."""

    starts: Mapping[int, Register]
    owned: frozenset[int]  # addresses that some register or cell covers
    shown: Mapping[int, int]  # indirect data -> where its address stands
    pointers: frozenset[int]  # where indirect addresses stand
    extent: int  # [bytes]


@lru_cache
def table_layout(number: int, firmware: int) -> TableLayout:
    """Returns the layout of a model by its number, without what its firmware does not know yet."""
    model = BY_NUMBER[number]
    known = [r for r in model.registers if model.family == "330" or r.field.firmware <= firmware]
    shown = {c.data + k: c.addresses + CELL * k for c in model.cells for k in range(c.count)}
    pointers = frozenset(shown.values())
    owned = {a for r in known for a in range(r.field.address, r.field.end)}
    owned |= set(shown) | {a + k for a in pointers for k in range(CELL)}
    return TableLayout(
        starts={register.field.address: register for register in known},
        owned=frozenset(owned),
        shown=shown,
        pointers=pointers,
        extent=max(owned) + 1,
    )


@dataclass(frozen=True)
class RegisterWrite:
    """One thing that a write would change."""

    address: int
    data: bytes
    register: Register | None  # None: a cell, or its address


class Memory:
    """The bytes of one servo; what their values mean is for others to know."""

    def __init__(self, model: Model, firmware: int) -> None:
        self.model, self.firmware = model, firmware
        self._layout = table_layout(model.number, firmware)
        self._bytes = bytearray(self._layout.extent)
        self._values: dict[Register, int] = {}  # of those that are not sensors, once asked
        self._views: dict[tuple[int, int], tuple[int, ...]] = {}  # spans with cells -> where their bytes come from
        self.restore_eeprom()
        self.restore_ram()

    def __contains__(self, register: Register) -> bool:
        return register.field.address in self._layout.starts

    def __getitem__(self, register: Register) -> int:
        """Its value; 0 for one that model or firmware lack."""
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

    def put(self, address: int, data: bytes) -> None:
        """Writes bytes of sensors or cells from an address on, unchecked."""
        self._bytes[address : address + len(data)] = data

    def restore_eeprom(self) -> None:
        """Restores the factory values below RAM."""
        self._restore(r for r in self._layout.starts.values() if r.field.eeprom)
        self[Register.FIRMWARE_VERSION] = self.firmware

    def restore_ram(self) -> None:
        """Restores what a reboot leaves: initial values, and cells that show themselves."""
        self._bytes[RAM_START:] = bytes(self._layout.extent - RAM_START)
        self._values.clear()
        self._restore(r for r in self._layout.starts.values() if not r.field.eeprom)
        for cell, pointer in self._layout.shown.items():
            self.put(pointer, cell.to_bytes(CELL, "little"))
        self._views.clear()

    def _restore(self, registers: Iterator[Register]) -> None:
        for register in registers:
            self[register] = self.model.starts(register)

    def read(self, address: int, size: int) -> bytes:
        """Reads the bytes of a span through its indirect cells.

        Raises:
            RefusalError: it begins at no register, or ends behind the table.
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
        """Where the byte of an address really stands."""
        pointer = self._layout.shown.get(address)
        return address if pointer is None else int.from_bytes(self._bytes[pointer : pointer + CELL], "little")

    def entries(self, address: int, data: bytes) -> list[RegisterWrite]:
        """Lists what a write would change, in order.

        Raises:
            RefusalError: it touches what is not there (ACCESS) or only a part of a register (LENGTH).
        """
        if not data:
            raise RefusalError(Fault.LENGTH)
        places = [self._origin(address + k) for k in range(len(data))]
        found, k = [], 0
        while k < len(data):
            entry = self._entry(places, data, k)
            found.append(entry)
            k += len(entry.data)
        return found

    def _entry(self, places: list[int], data: bytes, k: int) -> RegisterWrite:
        place, register = places[k], self._layout.starts.get(places[k])
        if register is not None:
            size = register.field.size
        elif place in self._layout.pointers:
            size = CELL
        elif place in self._layout.shown:
            size = 1
        else:
            raise RefusalError(Fault.ACCESS)
        if places[k : k + size] != list(range(place, place + size)):
            raise RefusalError(Fault.LENGTH)
        return RegisterWrite(place, data[k : k + size], register)

    def is_valid_pointer(self, entry: RegisterWrite) -> bool:
        """Returns whether an entry that sets an indirect address names RAM; True for any other entry."""
        if entry.address not in self._layout.pointers:
            return True
        return RAM_START <= int.from_bytes(entry.data, "little") < self._layout.extent

    def store(self, entry: RegisterWrite) -> None:
        """Stores an entry that was checked."""
        self.put(entry.address, entry.data)
        if entry.register is not None:
            self._values.pop(entry.register, None)
        elif entry.address in self._layout.pointers:
            self._views.clear()

    def ram(self) -> bytes:
        """Returns all of RAM, for the servo's backup."""
        return bytes(self._bytes[RAM_START:])

    def put_ram(self, saved: bytes) -> None:
        """Restores what `ram` returned."""
        self._bytes[RAM_START:] = saved
        self._values.clear()
        self._views.clear()


def value_fault(memory: Memory, register: Register, value: int, *, latched: bool) -> Fault:
    """Returns why a value is not taken; NONE if it is.

    Args:
        memory: the servo's registers.
        register: to be written.
        value: raw.
        latched: the servo has shut down and waits for a reboot.
    """
    field = register.field
    if not field.writable or (field.eeprom and memory[Register.TORQUE_ENABLE]):
        return Fault.ACCESS
    if register in GOALS and memory[Register.BUS_WATCHDOG] == WATCHDOG_TRIPPED:
        return Fault.RANGE
    if register is Register.TORQUE_ENABLE and value == 1 and latched:
        return Fault.RESULT
    if register is Register.GOAL_POSITION:
        return _goal_refusal(memory, value)
    if register in _LIMITED:  # its range is another register's value
        return Fault.LIMIT if abs(value) > memory[_LIMITED[register]] else Fault.NONE
    lower, upper = memory.model.range(register)
    inside = lower <= value <= upper and _meant(memory, register, value)
    return Fault.NONE if inside else Fault.RANGE


def _goal_refusal(memory: Memory, value: int) -> Fault:
    """Within the limits in one turn, within 256 turns in the other modes."""
    if memory[Register.OPERATING_MODE] != Mode.POSITION.value:
        return Fault.NONE if abs(value) <= TURNS_MAX else Fault.RANGE
    inside = memory[Register.MIN_POSITION_LIMIT] <= value <= memory[Register.MAX_POSITION_LIMIT]
    return Fault.NONE if inside else Fault.LIMIT


def _meant(memory: Memory, register: Register, value: int) -> bool:
    """Whether a value inside the range is one of those that mean something."""
    model, firmware = memory.model, memory.firmware
    small = model.family == "330"
    if register is Register.OPERATING_MODE:
        return any(mode.value == value for mode in model.modes)
    if register is Register.DRIVE_MODE:
        known = REVERSE | (FOLLOWER if model.family == "540" else 0)
        known |= BY_TIME if small or firmware >= TIME_PROFILE_FIRMWARE else 0
        known |= BY_GOAL if firmware >= GOAL_TORQUE_FIRMWARE + small else 0
        return not value & ~known
    return True
