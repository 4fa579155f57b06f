"""Inverts the servo model: goals that make the hinges arrive where the reference is, when it is there."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import Trajectory

Terms = Literal["full", "lag", "none"]  # everything; what speed needs, but no torque; the reference itself


@dataclass(frozen=True, eq=False)
class Lead:
    """Set points, and what the servos have to give for them."""

    goals: Floats  # (m, n) [rad] clipped to the ranges
    loads: Floats  # (m, n) [rad] part of the goals that carries torque
    duties: Floats  # (m, n) torque / stall + speed / no-load of the reference, may exceed 1


def lead(
    trajectory: Trajectory,
    times: Floats,
    robot: Robot,
    dynamics: Dynamics,
    *,
    period: float,
    delay: float = 0.0,
    terms: Terms = "full",
) -> Lead:
    """Set points for the servos.

    A servo gives torque = stall (gain e) - (stall / no_load) speed - rate_gain speed for an error e = goal - angle,
    so the error that yields a wished torque and speed is ((stall / no_load + rate_gain) speed + torque) / (gain stall).
    Goals are held for a period and arrive after a delay: the reference is read half a period plus the delay ahead.

    Args:
        trajectory: the reference.
        times: (m,) [s] performance times at which goals are sent.
        robot: its drives and ranges.
        dynamics: inverse dynamics.
        period: [s] between goals.
        delay: [s] of the bus.
        terms: what is inverted; for measuring what each part is worth.
    """
    angles, speeds, accelerations = trajectory.sample(times + period / 2 + delay)
    torques = dynamics.torques(angles, speeds, accelerations)
    drives = robot.drives
    stall, no_load, gain, rate = drives.stall, drives.no_load, drives.gain, drives.rate_gain
    duties = torques / stall + speeds / no_load
    if terms == "none":
        sent = trajectory.sample(times)[0]
        return Lead(sealed(robot.skeleton.clamp(sent)), sealed(np.zeros_like(sent)), sealed(duties))
    lags = (speeds / no_load + rate * speeds / stall) / gain
    loads = torques / (gain * stall) if terms == "full" else np.zeros_like(torques)
    return Lead(sealed(robot.skeleton.clamp(angles + lags + loads)), sealed(loads), sealed(duties))
