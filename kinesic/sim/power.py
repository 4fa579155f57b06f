"""What the servos draw and how warm they get, by the law of a DC motor behind a PWM bridge.

A servo's stall figures are those of its motor at full duty: current per torque is stall current over stall torque, and
the winding's resistance is the voltage over the stall current. The bridge draws the motor's current for the share of
time that it is on. What a braking motor gives back is not counted: most supplies cannot take it.

A supply may sag. Per step of the physics: with a share v of the open voltage U, a servo of duty d whose speed is the
share w of that without load has the share v d - w of its stall torque, and draws d (v d - w) of its stall current. So
the sum I of all currents grows with v, in straight pieces, and v = 1 - R I(v) / U has one solution; Newton's steps
from v = 1 come to it from above, exactly, after as many steps as servos begin to brake on the way. The same holds for
the v at which a supply that limits its current gives just that.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.command import Power
from kinesic.body.servo import Drives
from kinesic.sim.servo_factors import Factors

FULL_SUPPLY = sealed([1.0])  # share of its voltage that a stiff supply has
LOWEST_VOLTAGE = 0.4  # share of the voltage at which servos would go out: the twin's do not, they only stay as weak
CLOSE = 1e-6  # change of the share that is none


@dataclass(frozen=True, eq=False)
class DriveEffort:
    """What the servos' law says for each step of the physics, in joint order."""

    duties: Floats  # (s, n) demanded, may exceed 1
    applied: Floats  # (s, n) within -1..1
    loads: Floats  # (s, n) torque over stall torque, which is motor current over stall current
    supplied: Floats  # (s,) or (1,) share of its voltage that the supply had


def effort(drives: Drives, errors: Floats, speeds: Floats, *, supplied: Floats = FULL_SUPPLY) -> DriveEffort:
    """Computes demanded duty, applied duty and share of stall torque of each drive at each step of the physics.

    Args:
        drives: in joint order.
        errors: (s, n) [rad] goals minus angles.
        speeds: (s, n) [rad/s].
        supplied: (s,) or (1,) share of its voltage that the supply had.
    """
    duties = drives.demanded(errors, speeds)
    applied = np.clip(duties, -1.0, 1.0)
    return DriveEffort(duties, applied, drives.loads(applied, speeds, supplied), supplied)


@dataclass(frozen=True, eq=False)
class Spent:
    """What servos have taken up to a step of the physics, and how warm that left them."""

    charge: Floats  # (n,) [As] of each drive's supply
    warmth: Floats  # (w,) [K] of the windings whose thermal figures are known


def power(
    names: tuple[str, ...],
    drives: Drives,
    given: DriveEffort,
    *,
    spans: Floats,
    counts: list[int],
    before: Spent | None = None,
) -> tuple[Power, Spent]:
    """Sums up what the servos took from the supply.

    Args:
        names: of the hinges.
        drives: in joint order.
        given: what the servos did on each step.
        spans: (s,) [s] how long each step was.
        counts: (m,) steps so far at each command.
        before: what was spent up to the first of these steps, if that is counted already.
    """
    windings, new = windings_of(names, drives), 0 if before is None else 1
    charge, warmth = (before.charge, before.warmth) if before else (0.0, np.zeros(len(windings)))
    drawn = given.applied * given.loads
    np.maximum(drawn, 0.0, out=drawn)
    drawn *= drives.stall_current
    drawn += drives.idle_current  # (s, n) [A]
    current = drawn.sum(axis=1)
    edges = _edges(counts, new)
    lasting = np.add.reduceat(np.append(spans, 0.0), edges)[::2]
    mean = current[edges[1::2] - 1]  # of an interval without length, as on the step before
    np.divide(np.add.reduceat(np.append(current * spans, 0.0), edges)[::2], lasting, out=mean, where=lasting > 0.0)
    charge = charge + (spans * given.supplied)[new:] @ drawn[new:]
    rises = [
        np.append([rise] * new, each.warm(given.loads[new:, each.hinge], spans[new:], rise))
        for each, rise in zip(windings, warmth.tolist(), strict=True)
    ]
    spent = Spent(sealed(charge), sealed([rise[-1] for rise in rises]))
    return Power(
        mean=sealed(mean),
        peak=sealed(np.maximum.reduceat(np.append(current, 0.0), edges)[::2]),
        energy=float(spent.charge @ drives.volt),
        volts=float(given.supplied.min() * drives.volt.max()),
        warming={each.name: sealed(rise[edges[1::2] - 1]) for each, rise in zip(windings, rises, strict=True)},
    ), spent


