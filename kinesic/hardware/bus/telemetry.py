"""Temperature, load, voltage, errors and torque switch of all servos."""

from dataclasses import dataclass, field

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.hardware.bus.cycle import Records
from kinesic.hardware.protocol.registers import Register

VOLTS_PER_COUNT = Register.PRESENT_INPUT_VOLTAGE.field.scale  # [V] supply voltage per register count


def _no_servos() -> Floats:
    return sealed([])


@dataclass(frozen=True, eq=False)
class Telemetry:
    """Temperature, load, voltage, errors and torque switch of all servos.

    Servos are in manifest order. NaN for a servo that has not answered recently.
    """

    clock: float = 0.0  # [s] time by the machine's monotonic clock; 0: no telemetry yet
    celsius: Floats = field(default_factory=_no_servos)  # (m,) [C] temperature
    load: Floats = field(
        default_factory=_no_servos
    )  # (m,) current / current limit; positive drives the hinge's angle up
    volts: Floats = field(default_factory=_no_servos)  # (m,) [V] supply voltage
    errors: Floats = field(default_factory=_no_servos)  # (m,) bits of HARDWARE_ERROR_STATUS
    torque: Floats = field(default_factory=_no_servos)  # (m,) 1: torque is on, 0: off

    @classmethod
    def of(cls, clock: float, records: Records, answered: Flags, *, full: Floats, turns: Floats) -> "Telemetry":
        """Create telemetry from the last records of all servos.

        Args:
            clock: [s] current time.
            records: (m,) last records.
            answered: (m,) whether the servo has answered recently.
            full: (m,) raw current at the limit of each servo.
            turns: (m,) signed servo revolutions per hinge revolution.
        """
        rows = (
            records["temperature"],
            records["current"] / full * np.sign(turns),
            records["volts"] * VOLTS_PER_COUNT,
            records["hardware_error"],
            records["torque"] != 0,
        )
        return cls(clock, *(sealed(np.where(answered, row, np.nan)) for row in rows))

    @property
    def figures(self) -> Floats:
        """Temperature, load, voltage, errors and torque switch as rows (5, m)."""
        return np.array([self.celsius, self.load, self.volts, self.errors, self.torque])
