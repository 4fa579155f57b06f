"""How near the twin stays to the plan, while a hinge moves."""

from dataclasses import dataclass

import numpy as np

from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check, at, goal
from kinesic.sim.servo_factors import NOMINAL

RMSE = {True: 0.2, False: 1.0}  # [deg] whether the servos are as described
P95 = 2.5  # [deg]
MAX = 5.0  # [deg]
LATENESS = 0.030  # [s] of a hinge


@dataclass(frozen=True)
class Tracking:
    """Errors of all moving hinges together [deg]; 0 when nothing moves."""

    rmse: float
    p95: float
    max: float


def tracking(performance: Performance) -> Tracking:
    """Root mean square, 95th percentile and largest error over the samples that count."""
    errors = np.degrees(np.abs(performance.errors[performance.reference.moving]))
    if not len(errors):
        return Tracking(0.0, 0.0, 0.0)
    return Tracking(float(np.sqrt(np.mean(errors**2))), float(np.percentile(errors, 95)), float(errors.max()))


def tracking_checks(performance: Performance) -> list[Check]:
    """Error and lateness; none when nothing moves."""
    if not performance.reference.moving.any():
        return []
    names = performance.plan.facts.robot.skeleton.names
    errors = np.nan_to_num(np.abs(performance.errors))
    row, hinge = np.unravel_index(int(errors.argmax()), errors.shape)
    squares = (errors**2).sum(axis=0)
    found = tracking(performance)
    moving = int(performance.reference.moving.any(axis=0).sum())
    late = np.nan_to_num(np.abs(performance.lateness))
    last = int(late.argmax())
    return [
        goal("tracking.rmse", found.rmse, RMSE[performance.twin == NOMINAL], "deg", f"most {names[squares.argmax()]}"),
        goal("tracking.p95", found.p95, P95, "deg", f"of {moving} moving hinge{'s' if moving > 1 else ''}"),
        goal("tracking.max", found.max, MAX, "deg", f"{names[hinge]} {at(performance.measured.times[row])}"),
        goal("tracking.lateness", float(late[last]), LATENESS, "s", names[last]),
    ]
