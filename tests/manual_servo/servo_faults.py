"""Faults of a servo: alerts, reboots, silence, heat, weak motor and low supply."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .faults import Fault
from .firmware import Firmware

if TYPE_CHECKING:
    from .device import Answer, Device
    from .line import Line

RAMP_STEP = 0.01  # [s] time step of a ramp


@dataclass
class OfServo(Fault):
    """Fault of one servo."""

    servo: int

    def begin(self, line: Line) -> None:
        self.strike(line.device(self.servo))

    def end(self, line: Line) -> None:
        for device in line.devices:
            if device.id == self.servo:
                self.heal(device)

    def strike(self, device: Device) -> None:
        """Apply the fault to the servo."""

    def heal(self, device: Device) -> None:
        """Restore the servo's state at the end of the fault, if the fault changed it."""


@dataclass
class Alert(OfServo):
    """Hardware error, which shuts the servo down if its mask has the bit."""

    bits: int

    def strike(self, device: Device) -> None:
        device.firmware.alert(self.bits)


class Reboot(OfServo):
    """Short power failure of a servo, which loses torque and RAM."""

    def strike(self, device: Device) -> None:
        device.boot(device.firmware.time)


class BrownOut(Fault):
    """Reboot of all servos at once."""

    def begin(self, line: Line) -> None:
        for device in line.devices:
            device.boot(device.firmware.time)


class Silent(OfServo):
    """Servo that receives but does not reply."""

    def strike(self, device: Device) -> None:
        device.mute = True

    def heal(self, device: Device) -> None:
        device.mute = False


class Unhearing(OfServo):
    """Servo with a loose data cable, which neither receives nor replies."""

    def strike(self, device: Device) -> None:
        device.deaf = True

    def heal(self, device: Device) -> None:
        device.deaf = False


class TorqueOff(OfServo):
    """Servo that loses torque without a report."""

    def strike(self, device: Device) -> None:
        device.memory["torque"] = 0
        device.firmware.reload()


class GoalIgnored(OfServo):
    """Servo that acknowledges goals but does not move."""

    def strike(self, device: Device) -> None:
        device.firmware.head = lambda: None

    def heal(self, device: Device) -> None:
        device.firmware.head = Firmware.head.__get__(device.firmware)


class Stalled(OfServo):
    """Servo whose shaft is blocked."""

    def strike(self, device: Device) -> None:
        device.shaft.jammed = True

    def heal(self, device: Device) -> None:
        device.shaft.jammed = False


@dataclass
class Ramp(OfServo):
    """Fault that changes a quantity steadily while it lasts."""

    rate: float = 0.0  # [1/s] change of the quantity per second
    on: bool = False

    def begin(self, line: Line) -> None:
        self.on = True
        self._move(line, line.device(self.servo))

    def end(self, line: Line) -> None:
        self.on = False
        super().end(line)

    def _move(self, line: Line, device: Device) -> None:
        if self.on:
            self.change(device.firmware, self.rate * RAMP_STEP)
            line.world.call(line.world.time + RAMP_STEP, lambda: self._move(line, device))

    def change(self, firmware: Firmware, amount: float) -> None:
        """Change the quantity by one time step."""


@dataclass
class TemperatureRamp(Ramp):
    """Servo whose temperature rises."""

    rate: float = 5.0  # [C/s]

    def change(self, firmware: Firmware, amount: float) -> None:
        firmware.celsius += amount


@dataclass
class VoltageSag(Ramp):
    """Servo whose supply voltage falls."""

    rate: float = -1.0  # [V/s]

    def change(self, firmware: Firmware, amount: float) -> None:
        firmware.volts = max(0.0, firmware.volts + amount)

    def heal(self, device: Device) -> None:
        device.firmware.volts = device.memory.model.rated


@dataclass
class Undervoltage(OfServo):
    """Servo whose supply voltage is too low."""

    volts: float = 9.0

    def strike(self, device: Device) -> None:
        device.firmware.volts = self.volts

    def heal(self, device: Device) -> None:
        device.firmware.volts = device.memory.model.rated


class Tripped(OfServo):
    """Servo whose bus watchdog trips although the bus is busy."""

    def strike(self, device: Device) -> None:
        if device.memory["torque"]:
            device.firmware.trip()


@dataclass
class Boasting(OfServo):
    """Servo that sets the alert bit in each reply without a hardware error."""

    def say(self, device: Device, answer: Answer) -> Answer:
        return replace(answer, error=answer.error | 0x80) if device.id == self.servo else answer
