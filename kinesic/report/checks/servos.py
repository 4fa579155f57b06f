"""Checks of the servos: load, what they take from the supply, and how warm their windings get.

Supply and windings are checked where the robot's file tells enough of them.
"""

import numpy as np

from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check, format_time, goal

SATURATION = 0.0  # [s]
CONTINUOUS = 0.3  # share of the stall torque that a servo gives for long
WARMING = 40.0  # [K] from a warm housing of 40 C to the 80 C at which servos switch off


def servo_checks(performance: Performance) -> list[Check]:
    """Time at full duty, and the torque that heats."""
    names = performance.plan.setup.robot.skeleton.names
    measured = performance.measured
    over = np.abs(measured.duties) > 1.0
    saturated = over.sum(axis=0) * performance.period
    longest = int(saturated.argmax())
    where = f"{names[longest]} from {measured.times[over[:, longest].argmax()]:.2f} s" if over.any() else ""
    stall = np.array([drive.stall for drive in performance.robot.drives])
    loads = np.sqrt((measured.torques**2).mean(axis=0)) / stall
    heaviest = int(loads.argmax())
    return [
        goal("servo.saturation", float(saturated[longest]), SATURATION, "s", where),
        goal("servo.load", float(loads[heaviest]), CONTINUOUS, "of stall", names[heaviest]),
    ]


def power_checks(performance: Performance) -> list[Check]:
    """Current against the supply, none for a robot without one; warming of the servos whose figures are known."""
    measured, supply = performance.measured, performance.plan.setup.robot.supply
    power, found = measured.power, []
    if supply is not None:
        highest = int(power.peak.argmax())
        where = format_time(measured.times[highest])
        found.append(goal("power.peak", float(power.peak[highest]), supply.amps, "A", where))
        found.append(goal("power.mean", float(power.mean.mean()), supply.amps, "A", f"{power.energy:.0f} J in all"))
    if power.warming:
        hottest = max(power.warming, key=lambda name: float(power.warming[name].max()))
        rise = power.warming[hottest]
        where = f"{hottest} {format_time(measured.times[rise.argmax()])}"
        found.append(goal("power.warming", float(rise.max()), WARMING, "K", where))
    return found
