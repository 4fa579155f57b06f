"""Simulated robot body driven by virtual servos.

It tests real drivers: their bytes set the demands.
"""

from collections.abc import Sequence
from math import copysign

import numpy as np

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import TICK_ANGLE
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.physics import Demand, Shaft
from kinesic.hardware.virtual.wiring import Cable
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.servo_shafts import Shafts
from kinesic.sim.twin import MAX_PHYSICS_STEP

MIN_TIME_STEP = 1e-9  # [s] shortest simulated time step; shorter steps are skipped


class TwinPhysics:
    """Physics of all servo shafts of a robot in one simulation.

    The servos of a tandem share a hinge and its torque. Demands are converted to angles: a velocity is integrated, a
    duty or current becomes the angle at which the position controller gives it.
    """

    max_step = MAX_PHYSICS_STEP

    def __init__(self, robot: Robot, wires: Sequence[Cable], *, factors: Factors = NOMINAL_FACTORS) -> None:
        """Create the simulation with the robot at rest.

        Args:
            robot: with the servos.
            wires: all of them, in the order of demands and shafts.
            factors: deviation of the twin from its description.
        """
        wiring = ServoMap.of(robot)
        hinges = {(servos.bus, servo): k for k, servos in enumerate(wiring.servos) for servo in servos.ids}
        self._hinges = np.array([hinges[wire.name, fitting.servo] for wire in wires for fitting in wire.fittings])
        self._zeros = wiring.scale.zeros[self._hinges] * TICK_ANGLE  # (m,) [rad] shaft angle at the zero of the hinge
        self._turns = wiring.scale.turns[self._hinges]  # (m,) shaft turns per hinge turn, signed
        self._counts = np.bincount(self._hinges, minlength=len(wiring.servos))
        self._drives = robot.drives
        self._body = Shafts(robot, factors=factors)
        self._velocity_targets: dict[int, float] = {}  # [rad] hinge angle reached by integrating a velocity demand

    @property
    def body(self) -> Shafts:
        """Physics of all hinges, driven by the virtual servos."""
        return self._body

    def shafts(self) -> Sequence[Shaft]:
        """Return the current state of each servo's shaft."""
        body, hinges = self._body, self._hinges
        angles = self._zeros + self._turns * body.angles[hinges]
        signs = np.sign(self._turns)
        rows = (angles, self._turns * body.velocities[hinges], signs * body.duties[hinges], signs * body.loads[hinges])
        return [Shaft(*values) for values in np.stack(rows, axis=1).tolist()]

    def advance(self, seconds: float, demands: Sequence[Demand]) -> None:
        """Advance the simulation by a time [s] with constant servo demands."""
        if seconds < MIN_TIME_STEP:
            return
        body = self._body
        angles, speeds = body.angles, body.velocities
        goals, duty_caps = np.zeros(len(self._counts)), np.zeros(len(self._counts))
        for k, demand in enumerate(demands):
            hinge = self._hinges[k]
            cap = 0.0 if demand.kind == "limp" else demand.cap / self._counts[hinge]
            goal = self._compute_target(k, demand, float(angles[hinge]), float(speeds[hinge]), seconds)
            goals[hinge] += cap * goal
            duty_caps[hinge] += cap
        driven = duty_caps > 0.0
        goals[driven] /= duty_caps[driven]
        body.advance(seconds, np.where(driven, goals, angles), duty_caps)

    def _compute_target(self, k: int, demand: Demand, angle: float, speed: float, seconds: float) -> float:
        """Convert a servo's motor command to its hinge's target angle [rad]."""
        turns, drive = float(self._turns[k]), self._drives[int(self._hinges[k])]
        if demand.kind == "speed":
            ahead = self._velocity_targets.get(k, angle) + demand.value / turns * seconds - angle
            self._velocity_targets[k] = angle + _clip(ahead, 1.0 / drive.gain)
            return self._velocity_targets[k]
        self._velocity_targets.pop(k, None)
        if demand.kind == "limp":
            return angle
        if demand.kind == "angle":
            return (demand.value - float(self._zeros[k])) / turns
        sign = copysign(1.0, turns)
        duty = demand.value + (sign * speed / drive.no_load if demand.kind == "current" else 0.0)
        return angle + sign * _clip(duty, demand.cap) / drive.gain


def _clip(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
