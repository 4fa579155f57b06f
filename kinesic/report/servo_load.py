"""What each servo has to bear: duty, torque as a share of stall, and its mean against what it can give for long."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.controller.performance import Performance
from kinesic.report.checks.servos import CONTINUOUS

FULL = 1.0  # duty, above which the servo gives all it has


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
        return max(self.duty / FULL, self.rms / CONTINUOUS)


def loads(performance: Performance) -> tuple[DriveLoad, ...]:
    """Every drive, the most strained first."""
    measured, robot = performance.measured, performance.robot
    duties = np.abs(measured.duties)
    shares = np.abs(measured.torques) / np.array([drive.stall for drive in robot.drives])
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
            saturated=float((duties[:, k] > FULL).sum() * performance.period),
            duties=duties[:, k],
        )
        for k, (name, drive) in enumerate(zip(robot.skeleton.names, robot.drives, strict=True))
    ]
    return tuple(sorted(found, key=lambda load: -load.strain))


@dataclass(frozen=True)
class Draw:
    """What all servos together took from the supply."""

    mean: float  # [A]
    peak: float  # [A]
    peak_at: float  # [s]
    energy: float  # [J]
    allowed: float | None  # [A] that the supply gives for long; None: not described
    warmest: str  # hinge; empty where no servo's thermal figures are known
    warming: float  # [K] of its winding


def draw_load(performance: Performance) -> Draw:
    """Current, energy and warming over the performance in the twin."""
    measured, supply = performance.measured, performance.plan.setup.robot.supply
    power = measured.power
    warming = {name: float(rise.max()) for name, rise in power.warming.items()}
    warmest = max(warming, key=lambda name: warming[name], default="")
    return Draw(
        mean=float(power.mean.mean()),
        peak=float(power.peak.max()),
        peak_at=float(measured.times[power.peak.argmax()]),
        energy=power.energy,
        allowed=None if supply is None else supply.amps,
        warmest=warmest,
        warming=warming.get(warmest, 0.0),
    )
