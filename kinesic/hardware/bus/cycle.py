"""Records, ages and events of one bus cycle.

A record is the 18 bytes that the bus reads from every servo in every cycle, through its indirect cells. Any fault shows
in the cycle in which it happens. A reboot clears the cells, because they are in RAM: the record then reads 0 V, which
no running servo has.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.protocol.registers import Field, Register
from kinesic.hardware.protocol.ticks import Ticks

# Registers of a servo's record, which each cycle reads, in the order of its bytes
RECORD_REGISTERS = (
    Register.TORQUE_ENABLE,
    Register.HARDWARE_ERROR_STATUS,
    Register.BUS_WATCHDOG,
    Register.REALTIME_TICK,
    Register.PRESENT_CURRENT,
    Register.PRESENT_VELOCITY,
    Register.PRESENT_POSITION,
    Register.PRESENT_INPUT_VOLTAGE,
    Register.PRESENT_TEMPERATURE,
)
FieldName = Literal[
    "torque", "hardware_error", "watchdog", "tick", "current", "velocity", "position", "volts", "temperature"
]
FIELD_NAMES: tuple[FieldName, ...] = get_args(FieldName)  # names of a record's fields, in the order of RECORD_REGISTERS

Records = NDArray[np.void]  # records of servos, of dtype RECORD_DTYPE or BLOCK_DTYPE
EventKind = Literal[
    "port lost",
    "port back",
    "silent",  # excluded from the joint query after too many misses
    "heard",  # answers again
    "rebooted",  # its RAM is reset; torque is off
    "error",  # its hardware error register has changed, possibly to zero
    "watchdog",  # it has stopped because the bus was silent
    "torque",  # switched on or off
    "impossible",  # it reports an impossible value
    "doubted",  # it reported an implausible value, not yet repeated
]


def _format(field: Field) -> str:
    return f"<{'i' if field.signed else 'u'}{field.size}"


_RECORD_LAYOUT = [(name, _format(register.field)) for name, register in zip(FIELD_NAMES, RECORD_REGISTERS, strict=True)]
RECORD_DTYPE = np.dtype(_RECORD_LAYOUT)  # NumPy type of a servo's record
BLOCK_DTYPE = np.dtype([("error", "u1"), ("id", "u1"), *_RECORD_LAYOUT, ("crc", "<u2")])
"""Block of a servo in a common reply: error byte, id, record, and the CRC of everything before it."""

RECORD_SIZE = RECORD_DTYPE.itemsize  # [bytes] size of a servo's record: 18
# Addresses of the record's bytes in the control table, in the order of the record
RECORD_ADDRESSES = tuple(address for r in RECORD_REGISTERS for address in range(r.field.address, r.field.end))
CELL_CONTENTS = b"".join(address.to_bytes(2, "little") for address in RECORD_ADDRESSES)
"""Contents that the indirect addresses of each servo must have: RECORD_ADDRESSES in two bytes each."""

# Fields that rarely change, which `signature` compares
_STEADY_FIELDS: tuple[FieldName, ...] = ("torque", "hardware_error", "watchdog", "temperature")
_REGISTER_SIZES = [register.field.size for register in RECORD_REGISTERS]  # [bytes] sizes of a record's registers
# Offsets of the error byte, and of the first bytes of these fields, in a block
_STEADY_OFFSETS = np.array([0, *(2 + sum(_REGISTER_SIZES[: FIELD_NAMES.index(name)]) for name in _STEADY_FIELDS)])


def signature(blocks: Records) -> bytes:
    """Return the records' errors, torque, watchdogs and temperatures as bytes for comparison.

    Equal bytes mean that none of these values, nor the error byte of a block, has changed.
    """
    return blocks.view(np.uint8).reshape(-1, BLOCK_DTYPE.itemsize).take(_STEADY_OFFSETS, axis=1).tobytes()


@dataclass(frozen=True)
class Event:
    """Event on a bus, written to the log."""

    time: float  # [s] on the wire's clock
    servo: int | None  # id; None: the port
    kind: EventKind
    text: str


@dataclass(frozen=True, eq=False)
class Cycle:
    """Result of one bus cycle, with servos in bus order."""

    time: float  # [s] start, on the wire's clock
    duration: float  # [s] from the start to the end of the cycle
    servos: tuple[int, ...]  # ids of the servos in bus order
    records: Records  # (n,) last accepted records of dtype BLOCK_DTYPE, zeros before the first
    times: Floats  # (n,) [s] time of each record; -inf: no record yet
    fresh: Flags  # (n,) whether the record was read in this cycle
    late: Flags  # (n,) whether a record queried in an earlier cycle arrived in this one, dated by the servo's clock
    silent: Flags  # (n,) whether the servo is left out of the query of all servos
    lost: bool  # whether the port is gone
    signature: bytes  # errors, torque, watchdogs and temperatures of the records, for quick comparison
    events: tuple[Event, ...]

    @cached_property
    def ages(self) -> Floats:
        """Ages (n,) [s] of the records at the end of the cycle.

        Inf: no record yet.
        """
        return self.time + self.duration - self.times

    def raw_values(self, name: FieldName) -> Ticks:
        """Return one register of all servos, (n,) raw counts."""
        return self.records[name].astype(np.int64)

    @property
    def positions(self) -> Ticks:
        """Positions (n,) [ticks], from PRESENT_POSITION."""
        return self.raw_values("position")
