"""Faults of a servo: alerts, reboots, silence, heat, weak motor and supply."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .faults import Fault
from .firmware import Firmware

if TYPE_CHECKING:
    from .device import Answer, Device
    from .line import Line

EVERY = 0.01  # [s] between two steps of a ramp


@dataclass
class OfServo(Fault):
    """Strikes one servo."""

    servo: int

    def begin(self, line: Line) -> None:
        self.strike(line.device(self.servo))

    def end(self, line: Line) -> None:
        for device in line.devices:
            if device.id == self.servo:
                self.heal(device)

    def strike(self, device: Device) -> None:
        """Begins."""

    def heal(self, device: Device) -> None:
        """Ends, where it can."""


@dataclass
class Alert(OfServo):
    """Hardware error, which shuts the servo down if its mask has the bit."""

    bits: int

    def strike(self, device: Device) -> None:
        device.firmware.alert(self.bits)


class Reboot(OfServo):
    """Its power fails for a moment, torque and RAM are gone."""

    def strike(self, device: Device) -> None:
        device.boot(device.firmware.time)


class BrownOut(Fault):
    """All reboot at once."""

    def begin(self, line: Line) -> None:
        for device in line.devices:
            device.boot(device.firmware.time)


class Silent(OfServo):
    """It hears, and says nothing."""

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
    """Its torque goes without a word."""

    def strike(self, device: Device) -> None:
        device.memory["torque"] = 0
        device.firmware.reload()


class GoalIgnored(OfServo):
    """It takes goals and does not follow them."""

    def strike(self, device: Device) -> None:
        device.firmware.head = lambda: None

    def heal(self, device: Device) -> None:
        device.firmware.head = Firmware.head.__get__(device.firmware)


class Stalled(OfServo):
    """Its shaft does not turn."""

    def strike(self, device: Device) -> None:
        device.shaft.jammed = True

    def heal(self, device: Device) -> None:
        device.shaft.jammed = False


@dataclass
class Ramp(OfServo):
    """A quantity moves steadily while it lasts."""

    rate: float = 0.0  # per second
    on: bool = False

    def begin(self, line: Line) -> None:
        self.on = True
        self._move(line, line.device(self.servo))

    def end(self, line: Line) -> None:
        self.on = False
        super().end(line)

    def _move(self, line: Line, device: Device) -> None:
        if self.on:
            self.change(device.firmware, self.rate * EVERY)
            line.world.call(line.world.time + EVERY, lambda: self._move(line, device))

    def change(self, firmware: Firmware, amount: float) -> None:
        """Moves it."""


@dataclass
class TemperatureRamp(Ramp):
    """It grows hot."""

    rate: float = 5.0  # [C/s]

    def change(self, firmware: Firmware, amount: float) -> None:
        firmware.celsius += amount


@dataclass
class VoltageSag(Ramp):
    """Its supply gives way."""

    rate: float = -1.0  # [V/s]

    def change(self, firmware: Firmware, amount: float) -> None:
        firmware.volts = max(0.0, firmware.volts + amount)

    def heal(self, device: Device) -> None:
        device.firmware.volts = device.memory.model.rated


@dataclass
class Undervoltage(OfServo):
    """Its supply is another."""

    volts: float = 9.0

    def strike(self, device: Device) -> None:
        device.firmware.volts = self.volts

    def heal(self, device: Device) -> None:
        device.firmware.volts = device.memory.model.rated


class Tripped(OfServo):
    """Its bus watchdog trips though the bus is busy."""

    def strike(self, device: Device) -> None:
        if device.memory["torque"]:
            device.firmware.trip()


@dataclass
class Boasting(OfServo):
    """Each answer has the alert bit, and no hardware error is shown."""

    def say(self, device: Device, answer: Answer) -> Answer:
        return replace(answer, error=answer.error | 0x80) if device.id == self.servo else answer
