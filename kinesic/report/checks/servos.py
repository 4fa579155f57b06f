"""Measures and checks the servos: load, what they take from the supply, and how warm their windings get.

Supply and windings are checked where the robot's file tells enough of them.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.command import Measurements
from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check, format_time

SATURATION = 0.0  # [s]
CONTINUOUS = 0.3  # share of the stall torque that a servo gives for long
FULL_DUTY = 1.0  # duty, above which the servo gives all it has
WARMING = 40.0  # [K] from a warm housing of 40 C to the 80 C at which servos switch off


def servo_checks(performance: Performance) -> list[Check]:
    """Checks the time at full duty, and the torque that heats."""
    names = performance.plan.setup.robot.skeleton.names
    measured = performance.measured
    over, squares = _sum_up_drives(measured)
    saturated = over.sum(axis=0) * performance.period
    longest = int(saturated.argmax())
    where = f"{names[longest]} from {measured.times[over[:, longest].argmax()]:.2f} s" if over.any() else ""
    loads = np.sqrt(squares / len(over)) / performance.robot.drives.stall
    heaviest = int(loads.argmax())
    return [
        Check.of("servo.saturation", float(saturated[longest]), SATURATION, where),
        Check.of("servo.load", float(loads[heaviest]), CONTINUOUS, names[heaviest]),
    ]


def _sum_up_drives(measured: Measurements) -> tuple[Flags, Floats]:
    """Finds where duties are full, (m, n), and adds up the squared torques to (n,) [Nm^2], command by command."""
    over, squares = np.empty(measured.angles.shape, dtype=np.bool_), np.zeros(measured.angles.shape[1])
    for rows in measured.windows():
        duties, torques = measured.drive_rows(rows)
        over[rows] = (duties > FULL_DUTY) | (duties < -FULL_DUTY)
        squares = np.concatenate([squares[None], torques**2]).sum(axis=0)
    return over, squares


def power_checks(performance: Performance) -> list[Check]:
    """Checks current against the supply, if the robot has one, and the warming of servos whose figures are known."""
    measured, supply = performance.measured, performance.plan.setup.robot.supply
    power, found = measured.power, []
    if supply is not None:
        highest = int(power.peak.argmax())
        where = format_time(measured.times[highest])
        found.append(Check.of("power.peak", float(power.peak[highest]), supply.amps, where))
        found.append(Check.of("power.mean", float(power.mean.mean()), supply.amps, f"{power.energy:.0f} J in all"))
    if power.warming:
        hottest = max(power.warming, key=lambda name: float(power.warming[name].max()))
        rise = power.warming[hottest]
        where = f"{hottest} {format_time(measured.times[rise.argmax()])}"
        found.append(Check.of("power.warming", float(rise.max()), WARMING, where))
    return found


@dataclass(frozen=True, eq=False)
class DriveLoad:
    """One hinge's drive over a performance in the twin."""

    hinge: str
    servo: str
    planned: float  # largest duty that the plan needs
    duty: float  # largest duty demanded in the twin, may exceed 1
    duty_at: float  # [s]
    torque: float  # largest torque over stall
    torque_at: float  # [s]
    rms: float  # root mean square of torque over stall
    saturated: float  # [s] at full duty
    duties: Floats  # (m,) magnitude over the measured times

    @property
    def strain(self) -> float:
        """How near the drive comes to what it can give, in its peak or in the long run; 1 is the limit."""
        return max(self.duty / FULL_DUTY, self.rms / CONTINUOUS)


def loads(performance: Performance) -> tuple[DriveLoad, ...]:
    """Measures the load of every drive, the most strained first."""
    measured, robot = performance.measured, performance.robot
    demanded, torques = measured.drive_rows(slice(None))
    duties, shares = np.abs(demanded), np.abs(torques) / robot.drives.stall
    found = [
        DriveLoad(
            hinge=name,
            servo=drive.servo.name if drive.count == 1 else f"{drive.count} x {drive.servo.name}",
            planned=float(np.abs(performance.reference.duties[:, k]).max()),
            duty=float(duties[:, k].max()),
            duty_at=float(measured.times[duties[:, k].argmax()]),
            torque=float(shares[:, k].max()),
            torque_at=float(measured.times[shares[:, k].argmax()]),
            rms=float(np.sqrt(np.mean(shares[:, k] ** 2))),
            saturated=float((duties[:, k] > FULL_DUTY).sum() * performance.period),
            duties=duties[:, k],
        )
        for k, (name, drive) in enumerate(zip(robot.skeleton.names, robot.drives, strict=True))
    ]
    return tuple(sorted(found, key=lambda load: -load.strain))


@dataclass(frozen=True)
class SupplyDraw:
    """What all servos together took from the supply."""

    mean: float  # [A]
    peak: float  # [A]
    peak_at: float  # [s]
    energy: float  # [J]
    allowed: float | None  # [A] that the supply gives for long; None: not described
    warmest: str  # hinge; empty where no servo's thermal figures are known
    warming: float  # [K] of its winding


def draw_load(performance: Performance) -> SupplyDraw:
    """Measures current, energy and warming over the performance in the twin."""
    measured, supply = performance.measured, performance.plan.setup.robot.supply
    power = measured.power
    warming = {name: float(rise.max()) for name, rise in power.warming.items()}
    warmest = max(warming, key=lambda name: warming[name], default="")
    return SupplyDraw(
        mean=float(power.mean.mean()),
        peak=float(power.peak.max()),
        peak_at=float(measured.times[power.peak.argmax()]),
        energy=power.energy,
        allowed=None if supply is None else supply.amps,
        warmest=warmest,
        warming=warming.get(warmest, 0.0),
    )
