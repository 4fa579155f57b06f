"""Simulated manual turning of torque-free hinges for calibration."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import TICK_ANGLE
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.physics import Demand, Physics, Shaft
from kinesic.hardware.virtual.wiring import Cable

FIRST_TURN = np.radians(15.0)  # [rad] first rotation of a hinge, in its positive direction
# [s] Times of a hinge at zero, first rotation, upper limit, end of hold, lower limit, end of hold and zero
KEY_TIMES = (0.0, 0.5, 2.0, 2.3, 4.8, 5.1, 6.6)


class HandTurnedPhysics:
    """Simulated servos that a person turns by hand while torque is off.

    Turning needs a few seconds. Servos with torque are left alone.
    """

    def __init__(self, physics: Physics, robot: Robot, wires: Sequence[Cable]) -> None:
        """Wrap the physics of servos without turning any hinge yet.

        Args:
            physics: physics of the servos.
            robot: robot with the servos.
            wires: all of its wires, in the order of the shafts.
        """
        wiring, skeleton = ServoMap.of(robot), robot.skeleton
        hinges = {(servos.bus, servo): k for k, servos in enumerate(wiring.servos) for servo in servos.ids}
        rows = [hinges[wire.name, fitting.servo] for wire in wires for fitting in wire.fittings]
        zero = np.zeros_like(skeleton.upper)
        first = np.minimum(FIRST_TURN, skeleton.upper)
        upper, lower = skeleton.upper, skeleton.lower
        keys = np.stack([zero, first, upper, upper, lower, lower, zero])[:, rows]
        zeros = wiring.scale.zeros[rows] * TICK_ANGLE
        self._keys: Floats = sealed(zeros + wiring.scale.turns[rows] * keys)  # (7, m) [rad] shaft angles
        self._physics, self.max_step = physics, physics.max_step
        self._elapsed = KEY_TIMES[-1]  # [s] since the person began

    @property
    def is_turning(self) -> bool:
        """Whether the person turns the hinges now."""
        return self._elapsed < KEY_TIMES[-1]

    def turn(self) -> None:
        """Turn every hinge in its positive direction, then through its range."""
        self._elapsed = 0.0

    def shafts(self) -> Sequence[Shaft]:
        """Return the current state of each servo's shaft."""
        return self._physics.shafts()

    def advance(self, seconds: float, demands: Sequence[Demand]) -> None:
        """Advance the physics, with hands that turn servos without torque."""
        if self.is_turning:
            self._elapsed += seconds
            goals = [float(np.interp(self._elapsed, KEY_TIMES, keys)) for keys in self._keys.T]
            demands = [
                Demand("angle", goal) if demand.kind == "limp" else demand
                for goal, demand in zip(goals, demands, strict=True)
            ]
        self._physics.advance(seconds, demands)
