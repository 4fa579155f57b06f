"""What the performance costs the servos."""

import numpy as np

from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check, goal

SATURATION = 0.0  # [s]
CONTINUOUS = 0.3  # share of the stall torque that a servo gives for long


def servo_checks(performance: Performance) -> list[Check]:
    """Time at full duty, and the torque that heats."""
    names = performance.plan.facts.robot.skeleton.names
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
