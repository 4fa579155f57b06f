"""Finds how much a correction may restore where servos are known to be stiff and late, so that it comes to rest.

The loop of observer and servo is linear between its bounds (`controller.observer`): it swings up where a pole of it
lies outside the unit circle, and swings for long where one lies just within.
"""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import Robot
from kinesic.controller.observer import Observer, forecast_servo
from kinesic.controller.observer_step import RESTORING

CALM = 0.97  # largest pole of a loop that forgets a deviation within some ticks, unless its servo alone is slower
PARTS = (1.0, 0.75, 0.5, 0.25)  # of the restoring that are tried


def calm_part(observer: Observer, robot: Robot, dynamics: Dynamics, late: float) -> float:
    """Finds the largest part of its restoring with which an observer's loop comes to rest; 0: with none.

    Args:
        observer: of one body.
        robot: as its servos are believed to be.
        dynamics: the inertia of each hinge in its worst posture.
        late: [s] until goals reach the servos.
    """
    allowed = np.maximum(loop_poles(observer, robot, dynamics, late, part=0.0), CALM)
    calm = (part for part in PARTS if np.all(loop_poles(observer, robot, dynamics, late, part=part) <= allowed))
    return next(calm, 0.0)


def loop_poles(observer: Observer, robot: Robot, dynamics: Dynamics, late: float, *, part: float = 1.0) -> Floats:
    """Finds the size of the largest pole (n,) of each hinge's loop of observer and servo; from 1 on it swings up.

    Args:
        observer: of one body.
        robot: as its servos are.
        dynamics: the inertia of each hinge in its worst posture.
        late: [s] until goals reach the servos.
        part: of the restoring.
    """
    whole = int(late / observer.period + 1e-9)
    rest = late - whole * observer.period
    old, new = (forecast_servo(robot, dynamics, span) for span in (rest, observer.period - rest))
    under_way = max(len(observer.arrival), whole + 2)  # corrections, the newest first
    size = 5 + under_way
    state = np.broadcast_to(np.eye(size), (len(old), size, size))
    servo, belief, sent = state[:, :2], state[:, 2:5], state[:, 5:]
    moved = old[:, :2, :2] @ servo + old[:, :2, 2:] @ sent[:, whole + 1 : whole + 2]
    moved = new[:, :2, :2] @ moved + new[:, :2, 2:] @ sent[:, whole : whole + 1]
    told = belief + observer.gain.T[:, :, None] * (servo[:, :1] - belief[:, :1])
    entered = np.zeros_like(told)
    entered[:, 2] = np.einsum("h,nhk->nk", observer.arrival, sent[:, : len(observer.arrival)])
    told = observer.forecast.transpose(2, 0, 1) @ (told + entered) - entered
    correction = -part * np.einsum("i,nik->nk", RESTORING, told)[:, None]
    loop = np.concatenate([moved, told, correction, sent[:, :-1]], axis=1)
    poles: Floats = np.abs(np.linalg.eigvals(loop)).max(axis=1)
    return poles
