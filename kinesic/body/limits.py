"""Motion limits of each hinge."""

from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.dynamics import Load
from kinesic.body.robot import Robot

USABLE_STALL_FRACTION = 0.8  # Fraction of the stall torque available for holding, friction and acceleration
MIN_ACCELERATION = 1.0  # [rad/s^2] lower bound of acceleration limits, for hinges that can hardly hold their load
ACCELERATION_RISE_TIME = 0.04  # [s] time from zero acceleration to its limit at maximum jerk
PLANNED_DUTY = 0.73  # Maximum planned fraction of full PWM; leaves reserve for coupled loads and weak servos
NEGLIGIBLE_DUTY = 1e-6  # Duty at the velocity or acceleration limit of hinges without drive data; never binding
MIN_DUTY = 0.1  # Lower bound of the duty limit, for hinges that can hardly hold their load


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits on angle, velocity, acceleration, jerk and duty, in joint order.

    The duty of a drive is torque / stall + velocity / no-load. With the largest load of all postures, a motion must
    satisfy |inertial * acceleration + viscous * velocity| <= duty.
    """

    lower: Floats  # (n,) [rad]
    upper: Floats  # (n,) [rad]
    speed: Floats  # (n,) [rad/s]
    acceleration: Floats  # (n,) [rad/s^2]
    jerk: Floats  # (n,) [rad/s^3]
    inertial: Floats  # (n,) [s^2/rad] duty per unit of acceleration
    viscous: Floats  # (n,) [s/rad] duty per unit of velocity
    duty: Floats  # (n,) duty left for motion after holding and friction

    def scaled(self, ratio: float | Floats) -> "Limits":
        """Scale acceleration, jerk and duty limits by one ratio, or (n,) ratios."""
        if isinstance(ratio, float) and ratio == 1.0:
            return self
        return replace(
            self,
            acceleration=sealed(self.acceleration * ratio),
            jerk=sealed(self.jerk * ratio),
            duty=sealed(self.duty * ratio),
        )

    def part(self, hinges: Indices) -> "Limits":
        """Return the limits of the hinges with given indices."""
        return Limits(*(sealed(values[hinges]) for values in vars(self).values()))

    @classmethod
    def box(cls, *, lower: Floats, upper: Floats, speed: Floats, acceleration: Floats, jerk: Floats) -> "Limits":
        """Make limits from arrays (n,), with a duty limit that never binds.

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
        inertial, viscous = NEGLIGIBLE_DUTY / boxes["acceleration"], NEGLIGIBLE_DUTY / boxes["speed"]
        return cls(**boxes, inertial=sealed(inertial), viscous=sealed(viscous), duty=sealed(np.ones(len(inertial))))

    @classmethod
    def of(cls, robot: Robot, load: Load) -> "Limits":
        """Derive the limits of a robot from its drives and loads."""
        stall = robot.drives.stall
        holding_duty = (load.holding + robot.drives.frictionloss) / stall
        acceleration = np.maximum((USABLE_STALL_FRACTION - holding_duty) * stall / load.inertia, MIN_ACCELERATION)
        return cls(
            lower=robot.skeleton.lower,
            upper=robot.skeleton.upper,
            speed=robot.velocity_limits,
            acceleration=sealed(acceleration),
            jerk=sealed(acceleration / ACCELERATION_RISE_TIME),
            inertial=sealed(load.inertia / stall),
            viscous=sealed(1.0 / robot.drives.no_load),
            duty=sealed(np.maximum(PLANNED_DUTY - holding_duty, MIN_DUTY)),
        )
