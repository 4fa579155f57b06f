"""The 18 bytes that the bus reads of every servo in every cycle, through its indirect cells.

They show every fault in the cycle in which it happens. RAM forgets the cells when a servo reboots: then the record
reads no voltage, which no running servo has.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kinesic.hardware.protocol.registers import Field, Register

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
NAMES = ("torque", "hardware_error", "watchdog", "tick", "current", "velocity", "position", "volts", "temperature")
Name = Literal[
    "torque", "hardware_error", "watchdog", "tick", "current", "velocity", "position", "volts", "temperature"
]

Records = NDArray[np.void]  # of dtype HEALTH or BLOCK


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
    """What stays the same while all is well: error bytes, torque, errors, watchdogs and temperatures of all."""
    return blocks.view(np.uint8).reshape(-1, BLOCK.itemsize).take(_PLACES, axis=1).tobytes()
