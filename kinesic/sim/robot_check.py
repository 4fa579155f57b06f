"""Checks a robot's description before anything moves: torque, mass and room to itself."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.worst_postures import random_postures

POSTURES = 2000


@dataclass(frozen=True)
class ClosestPair:
    """The two segments that are closest in a posture."""

    distance: float  # [m] negative when they overlap
    pair: tuple[str, str]


@dataclass(frozen=True, eq=False)
class RobotCheck:
    """The figures of merit of a robot, in joint order."""

    rest_ratios: Floats  # (n,) share of the stall torque that holds the rest posture
    worst_ratios: Floats  # (n,) the largest share found in any posture
    worst_postures: Floats  # (n, n) [rad] row j: the posture where hinge j needs that share
    mass: float  # [kg] of everything, servos and base included
    moving_mass: float  # [kg] without what stands on the ground
    arm_length: float  # [m]
    rest_gap: ClosestPair
    zero_gap: ClosestPair  # all hinges at 0, or at the stop nearest to it
    clear_share: float  # of uniformly random postures that keep the robot's least clearance


def check_robot(robot: Robot) -> RobotCheck:
    """Weighs a robot and searches its worst postures.

    Args:
        robot: the description.

    Returns:
        The same figures for the same robot: random postures are seeded.
    """
    dynamics, distances = MujocoDynamics(robot), CapsuleDistances(robot)
    postures = random_postures(robot.skeleton, POSTURES)  # first rest and zero; every other one has no stops
    clearance = distances.clearance(postures)
    worst = dynamics.worst_static
    mass = _mass(robot)
    return RobotCheck(
        rest_ratios=sealed(dynamics.static_ratios(postures[:1])[0]),
        worst_ratios=worst.values,
        worst_postures=worst.postures,
        mass=sum(mass.values()),
        moving_mass=sum(mass[segment.name] for segment in robot.skeleton.segments if segment.parent is not None),
        arm_length=robot.arm_length,
        rest_gap=ClosestPair(float(clearance.distances[0]), clearance.pairs[0]),
        zero_gap=ClosestPair(float(clearance.distances[1]), clearance.pairs[1]),
        clear_share=float(np.mean(clearance.distances[::2] >= robot.least_clearance)),
    )


def _mass(robot: Robot) -> dict[str, float]:
    """Segment -> [kg] of its structure and the servos mounted on it."""
    mass = {segment.name: segment.mass for segment in robot.skeleton.segments}
    for mount in robot.mounts:
        mass[mount.segment] += mount.drive.count * mount.drive.servo.mass
    return mass
