"""Stability of the observer's correction on stiff or delayed servos.

The loop of observer and servo is linear within its bounds (`controller.observer`). It is unstable if a pole lies
outside the unit circle, and oscillates long if a pole lies just within.
"""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import Robot
from kinesic.controller.observer import Observer, forecast_servo
from kinesic.controller.observer_step import RESTORING_GAINS

MAX_POLE = 0.97  # largest pole magnitude of a well-damped loop, unless the servo alone is slower
RESTORING_FRACTIONS = (1.0, 0.75, 0.5, 0.25)  # fractions of `RESTORING_GAINS`, tried from the largest


def find_stable_fraction(observer: Observer, robot: Robot, dynamics: Dynamics, late: float) -> float:
    """Find the largest fraction of correction gains with a well-damped loop.

    0 if no fraction is stable enough.

    Args:
        observer: of one body.
        robot: with the estimated servos.
        dynamics: the inertia of each hinge in its worst posture.
        late: [s] until setpoints reach the servos.
    """
    allowed = np.maximum(compute_loop_poles(observer, robot, dynamics, late, part=0.0), MAX_POLE)
    for part in RESTORING_FRACTIONS:
        if np.all(compute_loop_poles(observer, robot, dynamics, late, part=part) <= allowed):
            return part
    return 0.0


def compute_loop_poles(
    observer: Observer, robot: Robot, dynamics: Dynamics, late: float, *, part: float = 1.0
) -> Floats:
    """Compute the largest pole magnitude of each hinge's correction loop, (n,).

    The loop of observer and servo is unstable from 1 on.

    Args:
        observer: of one body.
        robot: with the actual servos.
        dynamics: the inertia of each hinge in its worst posture.
        late: [s] until setpoints reach the servos.
        part: fraction of the restoring gains.
    """
    whole = int(late / observer.period + 1e-9)
    rest = late - whole * observer.period
    old, new = (forecast_servo(robot, dynamics, span) for span in (rest, observer.period - rest))
    in_flight = max(len(observer.arrival), whole + 2)  # corrections in flight, the newest first
    size = 5 + in_flight
    state = np.broadcast_to(np.eye(size), (len(old), size, size))
    servo, prior, sent = state[:, :2], state[:, 2:5], state[:, 5:]
    moved = old[:, :2, :2] @ servo + old[:, :2, 2:] @ sent[:, whole + 1 : whole + 2]
    moved = new[:, :2, :2] @ moved + new[:, :2, 2:] @ sent[:, whole : whole + 1]
    estimate = prior + observer.gain.T[:, :, None] * (servo[:, :1] - prior[:, :1])
    entered = np.zeros_like(estimate)
    entered[:, 2] = np.einsum("h,nhk->nk", observer.arrival, sent[:, : len(observer.arrival)])
    estimate = observer.forecast.transpose(2, 0, 1) @ (estimate + entered) - entered
    correction = -part * np.einsum("i,nik->nk", RESTORING_GAINS, estimate)[:, None]
    loop = np.concatenate([moved, estimate, correction, sent[:, :-1]], axis=1)
    poles: Floats = np.abs(np.linalg.eigvals(loop)).max(axis=1)
    return poles
