"""Registers of one servo, with access rules and reboot behaviour."""

from struct import Struct

from .packet import ACCESS_ERROR, LENGTH_ERROR, LIMIT_ERROR, RANGE_ERROR
from .table import GOAL_REGISTERS, Item, Model, items

RAM_START = 64  # first address of the RAM area
STRUCT_CODES = {1: "Bb", 2: "Hh", 4: "Ii"}  # size [bytes] -> `struct` codes of an unsigned and a signed number
WATCHDOG_TRIPPED = -1  # value of the watchdog register after the watchdog has tripped
POSITION_MODE = 3  # operating mode whose goals are within one turn
MAX_GOAL = 1_048_575  # [ticks] largest goal position in the other modes
DUAL_JOINT_BIT = 2  # bit of the drive mode for dual joints, which only the 540 models have


class Memory:
    """Control table: bytes, and the access rules of each register."""

    def __init__(self, model: Model, servo: int, firmware: int) -> None:
        self.model, self.items = model, items(model, servo, firmware)
        self.bytes = bytearray(model.end)
        # Prepared, because a servo reads and writes thousands of registers per simulated second
        self._getters = {
            n: (Struct(f"<{STRUCT_CODES[i.size][i.signed]}").unpack_from, i.address) for n, i in self.items.items()
        }
        self._setters = {
            n: (Struct(f"<{STRUCT_CODES[i.size][0]}").pack_into, i.address, 256**i.size - 1)
            for n, i in self.items.items()
        }
        self._name = {item.address: name for name, item in self.items.items()}
        self._owner = {item.address + k: name for name, item in self.items.items() for k in range(item.size)}
        self._cells = {first + k: k for first, _ in model.windows for k in range(2 * model.cells)}
        self._windows = {
            data + k: first + 2 * k for first, data in model.windows for k in range(model.cells)
        }  # indirect data address -> address of its pointer
        for name, item in self.items.items():
            self[name] = item.initial
        self._reset_pointers()

    def __getitem__(self, name: str) -> int:
        unpack, address = self._getters[name]
        value: int = unpack(self.bytes, address)[0]
        return value

    def __setitem__(self, name: str, value: int) -> None:
        pack, address, mask = self._setters[name]
        pack(self.bytes, address, value & mask)

    def has(self, name: str) -> bool:
        """Return whether the model has this register."""
        return name in self.items

    def reset(self, *, lasting: bool = False, keep: tuple[str, ...] = ()) -> None:
        """Reset RAM as a power cycle does, optionally EEPROM, too."""
        self.bytes[RAM_START:] = bytes(len(self.bytes) - RAM_START)
        for name, item in self.items.items():
            if name not in keep and (lasting or not item.lasting):
                self[name] = item.initial
        self._reset_pointers()
        self["goal_pwm"] = self["pwm_limit"]
        if self.has("goal_current"):
            self["goal_current"] = self["current_limit"]

    def _reset_pointers(self) -> None:
        for data, pointer in self._windows.items():
            self.bytes[pointer : pointer + 2] = data.to_bytes(2, "little")

    def _defined(self, address: int) -> bool:
        return address in self._owner or address in self._cells or address in self._windows

    def _target(self, address: int) -> int:
        """Resolve an indirect data address, and return other addresses unchanged."""
        pointer = self._windows.get(address)
        return address if pointer is None else int.from_bytes(self.bytes[pointer : pointer + 2], "little")

    def read(self, address: int, size: int) -> tuple[int, bytes]:
        """Return an error number and the bytes of an address range.

        The span must begin at a register, and gaps inside it are zeros.
        """
        if not size:
            return LENGTH_ERROR, b""
        if not self._defined(address) or address + size > len(self.bytes):
            return ACCESS_ERROR, b""
        return 0, bytes(self.bytes[self._target(address + k)] for k in range(size))

    def write(self, address: int, data: bytes) -> int:
        """Write all given bytes or none, and return an error number."""
        if not data:
            return LENGTH_ERROR
        if address + len(data) > len(self.bytes):
            return ACCESS_ERROR
        octets = {self._target(address + k): byte for k, byte in enumerate(data)}
        names = []
        for place in octets:
            if place in self._cells:
                continue
            name = self._owner.get(place)
            if name is None and place not in self._windows:
                return ACCESS_ERROR
            if name is not None and name not in names:
                names.append(name)
        changed: dict[str, int] = {}
        for name in names:
            item = self.items[name]
            whole = [octets.get(item.address + k) for k in range(item.size)]
            if not item.writable or (item.lasting and self["torque"]):
                return ACCESS_ERROR
            if None in whole:
                return LENGTH_ERROR
            changed[name] = int.from_bytes(bytes(whole), "little", signed=item.signed)
        if error := self._pointers_wrong(octets) or self._wrong(changed):
            return error
        for place, byte in octets.items():
            self.bytes[place] = byte
        return 0

    def named(self, address: int, size: int) -> set[str]:
        """Return the registers that a write changes, also through indirect addresses."""
        places = range(address, min(address + size, len(self.bytes)))
        return {self._owner[place] for place in map(self._target, places) if place in self._owner}

    def _pointers_wrong(self, octets: dict[int, int]) -> int:
        cells = {place - self._cells[place] % 2 for place in octets if place in self._cells}
        for cell in cells:
            pair = [octets.get(cell + k) for k in range(2)]
            if None in pair:
                return LENGTH_ERROR
            if not RAM_START <= int.from_bytes(bytes(pair), "little") < len(self.bytes):
                return RANGE_ERROR
        return 0

    def _wrong(self, changed: dict[str, int]) -> int:
        """Return the error number for written values, 0 if they are allowed."""
        for name, value in changed.items():
            item = self.items[name]
            if self["watchdog"] == WATCHDOG_TRIPPED and name in GOAL_REGISTERS:
                return RANGE_ERROR
            if item.bounds is not None and not item.bounds[0] <= value <= item.bounds[1]:
                return RANGE_ERROR
            if name == "operating_mode" and value not in self.model.modes:
                return RANGE_ERROR
            if name == "drive_mode" and value & DUAL_JOINT_BIT and not self.model.ports:
                return RANGE_ERROR
            if name == "goal_position" and self["operating_mode"] != POSITION_MODE and abs(value) > MAX_GOAL:
                return RANGE_ERROR
            if (limit := self._limit(name, changed)) is not None and not limit[0] <= value <= limit[1]:
                return LIMIT_ERROR
        return 0

    def _limit(self, name: str, changed: dict[str, int]) -> tuple[int, int] | None:
        """Return the range that other registers set for a value, or None."""

        def now(other: str) -> int:
            return changed.get(other, self[other])

        ceilings = {"goal_pwm": "pwm_limit", "goal_current": "current_limit", "goal_velocity": "velocity_limit"}
        if name in ceilings:
            return -now(ceilings[name]), now(ceilings[name])
        if name == "goal_position" and self["operating_mode"] == POSITION_MODE:
            return now("min_position"), now("max_position")
        return None

    def lasting(self) -> dict[str, int]:
        """Return all EEPROM values."""
        return {name: self[name] for name, item in self.items.items() if item.lasting}

    def item(self, name: str) -> Item:
        """Return a register's description."""
        return self.items[name]
