"""Feed-forward setpoints from an inverted servo model."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.choices import InvertedTerms
from kinesic.body.command import COMMAND_RATE
from kinesic.body.dynamics import Dynamics
from kinesic.body.robot import Robot
from kinesic.controller.learned_gains import LearnedGains
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors


class CommandedMotion(Protocol):
    """Interface of a motion from which feed-forward setpoints are computed."""

    def sample(self, times: Floats, /) -> tuple[Floats, Floats, Floats]:
        """Return angles, velocities and accelerations at times (m,) [s].

        Each is (m, n), in [rad] and its derivatives.
        """


@dataclass(frozen=True, eq=False)
class FeedForwardSetpoints:
    """Feed-forward setpoints, with their offsets for torque and velocity."""

    setpoints: Floats  # (m, n) [rad] clipped to the joint ranges
    loads: Floats  # (m, n) [rad] setpoint offsets for torque
    leads: Floats  # (m, n) [rad] setpoint offsets for velocity
    duties: Floats  # (m, n) torque / stall torque + velocity / no-load velocity of the reference; may exceed 1

    def __post_init__(self) -> None:
        """Make the setpoint arrays read-only."""
        for values in (self.setpoints, self.loads, self.leads, self.duties):
            values.setflags(write=False)


@dataclass(frozen=True, eq=False)
class FeedForward:
    """Feed-forward that inverts the servo model of a robot.

    A servo gives torque = stall (gain e) - (stall / no_load) velocity - rate_gain velocity for an error
    e = setpoint - angle, so the error that yields a torque and a velocity is
    ((stall / no_load + rate_gain) velocity + torque) / (gain stall). Setpoints are held for a period and arrive after a
    delay: the reference is read half a period plus the delay ahead.
    """

    robot: Robot  # robot with drives and joint ranges
    dynamics: Dynamics
    period: float = 1 / COMMAND_RATE  # [s] interval between setpoints
    delay: float | Floats = 0.0  # [s] delay of the bus, constant or (m,) for m times
    terms: InvertedTerms = "full"  # inverted terms; fewer than "full" only for comparisons
    learned: LearnedGains | None = None  # corrections for the individual servos; None: values of the data sheets

    @classmethod
    def of(
        cls, robot: Robot, dynamics: Dynamics, believed: Factors, *, delay: float = 0.0, terms: InvertedTerms = "full"
    ) -> "FeedForward":
        """Make the feed-forward from estimates of the servos.

        Args:
            robot: with the servos of the data sheets.
            dynamics: of the robot.
            believed: estimated deviation of the servos, within the bounds of `LearnedGains`.
            delay: [s] smallest bus delay.
            terms: inverted terms of the model.
        """
        if believed == NOMINAL_FACTORS:
            return cls(robot, dynamics, delay=delay, terms=terms)
        learned = LearnedGains.of_twin(robot, believed)
        return cls(robot, dynamics, delay=np.maximum(delay, learned.delay).item(), terms=terms, learned=learned)

    def compute_setpoints(self, motion: CommandedMotion, times: Floats) -> FeedForwardSetpoints:
        """Compute the setpoints of a motion at (m,) sending times [s]."""
        robot = self.robot
        angles, speeds, accelerations = motion.sample(times + self.period / 2 + self.delay)
        torques = self.dynamics.torques(angles, speeds, accelerations)
        drives = robot.drives
        stall, no_load, gain, rate = drives.stall, drives.no_load, drives.gain, drives.rate_gain
        duties = torques / stall + speeds / no_load
        if self.terms == "none":
            sent = motion.sample(times)[0]
            nothing = np.zeros_like(sent)
            return FeedForwardSetpoints(robot.skeleton.clamp(sent), nothing, nothing, duties)
        leads = (speeds / no_load + rate * speeds / stall) / gain
        loads = torques / (gain * stall) if self.terms == "full" else np.zeros_like(torques)
        if self.learned:
            loads, leads = (1.0 + self.learned.load) * loads, (1.0 + self.learned.lead) * leads
        return FeedForwardSetpoints(robot.skeleton.clamp(angles + leads + loads), loads, leads, duties)
