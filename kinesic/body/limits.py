"""What a trajectory may not exceed, per hinge."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Load
from kinesic.body.robot import Robot

STALL_SHARE = 0.8  # of the stall torque that accelerating may use
LEAST_ACCELERATION = 1.0  # [rad/s^2] what a hinge is granted that can hardly hold itself
RISE = 0.04  # [s] in which the acceleration may go from nothing to its limit
DUTY = 0.73  # of full PWM that a plan may use; the rest is for other hinges' pull and for servos a quarter weaker
LEAST_DUTY = 0.1  # what is granted to a hinge that can hardly hold itself


@dataclass(frozen=True, eq=False)
class Limits:
    """Boxes on angle, speed, acceleration and jerk, and a row for the duty, in joint order.

    The duty of a drive is torque / stall + speed / no-load; with its worst load in any posture,
    |inertial * acceleration + viscous * speed| <= duty.
    """

    lower: Floats  # (n,) [rad]
    upper: Floats  # (n,) [rad]
    speed: Floats  # (n,) [rad/s]
    acceleration: Floats  # (n,) [rad/s^2]
    jerk: Floats  # (n,) [rad/s^3]
    inertial: Floats  # (n,) [s^2/rad] duty per acceleration
    viscous: Floats  # (n,) [s/rad] duty per speed
    duty: Floats  # (n,) what holding and friction leave for motion

    def times(self, share: float | Floats) -> "Limits":
        """With a share, or (n,) shares, of the limits of acceleration, jerk and duty."""
        return replace(
            self,
            acceleration=sealed(self.acceleration * share),
            jerk=sealed(self.jerk * share),
            duty=sealed(self.duty * share),
        )

    def part(self, hinges: NDArray[np.intp]) -> "Limits":
        """Those of some hinges, in their order."""
        return Limits(*(sealed(values[hinges]) for values in vars(self).values()))

    @classmethod
    def of(cls, robot: Robot, load: Load) -> "Limits":
        """The limits of a robot whose hinges bear a load."""
        stall = np.array([drive.stall for drive in robot.drives])
        no_load = np.array([drive.no_load for drive in robot.drives])
        friction = np.array([drive.frictionloss for drive in robot.drives])
        still = (load.holding + friction) / stall
        acceleration = np.maximum((STALL_SHARE - still) * stall / load.inertia, LEAST_ACCELERATION)
        return cls(
            lower=robot.skeleton.lower,
            upper=robot.skeleton.upper,
            speed=robot.speed_limits,
            acceleration=sealed(acceleration),
            jerk=sealed(acceleration / RISE),
            inertial=sealed(load.inertia / stall),
            viscous=sealed(1.0 / no_load),
            duty=sealed(np.maximum(DUTY - still, LEAST_DUTY)),
        )
