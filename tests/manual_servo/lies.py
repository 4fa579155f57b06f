"""False present values: hung firmware, wrong clock, wrong encoder."""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random
from typing import TYPE_CHECKING

from .memory import Memory
from .servo_faults import OfServo

if TYPE_CHECKING:
    from .device import Device

PRESENT_REGISTERS = (
    "tick",
    "present_current",
    "present_velocity",
    "present_position",
    "volts",
    "celsius",
    "error",
    "torque",
)


@dataclass
class Lying(OfServo):
    """Servo with false present values."""

    def strike(self, device: Device) -> None:
        device.firmware.tampers.append(self.tamper)

    def heal(self, device: Device) -> None:
        device.firmware.tampers.remove(self.tamper)

    def tamper(self, memory: Memory) -> None:
        """Change the reported present values."""


@dataclass
class FrozenServo(Lying):
    """Servo with hung firmware, which repeats one record for ever."""

    record: dict[str, int] = field(default_factory=dict)

    def tamper(self, memory: Memory) -> None:
        if not self.record:
            self.record = {name: memory[name] for name in PRESENT_REGISTERS}
        for name, value in self.record.items():
            memory[name] = value


@dataclass
class StuckTick(Lying):
    """Servo whose clock has stopped."""

    tick: int | None = None

    def tamper(self, memory: Memory) -> None:
        self.tick = memory["tick"] if self.tick is None else self.tick
        memory["tick"] = self.tick


@dataclass
class Nonsense(Lying):
    """Servo that repeats one impossible position."""

    position: int = 1_000_000

    def tamper(self, memory: Memory) -> None:
        memory["present_position"] = self.position


@dataclass
class Scattered(Lying):
    """Servo that reports a different impossible position in each record."""

    seed: int = 1

    def tamper(self, memory: Memory) -> None:
        memory["present_position"] = Random(f"{self.seed} {memory['tick']}").randrange(-(2**31), 2**31)


@dataclass
class TurnOffset(Lying):
    """Servo whose reported position is off by whole turns."""

    turns: int = 1

    def tamper(self, memory: Memory) -> None:
        memory["present_position"] += 4096 * self.turns


@dataclass
class DriftingClock(OfServo):
    """Servo whose clock runs too fast or too slow."""

    rate: float = 1.02

    def strike(self, device: Device) -> None:
        device.firmware.drift = self.rate

    def heal(self, device: Device) -> None:
        device.firmware.drift = 1.0