def _edges(counts: list[int], first: int) -> Indices:
    """(2 m,) first step and end of each command's interval; of one without length, the step before."""
    ends = np.array(counts, dtype=np.intp)
    return np.stack([np.minimum(np.concatenate([[first], ends[:-1]]), ends - 1), ends], axis=1).ravel()


@dataclass(frozen=True)
class Winding:
    """The winding of a servo whose thermal figures are known."""

    name: str  # of the hinge
    hinge: int
    loss: float  # [W] of one servo that gives its stall torque
    resistance: float  # [K/W]
    capacity: float  # [J/K]

    def kept(self, spans: Floats) -> Floats:
        """Computes what each of some steps, (s,) [s], leaves of the warmth before it."""
        return np.exp(-spans / (self.resistance * self.capacity))

    def warm(self, loads: Floats, spans: Floats, rise: float) -> Floats:
        """Computes the rise (s,) [K] of a winding, from one [K] on, for shares (s,) of the stall torque."""
        settled = self.loss * loads**2 * self.resistance  # [K] where each loss alone would lead
        rises = []
        for goal, share in zip(settled.tolist(), self.kept(spans).tolist(), strict=True):
            rise = goal + (rise - goal) * share
            rises.append(rise)
        return np.array(rises)


def windings_of(names: tuple[str, ...], drives: Drives) -> tuple[Winding, ...]:
    """Lists the windings whose thermal figures are known.

    Args:
        names: of the hinges.
        drives: in joint order.
    """
    return tuple(
        Winding(name, k, float(drives.volt[k] * drives.servo_current[k]), *drive.servo.thermal)
        for k, (name, drive) in enumerate(zip(names, drives, strict=True))
        if drive.servo.thermal is not None
    )


@dataclass(frozen=True, eq=False)
class Supply:
    """The supply that feeds the servos, whose voltage sags under load."""

    drives: Drives
    resistance: float  # [ohm]
    amps: float  # [A] at most
    volts: float  # [V] without load

    @classmethod
    def of(cls, drives: Drives, factors: Factors) -> "Supply | None":
        """Makes the supply that factors describe, for drives at its open voltage; None where it holds its voltage."""
        sags = factors.resistance > 0.0 or np.isfinite(factors.amps)
        return cls(drives, factors.resistance, factors.amps, float(drives.volt.max())) if sags else None

    def share(self, duties: Floats, speeds: Floats) -> float:
        """Finds the share of its voltage that is left.

        Args:
            duties: (n,) -1..1 that the servos apply.
            speeds: (n,) [rad/s].
        """
        drives, drop = self.drives, self.resistance / self.volts
        asked, back = drives.stall_current * duties**2, drives.stall_current * duties * speeds / drives.no_load
        idle, share = float(drives.idle_current.sum()), 1.0
        while True:
            drawing = share * asked > back
            slope, rest = float(asked[drawing].sum()), idle - float(back[drawing].sum())
            fallen = (1.0 - drop * rest) / (1.0 + drop * slope)
            if slope > 0.0 and fallen * slope + rest > self.amps:
                fallen = (self.amps - rest) / slope
            if fallen < LOWEST_VOLTAGE:
                return LOWEST_VOLTAGE
            if fallen > share - CLOSE:
                return min(share, fallen)
            share = fallen

    def goals(self, goals: Floats, angles: Floats, speeds: Floats, caps: Floats | float = 1.0) -> tuple[Floats, float]:
        """Finds the goals with which servos at their full voltage would do what these do at what is left of it.

        Args:
            goals: (n,) [rad] of the servos.
            angles: (n,) [rad] as they measure them.
            speeds: (n,) [rad/s] likewise.
            caps: (n,) 0..1 of the duty that each may use.

        Returns:
            (n,) [rad], and the share of the voltage.
        """
        drives = self.drives
        rate = drives.rate_gain / drives.stall * speeds
        duties = np.clip(drives.gain * (goals - angles) - rate, -np.asarray(caps), caps)
        share = self.share(duties, speeds)
        return angles + (share * duties + rate) / drives.gain, share
