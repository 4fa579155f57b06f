"""Measurements and checks of the servos: load, supply current and winding temperature.

Supply and windings are checked if the robot's file describes them.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.command import Measurements
from kinesic.metrics.dry_run import DryRun
from kinesic.report.checks.check import Check, format_time

MAX_SATURATION_TIME = 0.0  # [s] longest accepted time at full duty
CONTINUOUS_TORQUE_RATIO = 0.3  # ratio of permanently available torque to stall torque
FULL_DUTY = 1.0  # duty cycle at which a servo saturates
MAX_WARMING = 40.0  # [K] largest accepted temperature rise, from a warm housing at 40 C to shutdown at 80 C


def servo_checks(performance: DryRun) -> list[Check]:
    """Check the servos' time at full duty and RMS torque."""
    names = performance.plan.setup.robot.skeleton.names
    measured = performance.measured
    over, squares = _sum_up_drives(measured)
    saturated = over.sum(axis=0) * performance.period
    longest = int(saturated.argmax())
    where = f"{names[longest]} from {measured.times[over[:, longest].argmax()]:.2f} s" if over.any() else ""
    loads = np.sqrt(squares / len(over)) / performance.robot.drives.stall
    heaviest = int(loads.argmax())
    return [
        Check.of("servo.saturation", float(saturated[longest]), MAX_SATURATION_TIME, where),
        Check.of("servo.load", float(loads[heaviest]), CONTINUOUS_TORQUE_RATIO, names[heaviest]),
    ]


def _sum_up_drives(measured: Measurements) -> tuple[Flags, Floats]:
    """Return full-duty flags (m, n) and summed squared torques (n,) [N^2 m^2]."""
    over, squares = np.empty(measured.angles.shape, dtype=np.bool_), np.zeros(measured.angles.shape[1])
    for rows in measured.windows():
        duties, torques = measured.drive_rows(rows)
        over[rows] = (duties > FULL_DUTY) | (duties < -FULL_DUTY)
        squares = np.concatenate([squares[None], torques**2]).sum(axis=0)
    return over, squares


def power_checks(performance: DryRun) -> list[Check]:
    """Check the supply current and the winding temperature rise.

    The current is checked if the robot has a supply, the warming for servos with known thermal parameters.
    """
    measured, supply = performance.measured, performance.plan.setup.robot.supply
    power, results = measured.power, []
    if supply is not None:
        highest = int(power.peak.argmax())
        where = format_time(measured.times[highest])
        results.append(Check.of("power.peak", float(power.peak[highest]), supply.amps, where))
        results.append(Check.of("power.mean", float(power.mean.mean()), supply.amps, f"{power.energy:.0f} J in all"))
    if power.warming:
        hottest = max(power.warming, key=lambda name: float(power.warming[name].max()))
        rise = power.warming[hottest]
        where = f"{hottest} {format_time(measured.times[rise.argmax()])}"
        results.append(Check.of("power.warming", float(rise.max()), MAX_WARMING, where))
    return results


@dataclass(frozen=True, eq=False)
class DriveLoad:
    """Load of one joint's servo during a performance in the twin."""

    hinge: str
    servo: str
    planned: float  # largest duty of the plan
    duty: float  # largest duty demanded in the twin, may exceed 1
    duty_at: float  # [s] time of the largest duty
    torque: float  # largest torque / stall torque
    torque_at: float  # [s] time of the largest torque
    rms: float  # root mean square of torque / stall torque
    saturated: float  # [s] total time at full duty
    duties: Floats  # (m,) magnitude over the measured times

    @property
    def strain(self) -> float:
        """Larger of peak duty and RMS torque, each relative to its limit."""
        return max(self.duty / FULL_DUTY, self.rms / CONTINUOUS_TORQUE_RATIO)


def loads(performance: DryRun) -> tuple[DriveLoad, ...]:
    """Measure the load of every joint's servo, the highest strain first."""
    measured, robot = performance.measured, performance.robot
    demanded, torques = measured.drive_rows(slice(None))
    duties, shares = np.abs(demanded), np.abs(torques) / robot.drives.stall
    drive_loads = [
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
    return tuple(sorted(drive_loads, key=lambda load: -load.strain))


@dataclass(frozen=True)
class SupplyDraw:
    """Total current and energy of all servos, and largest winding warming [K]."""

    mean: float  # [A]
    peak: float  # [A]
    peak_at: float  # [s]
    energy: float  # [J]
    allowed: float | None  # [A] continuous current of the supply; None: not described
    warmest: str  # hinge with the warmest winding; empty without thermal data
    warming: float  # [K] temperature rise of its winding


def draw_load(performance: DryRun) -> SupplyDraw:
    """Measure supply current, energy and winding warming during a twin performance."""
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
