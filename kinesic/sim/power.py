"""Current, supply voltage and winding temperature of servos.

Each servo is a DC motor behind a PWM bridge. Its stall figures are those of the motor at full duty: current per torque
is stall current / stall torque, and the winding's resistance is voltage / stall current. The bridge draws the motor's
current for the fraction of time that it is on. Regenerated current is ignored: most supplies cannot absorb it.

A supply may sag. In each physics step: at the fraction v of the open-circuit voltage U, a servo with duty d that turns
at the fraction w of its no-load speed has the fraction v d - w of its stall torque, and draws d (v d - w) of its stall
current. The sum I of all currents therefore grows with v, piecewise linearly, and v = 1 - R I(v) / U has one solution.
Newton's method from v = 1 approaches it from above and is exact after as many steps as servos begin to brake on the
way. The same holds for the v at which a current-limited supply delivers exactly its limit.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.servo import Drives
from kinesic.sim.servo_factors import Factors

MIN_VOLTAGE_FRACTION = 0.4  # smallest voltage / open-circuit voltage; below it real servos would switch off
VOLTAGE_TOLERANCE = 1e-6  # change of the voltage fraction at which Newton's method has converged


@dataclass(frozen=True, eq=False)
class Spent:
    """Charge drawn by servos, and the heating of their windings."""

    charge: Floats  # (n,) [As] drawn by each drive from the supply
    warmth: Floats  # (w,) [K] temperature rise of windings with known thermal parameters


@dataclass(frozen=True)
class Winding:
    """Winding of a servo with known thermal parameters."""

    name: str  # name of the hinge
    hinge: int  # index of the hinge
    loss: float  # [W] heat of one servo at stall torque
    resistance: float  # [K/W] thermal resistance
    capacity: float  # [J/K] thermal capacity

    def remaining_fraction(self, spans: Floats) -> Floats:
        """Compute the remaining fraction of the winding's temperature rise after each step.

        Args:
            spans: (s,) [s] durations of the steps.
        """
        return np.exp(-spans / (self.resistance * self.capacity))


def list_windings(names: tuple[str, ...], drives: Drives) -> tuple[Winding, ...]:
    """List the windings with known thermal parameters.

    Args:
        names: Names of the hinges.
        drives: Drives in joint order.
    """
    return tuple(
        Winding(name, k, float(drives.volt[k] * drives.servo_current[k]), *drive.servo.thermal)
        for k, (name, drive) in enumerate(zip(names, drives, strict=True))
        if drive.servo.thermal is not None
    )


@dataclass(frozen=True, eq=False)
class SaggingSupply:
    """Power supply of the servos with a voltage that sags under load."""

    drives: Drives
    resistance: float  # [ohm] internal resistance
    amps: float  # [A] current limit
    volts: float  # [V] open-circuit voltage

    @classmethod
    def of(cls, drives: Drives, factors: Factors) -> "SaggingSupply | None":
        """Return the supply described by servo factors, None for constant voltage.

        Args:
            drives: Drives at the open-circuit voltage of the supply.
            factors: Deviations with resistance and current limit of the supply.
        """
        sags = factors.resistance > 0.0 or np.isfinite(factors.amps)
        return cls(drives, factors.resistance, factors.amps, float(drives.volt.max())) if sags else None

    def voltage_fraction(self, duties: Floats, velocities: Floats) -> float:
        """Compute the supply voltage as a fraction of the open-circuit voltage.

        Args:
            duties: (n,) -1..1 that the servos apply.
            velocities: (n,) [rad/s].
        """
        drives, drop = self.drives, self.resistance / self.volts
        stall_currents, back_emf_currents = (
            drives.stall_current * duties**2,
            drives.stall_current * duties * velocities / drives.no_load,
        )
        idle, fraction = float(drives.idle_current.sum()), 1.0
        while True:
            is_drawing = fraction * stall_currents > back_emf_currents
            slope, constant = float(stall_currents[is_drawing].sum()), idle - float(back_emf_currents[is_drawing].sum())
            new_fraction = (1.0 - drop * constant) / (1.0 + drop * slope)
            if slope > 0.0 and new_fraction * slope + constant > self.amps:
                new_fraction = (self.amps - constant) / slope
            if new_fraction < MIN_VOLTAGE_FRACTION:
                return MIN_VOLTAGE_FRACTION
            if new_fraction > fraction - VOLTAGE_TOLERANCE:
                return min(fraction, new_fraction)
            fraction = new_fraction

    def equivalent_setpoints(
        self, goals: Floats, angles: Floats, velocities: Floats, caps: Floats | float = 1.0
    ) -> tuple[Floats, float]:
        """Compute setpoints whose torque at full voltage equals that at sagged voltage.

        Args:
            goals: (n,) [rad] setpoints of the servos.
            angles: (n,) [rad] measured by the servos.
            velocities: (n,) [rad/s] measured by the servos.
            caps: (n,) 0..1 largest duty of each servo.

        Returns:
            (n,) [rad] setpoints, and the voltage as a fraction of the open-circuit voltage.
        """
        drives = self.drives
        rate = drives.rate_gain / drives.stall * velocities
        duties = np.clip(drives.gain * (goals - angles) - rate, -np.asarray(caps), caps)
        fraction = self.voltage_fraction(duties, velocities)
        return angles + (fraction * duties + rate) / drives.gain, fraction
