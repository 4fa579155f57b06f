"""What a trajectory may not exceed, per hinge."""

from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.dynamics import Load
from kinesic.body.robot import Robot

STALL_SHARE = 0.8  # of the stall torque that accelerating may use
LEAST_ACCELERATION = 1.0  # [rad/s^2] what a hinge is granted that can hardly hold itself
RISE = 0.04  # [s] in which the acceleration may go from nothing to its limit
DUTY = 0.73  # of full PWM that a plan may use; the rest is for other hinges' pull and for servos a quarter weaker
UNFELT = 1e-6  # share of the duty that a hinge takes at its boxes where no drive is known
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
        """Scales the limits of acceleration, jerk and duty by a share, or by (n,) shares."""
        if isinstance(share, float) and share == 1.0:
            return self
        return replace(
            self,
            acceleration=sealed(self.acceleration * share),
            jerk=sealed(self.jerk * share),
            duty=sealed(self.duty * share),
        )

    def part(self, hinges: Indices) -> "Limits":
        """Takes the limits of some hinges, in their order."""
        return Limits(*(sealed(values[hinges]) for values in vars(self).values()))

    @classmethod
    def box(cls, *, lower: Floats, upper: Floats, speed: Floats, acceleration: Floats, jerk: Floats) -> "Limits":
        """Makes limits for hinges without a known drive: boxes alone, with a duty row that never binds.

        Args:
            lower: (n,) [rad].
            upper: (n,) [rad].
            speed: (n,) [rad/s].
            acceleration: (n,) [rad/s^2].
            jerk: (n,) [rad/s^3].

        Raises:
            ValueError: the rows have different lengths, a range is empty, or a limit is not positive.
        """
        rows = {"lower": lower, "upper": upper, "speed": speed, "acceleration": acceleration, "jerk": jerk}
        boxes = {name: sealed(np.array(row, dtype=np.float64)) for name, row in rows.items()}
        shapes = {name: box.shape for name, box in boxes.items()}
        if len(set(shapes.values())) > 1 or boxes["lower"].ndim != 1:
            raise ValueError(f"limits have shapes {shapes}; give one number per hinge in each")
        if not (boxes["lower"] < boxes["upper"]).all():
            raise ValueError(f"lower {boxes['lower'].tolist()} must be below upper {boxes['upper'].tolist()}")
        for name in ("speed", "acceleration", "jerk"):
            if not (np.isfinite(boxes[name]) & (boxes[name] > 0.0)).all():
                raise ValueError(f"{name} is {boxes[name].tolist()}; every limit must be finite and above 0")
        inertial, viscous = UNFELT / boxes["acceleration"], UNFELT / boxes["speed"]
        return cls(**boxes, inertial=sealed(inertial), viscous=sealed(viscous), duty=sealed(np.ones(len(inertial))))

    @classmethod
    def of(cls, robot: Robot, load: Load) -> "Limits":
        """Derives the limits of a robot whose hinges bear a load."""
        stall = robot.drives.stall
        still = (load.holding + robot.drives.frictionloss) / stall
        acceleration = np.maximum((STALL_SHARE - still) * stall / load.inertia, LEAST_ACCELERATION)
        return cls(
            lower=robot.skeleton.lower,
            upper=robot.skeleton.upper,
            speed=robot.speed_limits,
            acceleration=sealed(acceleration),
            jerk=sealed(acceleration / RISE),
            inertial=sealed(load.inertia / stall),
            viscous=sealed(1.0 / robot.drives.no_load),
            duty=sealed(np.maximum(DUTY - still, LEAST_DUTY)),
        )
