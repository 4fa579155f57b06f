"""Checks of a robot's description before it moves: torque, mass and clearance."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.worst_postures import random_postures

CHECKED_POSTURES = 2000  # number of random postures whose clearance is measured


@dataclass(frozen=True)
class ClosestPair:
    """Closest pair of segments in a posture."""

    distance: float  # [m] negative if they overlap
    pair: tuple[str, str]


@dataclass(frozen=True, eq=False)
class RobotCheck:
    """Static torque, mass and clearance of a robot, in joint order."""

    rest_ratios: Floats  # (n,) holding torque / stall torque in the rest posture
    worst_ratios: Floats  # (n,) largest holding torque / stall torque over all postures
    worst_postures: Floats  # (n, n) [rad] row j: the posture with the largest ratio of hinge j
    mass: float  # [kg] total, including servos and base
    moving_mass: float  # [kg] total without the fixed base
    arm_length: float  # [m] from shoulder to wrist
    rest_gap: ClosestPair  # in the rest posture
    zero_gap: ClosestPair  # with all hinges at 0, or at the stop closest to 0
    clear_share: float  # fraction of uniformly random postures with at least the robot's minimum clearance


def check_robot(robot: Robot) -> RobotCheck:
    """Check a robot's masses, clearances and worst static torques.

    Args:
        robot: Description.

    Returns:
        The same values for the same robot: random postures are seeded.
    """
    dynamics, distances = MujocoDynamics(robot), CapsuleDistances(robot)
    postures = random_postures(
        robot.skeleton, CHECKED_POSTURES
    )  # rest and zero first; every second posture is uniform, without hinges at stops
    clearance = distances.clearance(postures)
    worst = dynamics.worst_static
    mass = _sum_masses(robot)
    return RobotCheck(
        rest_ratios=sealed(dynamics.static_ratios(postures[:1])[0]),
        worst_ratios=worst.values,
        worst_postures=worst.postures,
        mass=sum(mass.values()),
        moving_mass=sum(mass[segment.name] for segment in robot.skeleton.segments if segment.parent is not None),
        arm_length=robot.arm_length,
        rest_gap=ClosestPair(float(clearance.distances[0]), clearance.pairs[0]),
        zero_gap=ClosestPair(float(clearance.distances[1]), clearance.pairs[1]),
        clear_share=float(np.mean(clearance.distances[::2] >= robot.min_clearance)),
    )


def _sum_masses(robot: Robot) -> dict[str, float]:
    """Return each segment's mass [kg] with the servos mounted on it."""
    mass = {segment.name: segment.mass for segment in robot.skeleton.segments}
    for mount in robot.mounts:
        mass[mount.segment] += mount.drive.count * mount.drive.servo.mass
    return mass
