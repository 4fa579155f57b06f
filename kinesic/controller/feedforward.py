"""Inverts the servo model: goals that make the hinges arrive where the reference is, when it is there."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Floats, seal_own, sealed
from kinesic.body.choices import Terms
from kinesic.body.command import RATE
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import Robot
from kinesic.controller.learned_gains import LearnedGains
from kinesic.sim.servo_factors import NOMINAL, Factors


class CommandedMotion(Protocol):
    """A motion, such as a trajectory, for which feed-forward computes goals."""

    def sample(self, times: Floats, /) -> tuple[Floats, Floats, Floats]:
        """Angles [rad], speeds and accelerations, each (m, n), at (m,) times [s]."""


@dataclass(frozen=True, eq=False)
class FeedForwardGoals:
    """Feed-forward goals, and the loads and duties that servos need for the reference."""

    goals: Floats  # (m, n) [rad] clipped to the ranges
    loads: Floats  # (m, n) [rad] part of the goals that carries torque
    leads: Floats  # (m, n) [rad] part of the goals that carries speed
    duties: Floats  # (m, n) torque / stall + speed / no-load of the reference, may exceed 1


@dataclass(frozen=True, eq=False)
class FeedForward:
    """The inverted model of a robot's servos.

    A servo gives torque = stall (gain e) - (stall / no_load) speed - rate_gain speed for an error e = goal - angle,
    so the error that yields a torque and a speed is ((stall / no_load + rate_gain) speed + torque) / (gain stall).
    Goals are held for a period and arrive after a delay: the reference is read half a period plus the delay ahead.
    """

    robot: Robot  # its drives and ranges
    dynamics: Dynamics
    period: float = 1 / RATE  # [s] between goals
    delay: float | Floats = 0.0  # [s] of the bus; or one for each time
    terms: Terms = "full"  # what is inverted; for measuring what each part is worth
    learned: LearnedGains | None = None  # of these very servos; None: they are as their data sheets say

    @classmethod
    def of(
        cls, robot: Robot, dynamics: Dynamics, believed: Factors, *, delay: float = 0.0, terms: Terms = "full"
    ) -> "FeedForward":
        """Leads servos as they are believed to be.

        Args:
            robot: as its data sheets describe it.
            dynamics: of the robot.
            believed: how far its servos are from them; what is bounded there is bounded here.
            delay: [s] of the bus, at least.
            terms: what is inverted.
        """
        if believed == NOMINAL:
            return cls(robot, dynamics, delay=delay, terms=terms)
        learned = LearnedGains.of_twin(robot, believed)
        return cls(robot, dynamics, delay=np.maximum(delay, learned.delay).item(), terms=terms, learned=learned)

    def lead(self, motion: CommandedMotion, times: Floats) -> FeedForwardGoals:
        """Computes the set points of a motion for goals that are sent at (m,) performance times [s]."""
        robot = self.robot
        angles, speeds, accelerations = motion.sample(times + self.period / 2 + self.delay)
        torques = self.dynamics.torques(angles, speeds, accelerations)
        drives = robot.drives
        stall, no_load, gain, rate = drives.stall, drives.no_load, drives.gain, drives.rate_gain
        duties = torques / stall + speeds / no_load
        if self.terms == "none":
            sent = motion.sample(times)[0]
            nothing = sealed(np.zeros_like(sent))
            return FeedForwardGoals(sealed(robot.skeleton.clamp(sent)), nothing, nothing, sealed(duties))
        leads = (speeds / no_load + rate * speeds / stall) / gain
        loads = torques / (gain * stall) if self.terms == "full" else np.zeros_like(torques)
        if self.learned:
            loads, leads = (1.0 + self.learned.load) * loads, (1.0 + self.learned.lead) * leads
        goals = robot.skeleton.clamp(angles + leads + loads)
        return FeedForwardGoals(seal_own(goals), seal_own(loads), seal_own(leads), seal_own(duties))
