"""Servo parameters of a fit as a vector of unknowns.

Factors are represented by their logarithms, the latency by a multiple of `LATENCY_UNIT`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, log
from typing import Literal, get_args

import msgspec
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import DriveFactors, Factors

ServoParameter = Literal["stall", "no_load", "friction", "latency", "armature", "gain", "mass"]
FIT_PARAMETERS: tuple[ServoParameter, ...] = get_args(ServoParameter)  # parameters that can be fitted, in output order
ROBOT_PARAMETERS = ("latency", "mass")  # parameters of the whole robot, not of a servo model
DEFAULT_PARAMETERS: tuple[ServoParameter, ...] = FIT_PARAMETERS[:-1]  # default fitted parameters: all but mass
MAX_LOG_FACTOR = log(4.0)  # limit of the logarithm of a factor: factors are between a quarter and four
LATENCY_UNIT = 0.01  # [s] latency per unit of the optimisation variable
MAX_LATENCY = 0.05  # [s] upper bound of the fitted latency


@dataclass(frozen=True)
class Unknown:
    """Parameter of a servo model or robot that a fit determines."""

    figure: ServoParameter  # the parameter; `kinesic twin fit --json` writes it under this key
    servo: str = ""  # servo model; empty: the whole robot

    def __str__(self) -> str:
        return f"{self.figure} of {self.servo}" if self.servo else self.figure

    def to_physical(self, value: float) -> float:
        """Convert the fitted variable to a parameter factor or a latency [s]."""
        return value * LATENCY_UNIT if self.figure == "latency" else exp(value)

    def scale(self, value: float) -> float:
        """Return the derivative of the physical value by the fitted variable.

        The physical value is a factor or a latency [s].
        """
        return LATENCY_UNIT if self.figure == "latency" else exp(value)


def list_unknowns(robot: Robot, free: Sequence[ServoParameter]) -> tuple[Unknown, ...]:
    """List the free parameters of a robot and of its servo models.

    The order is that of `FIT_PARAMETERS`.

    Raises:
        ValueError: both stall and mass are free.
    """
    if "stall" in free and "mass" in free:
        raise ValueError("stall and mass cannot both be free: angles show only their ratio; weigh the robot")
    servos = dict.fromkeys(drive.servo.name for drive in robot.drives)
    return tuple(
        Unknown(figure, servo)
        for figure in FIT_PARAMETERS
        if figure in free
        for servo in (("",) if figure in ROBOT_PARAMETERS else servos)
    )


def value_bounds(parameters: Sequence[Unknown]) -> tuple[Floats, Floats]:
    """Return the lower and upper bounds of the fitted variables, each (u,)."""
    is_latency = np.array([unknown.figure == "latency" for unknown in parameters])
    return np.where(is_latency, 0.0, -MAX_LOG_FACTOR), np.where(is_latency, MAX_LATENCY / LATENCY_UNIT, MAX_LOG_FACTOR)


def to_factors(parameters: Sequence[Unknown], values: Floats) -> Factors:
    """Convert fitted variables (u,) to factors on servo and robot parameters."""
    robot_factors: dict[str, float] = {}
    servo_values: dict[str, dict[str, float]] = {}
    for unknown, value in zip(parameters, values.tolist(), strict=True):
        target = servo_values.setdefault(unknown.servo, {}) if unknown.servo else robot_factors
        if value != 0.0:
            target[unknown.figure] = max(0.0, unknown.to_physical(value))
    servo_factors = {name: DriveFactors(**row) for name, row in servo_values.items()}
    return msgspec.structs.replace(Factors(servos=servo_factors), **robot_factors)
