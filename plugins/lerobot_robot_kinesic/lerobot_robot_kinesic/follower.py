"""Motion of joints to changing targets within limits of velocity and acceleration."""

from collections.abc import Iterator
from math import floor

import numpy as np

from kinesic.body.command import COMMAND_RATE, Command
from kinesic.body.robot import Robot

TICK = 1.0 / COMMAND_RATE  # [s] between two commands
ACCELERATION_TIME = 0.25  # [s] from rest to the highest velocity


class Follower:
    """Commands, 100 per second, that move all hinges to the latest target.

    Each hinge accelerates and decelerates evenly, and never passes the target.
    """

    def __init__(self, robot: Robot, velocity: float) -> None:
        """Begin at rest in the rest posture.

        Args:
            robot: robot to be moved.
            velocity: highest velocity as a fraction of the robot's limits.

        Raises:
            ValueError: the fraction is outside 0.01 to 1.
        """
        if not 0.01 <= velocity <= 1.0:
            raise ValueError(f"velocity is {velocity}; must be 0.01 to 1, such as 0.5")
        skeleton = robot.skeleton
        self._lower, self._upper = skeleton.lower, skeleton.upper
        self._velocity = velocity * robot.velocity_limits
        self._acceleration = self._velocity / ACCELERATION_TIME
        self._angles = np.array(skeleton.rest, dtype=np.float64)
        self._rates = np.zeros(len(self._angles))
        self._next = 0  # number of the next command
        self.target = self._angles.copy()  # (n,) [rad] latest target

    def aim(self, target: np.ndarray) -> np.ndarray:
        """Set the target [rad], clipped to the ranges, and return it.

        Raises:
            ValueError: the target is not one finite number for each hinge.
        """
        if target.shape != self._angles.shape or not np.isfinite(target).all():
            raise ValueError(f"action is {target.tolist()}; must be {len(self._angles)} finite numbers")
        self.target = np.clip(target, self._lower, self._upper)
        return self.target

    def commands(self, until: float) -> Iterator[Command]:
        """Yield the commands that are due until a time [s]."""
        last = floor(until * COMMAND_RATE + 1e-6)
        while self._next <= last:
            yield self._step(self._next * TICK)
            self._next += 1

    def _step(self, time: float) -> Command:
        way = self.target - self._angles
        step = self._acceleration * TICK
        # velocity from which each hinge can still stop at its target with whole steps of deceleration
        braking = -step / 2 + np.sqrt(step**2 / 4 + 2.0 * self._acceleration * np.abs(way))
        wanted = np.sign(way) * np.minimum(np.minimum(self._velocity, braking), np.abs(way) / TICK)
        rates = np.clip(wanted, self._rates - step, self._rates + step)
        accelerations = (rates - self._rates) / TICK
        self._angles = np.clip(self._angles + rates * TICK, self._lower, self._upper)
        self._rates = rates
        return Command(time, self._angles.copy(), rates, accelerations, self._angles.copy())
