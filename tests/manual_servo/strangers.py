"""Foreign register values: another model, id, baud rate or return level."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .servo_faults import OfServo

if TYPE_CHECKING:
    from .device import Device
    from .line import Line


@dataclass
class Register(OfServo):
    """Register changed by another program."""

    name: str
    value: int
    before: int = 0

    def strike(self, device: Device) -> None:
        self.before = device.memory[self.name]
        self._set(device, self.value)

    def end(self, line: Line) -> None:
        for device in line.devices:
            if device.memory[self.name] == self.value:
                self._set(device, self.before)

    def _set(self, device: Device, value: int) -> None:
        device.memory[self.name] = value
        device.firmware.reload()


def foreign_firmware(servo: int, firmware: int = 35) -> Register:
    """Make a servo whose firmware is too old."""
    return Register(servo, "firmware", firmware)


def foreign_model(servo: int, number: int = 1060) -> Register:
    """Make a servo of another model."""
    return Register(servo, "model", number)


def alias_id(servo: int, other: int) -> Register:
    """Make a servo that also obeys another servo's id."""
    return Register(servo, "secondary_id", other)


def duplicate_id(servo: int, other: int) -> Register:
    """Make two servos with one id."""
    return Register(servo, "id", other)


def return_level(servo: int, level: int = 0) -> Register:
    """Make a servo that replies to pings only."""
    return Register(servo, "status_return", level)


def return_delay(servo: int, value: int = 254) -> Register:
    """Make a servo that waits half a millisecond before each reply."""
    return Register(servo, "return_delay", value)


def baud_changed(servo: int, value: int = 1) -> Register:
    """Make a servo with another baud rate, which never replies."""
    return Register(servo, "baud", value)
