"""How every servo is: temperature, load, voltage, errors and torque, as its last record says."""

from dataclasses import dataclass, field

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.hardware.bus.cycle import Records
from kinesic.hardware.protocol.registers import Register

VOLT = Register.PRESENT_INPUT_VOLTAGE.field.scale


def _nobody() -> Floats:
    return sealed([])


@dataclass(frozen=True, eq=False)
class Telemetry:
    """How all servos are at one moment, in the order of the manifest; NaN for one that has not answered lately."""

    clock: float = 0.0  # [s] of the machine's monotonic clock; 0: nothing was said yet
    celsius: Floats = field(default_factory=_nobody)  # (m,) [C]
    load: Floats = field(default_factory=_nobody)  # (m,) of its current's limit; positive: its hinge's angle rises
    volts: Floats = field(default_factory=_nobody)  # (m,) [V]
    errors: Floats = field(default_factory=_nobody)  # (m,) bits of HARDWARE_ERROR_STATUS
    torque: Floats = field(default_factory=_nobody)  # (m,) 1: it has torque

    @classmethod
    def of(cls, clock: float, records: Records, answered: Flags, *, full: Floats, turns: Floats) -> "Telemetry":
        """Reads it from the last records of all servos.

        Args:
            clock: [s] now.
            records: (m,) the last ones.
            answered: (m,) who has answered lately.
            full: (m,) raw current at the limit of each.
            turns: (m,) signed servo turns per hinge turn.
        """
        figures = (
            records["temperature"],
            records["current"] / full * np.sign(turns),
            records["volts"] * VOLT,
            records["hardware_error"],
            records["torque"] != 0,
        )
        return cls(clock, *(sealed(np.where(answered, figure, np.nan)) for figure in figures))

    @property
    def figures(self) -> Floats:
        """(5, m) all of them: temperature, load, voltage, errors, torque."""
        return np.array([self.celsius, self.load, self.volts, self.errors, self.torque])
