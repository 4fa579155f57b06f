"""Figures of servos that a log may tell, as a vector: logarithms of factors, and the latency in a unit of its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, log
from typing import Literal, get_args

import msgspec
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import DriveFactors, Factors

ServoFigure = Literal["stall", "no_load", "friction", "latency", "armature", "gain", "mass"]
FIGURES: tuple[ServoFigure, ...] = get_args(ServoFigure)  # last yields first
OF_THE_ROBOT = ("latency", "mass")
DEFAULT: tuple[ServoFigure, ...] = FIGURES[:-1]
LARGEST_LOG_FACTOR = log(4.0)  # a factor is between a quarter and four
LATENCY_UNIT = 0.01  # [s]
MOST_LATENCY = 0.05  # [s]


@dataclass(frozen=True)
class Unknown:
    """One figure of a servo model, or of the whole robot."""

    figure: ServoFigure
    servo: str = ""  # empty: of the whole robot

    def __str__(self) -> str:
        return f"{self.figure} of {self.servo}" if self.servo else self.figure

    def figure_of(self, value: float) -> float:
        """Factor, or latency [s], for a value of the vector."""
        return value * LATENCY_UNIT if self.figure == "latency" else exp(value)

    def scale(self, value: float) -> float:
        """Returns the derivative of the factor, or latency [s], with respect to the value."""
        return LATENCY_UNIT if self.figure == "latency" else exp(value)


def unknowns(robot: Robot, free: Sequence[ServoFigure]) -> tuple[Unknown, ...]:
    """Lists the free figures of each servo model of a robot; those first that yield last to others.

    Raises:
        ValueError: both stall and mass are free.
    """
    if "stall" in free and "mass" in free:
        raise ValueError("stall and mass cannot both be free: angles show only their ratio; weigh the robot")
    servos = dict.fromkeys(drive.servo.name for drive in robot.drives)
    return tuple(
        Unknown(figure, servo)
        for figure in FIGURES
        if figure in free
        for servo in (("",) if figure in OF_THE_ROBOT else servos)
    )


def bounds(of: Sequence[Unknown]) -> tuple[Floats, Floats]:
    """Finds the lowest and highest values (u,)."""
    late = np.array([unknown.figure == "latency" for unknown in of])
    return np.where(late, -1e-9, -LARGEST_LOG_FACTOR), np.where(late, MOST_LATENCY / LATENCY_UNIT, LARGEST_LOG_FACTOR)


def factors_of(of: Sequence[Unknown], values: Floats) -> Factors:
    """Translates a vector (u,) into factors."""
    whole: dict[str, float] = {}
    servos: dict[str, dict[str, float]] = {}
    for unknown, value in zip(of, values.tolist(), strict=True):
        place = servos.setdefault(unknown.servo, {}) if unknown.servo else whole
        if value != 0.0:
            place[unknown.figure] = max(0.0, unknown.figure_of(value))
    rows = {name: DriveFactors(**row) for name, row in servos.items()}
    return msgspec.structs.replace(Factors(servos=rows), **whole)
