"""Moves the robot's twin by its virtual servos: what a real driver sends moves the simulated body."""

from collections.abc import Sequence
from math import copysign

import numpy as np

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import TICK
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.physics import Demand, Shaft
from kinesic.hardware.virtual.wiring import Cable
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.servo_shafts import Shafts
from kinesic.sim.twin import STEP

AT_ONCE = 1e-9  # [s] in which nothing moves: several things happen at the same time


class TwinPhysics:
    """The shafts of all servos of a robot, moved by one body. The servos of a tandem share a hinge and its torque.

    A demand that is no angle becomes one: a speed leads it, a duty or a current is what the position law asks of it.
    """

    longest = STEP

    def __init__(self, robot: Robot, wires: Sequence[Cable], *, factors: Factors = NOMINAL) -> None:
        """At rest.

        Args:
            robot: whose servos they are.
            wires: all of them, in the order of demands and shafts.
            factors: how far the twin is from its description.
        """
        wiring = ServoMap.of(robot)
        hinges = {(servos.bus, servo): k for k, servos in enumerate(wiring.servos) for servo in servos.ids}
        self._hinges = np.array([hinges[wire.name, fitting.servo] for wire in wires for fitting in wire.fittings])
        self._zeros = wiring.scale.zeros[self._hinges] * TICK  # (m,) [rad] of the shaft where the hinge is at 0
        self._turns = wiring.scale.turns[self._hinges]  # (m,) signed
        self._counts = np.bincount(self._hinges, minlength=len(wiring.servos))
        self._drives = robot.drives
        self._body = Shafts(robot, factors=factors)
        self._led: dict[int, float] = {}  # [rad] where a speed has led the hinge of a servo

    @property
    def body(self) -> Shafts:
        """The simulated shafts of the robot's hinges."""
        return self._body

    def shafts(self) -> Sequence[Shaft]:
        """The present states of the servos' shafts, one for each servo."""
        body, hinges = self._body, self._hinges
        angles = self._zeros + self._turns * body.angles[hinges]
        ways = np.sign(self._turns)
        rows = (angles, self._turns * body.speeds[hinges], ways * body.duties[hinges], ways * body.loads[hinges])
        return [Shaft(*values) for values in np.stack(rows, axis=1).tolist()]

    def advance(self, seconds: float, demands: Sequence[Demand]) -> None:
        """Moves time on under constant demands."""
        if seconds < AT_ONCE:
            return
        body = self._body
        angles, speeds = body.angles, body.speeds
        goals, shares = np.zeros(len(self._counts)), np.zeros(len(self._counts))
        for k, demand in enumerate(demands):
            hinge = self._hinges[k]
            share = 0.0 if demand.kind == "limp" else demand.cap / self._counts[hinge]
            goal = self._goal(k, demand, float(angles[hinge]), float(speeds[hinge]), seconds)
            goals[hinge] += share * goal
            shares[hinge] += share
        driven = shares > 0.0
        goals[driven] /= shares[driven]
        body.advance(seconds, np.where(driven, goals, angles), shares)

    def _goal(self, k: int, demand: Demand, angle: float, speed: float, seconds: float) -> float:
        """[rad] of the hinge."""
        turns, drive = float(self._turns[k]), self._drives[int(self._hinges[k])]
        if demand.kind == "speed":
            ahead = self._led.get(k, angle) + demand.value / turns * seconds - angle
            self._led[k] = angle + _clipped(ahead, 1.0 / drive.gain)
            return self._led[k]
        self._led.pop(k, None)
        if demand.kind == "limp":
            return angle
        if demand.kind == "angle":
            return (demand.value - float(self._zeros[k])) / turns
        way = copysign(1.0, turns)
        duty = demand.value + (way * speed / drive.no_load if demand.kind == "current" else 0.0)
        return angle + way * _clipped(duty, demand.cap) / drive.gain


def _clipped(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
