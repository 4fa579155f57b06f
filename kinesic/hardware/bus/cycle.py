"""What one cycle of a bus yields: a record of every servo, how old it is, and what happened.

A record is the 18 bytes that the bus reads of every servo in every cycle, through its indirect cells. They show every
fault in the cycle in which it happens. RAM forgets the cells when a servo reboots: then the record reads no voltage,
which no running servo has.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.protocol.registers import Field, Register
from kinesic.hardware.protocol.ticks import Ticks

REGISTERS = (
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
Name = Literal[
    "torque", "hardware_error", "watchdog", "tick", "current", "velocity", "position", "volts", "temperature"
]
NAMES: tuple[Name, ...] = get_args(Name)

Records = NDArray[np.void]  # of dtype HEALTH or BLOCK
Happening = Literal[
    "port lost",
    "port back",
    "silent",  # not heard for so long that the others no longer wait for it
    "heard",  # again
    "rebooted",  # it has forgotten its RAM; torque is off
    "error",  # its hardware error register has changed, to zero perhaps
    "watchdog",  # it has stopped because the bus was quiet
    "torque",  # switched on or off, by whoever
    "impossible",  # it says what cannot be, however often
    "doubted",  # it said something surprising that it did not repeat
]


def _format(field: Field) -> str:
    return f"<{'i' if field.signed else 'u'}{field.size}"


_LAYOUT = [(name, _format(register.field)) for name, register in zip(NAMES, REGISTERS, strict=True)]
HEALTH = np.dtype(_LAYOUT)
BLOCK = np.dtype([("error", "u1"), ("id", "u1"), *_LAYOUT, ("crc", "<u2")])
"""What a servo puts into a joint reply: its error byte, its id, the record, and the CRC of all so far."""

SIZE = HEALTH.itemsize  # 18
ADDRESSES = tuple(address for r in REGISTERS for address in range(r.field.address, r.field.end))
CELLS = b"".join(address.to_bytes(2, "little") for address in ADDRESSES)
"""What the indirect addresses must hold."""

_STEADY: tuple[Name, ...] = ("torque", "hardware_error", "watchdog", "temperature")
_SIZES = [register.field.size for register in REGISTERS]
_PLACES = np.array([0, *(2 + sum(_SIZES[: NAMES.index(name)]) for name in _STEADY)])


def signature(blocks: Records) -> bytes:
    """Returns the bytes that stay the same while all is well: error bytes, torque, errors, watchdogs, temperatures."""
    return blocks.view(np.uint8).reshape(-1, BLOCK.itemsize).take(_PLACES, axis=1).tobytes()


@dataclass(frozen=True)
class Event:
    """Something that happened on a bus and is worth a line in the log."""

    time: float  # [s] on the wire's clock
    servo: int | None  # its id; None: the port
    kind: Happening
    text: str


@dataclass(frozen=True, eq=False)
class Cycle:
    """What came of one cycle; servos stand in the order in which the bus was given them."""

    time: float  # [s] when it began, on the wire's clock
    duration: float  # [s]
    servos: tuple[int, ...]  # ids
    records: Records  # (n,) of dtype HEALTH and more: the last one believed, zeros before the first
    times: Floats  # (n,) [s] when it was taken; -inf: never
    fresh: Flags  # (n,) taken in this cycle
    late: Flags  # (n,) whose record of an earlier cycle has come in this one, dated by the servo's clock
    silent: Flags  # (n,) in quarantine
    lost: bool  # the port is gone
    signature: bytes  # of the records: while it stays, torque, errors, watchdogs and temperatures do
    events: tuple[Event, ...]

    @cached_property
    def ages(self) -> Floats:
        """(n,) [s] of the records at the end of the cycle; inf: never heard."""
        return self.time + self.duration - self.times

    def each(self, name: Name) -> Ticks:
        """Returns (n,) one register of all servos, raw."""
        return self.records[name].astype(np.int64)

    @property
    def positions(self) -> Ticks:
        """(n,) PRESENT_POSITION [ticks]."""
        return self.each("position")
