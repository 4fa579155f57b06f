"""Physics of the robot's hinges for virtual servos.

Each hinge follows a setpoint with limited torque, or has its torque off.
"""

import mujoco
import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.robot import Robot
from kinesic.sim.model import (
    build_model,
    find_actuator_indices,
    find_joint_indices,
    find_play_indices,
    sum_hinge_values,
)
from kinesic.sim.power import SaggingSupply
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.twin import MAX_PHYSICS_STEP

ACTUATOR_GROUPS = 31  # number of actuator groups that MuJoCo can disable


class Shafts:
    """Physics of a simulated robot whose servos have individual torque limits."""

    def __init__(self, robot: Robot, *, factors: Factors = NOMINAL_FACTORS, start: Floats | None = None) -> None:
        """Build the physics at rest, with torque off.

        Args:
            robot: Description.
            factors: Deviations of servos and masses from the description.
            start: (n,) [rad] first posture; the robot's rest posture if not given.

        Raises:
            ValueError: the robot has more hinges than MuJoCo can switch off individually.
        """
        if len(robot.skeleton.hinges) > ACTUATOR_GROUPS:
            raise ValueError(f"{robot.name} has {len(robot.skeleton.hinges)} hinges, must be at most {ACTUATOR_GROUPS}")
        self._drives = factors.applied(robot).drives
        self._model = build_model(robot, servos=factors)
        self._data = mujoco.MjData(self._model)
        self._joints: Indices = find_joint_indices(robot, self._model)
        self._play = find_play_indices(robot, self._model)
        self._supply = SaggingSupply.of(self._drives, factors)
        self._actuators: Indices = find_actuator_indices(robot, self._model)
        self._model.actuator_group[self._actuators] = np.arange(len(self._actuators))
        self._goals = np.array(robot.skeleton.rest if start is None else start)
        self._ratios = np.zeros(len(self._goals))
        self._data.qpos[self._joints] = self._goals

    @property
    def angles(self) -> Floats:
        """Current angles of the hinges, (n,) [rad]."""
        # MuJoCo's semi-implicit angles are half a step ahead of constant setpoints, its velocities are not
        now = self._data.qpos - self._model.opt.timestep / 2 * self._data.qvel
        return sealed(sum_hinge_values(now, self._joints, self._play))

    @property
    def velocities(self) -> Floats:
        """Current velocities of the hinges, (n,) [rad/s]."""
        return sealed(sum_hinge_values(self._data.qvel, self._joints, self._play))

    @property
    def duties(self) -> Floats:
        """Proportional duty cycles of the servos' position loops, (n,) -1..1."""
        return sealed(np.clip(self._drives.gain * (self._goals - self.angles), -self._ratios, self._ratios))

    @property
    def loads(self) -> Floats:
        """Torque / stall torque of each servo, (n,)."""
        return sealed(self._data.actuator_force[self._actuators] / self._drives.stall)

    def advance(self, seconds: float, goals: Floats, ratios: Floats) -> None:
        """Advance the physics in steps no longer than the twin's time step.

        Args:
            seconds: [s] duration.
            goals: (n,) [rad] setpoints of the servos.
            ratios: (n,) 0..1 fraction of the stall torque that each servo may use; 0: torque off.
        """
        if seconds <= 0.0:
            return
        self._goals, self._ratios = np.array(goals), np.array(ratios)
        is_off: Flags = self._ratios <= 0.0
        self._data.ctrl[self._actuators] = self._goals
        self._model.opt.disableactuator = int(np.sum(1 << np.flatnonzero(is_off)))
        self._model.actuator_forcelimited[self._actuators] = self._ratios < 1.0
        limits = (self._drives.stall * self._ratios)[:, None] * [-1.0, 1.0]
        self._model.actuator_forcerange[self._actuators] = limits
        count = int(np.ceil(seconds / MAX_PHYSICS_STEP - 1e-9))
        self._model.opt.timestep = seconds / count
        if not self._supply and not len(self._play):
            mujoco.mj_step(self._model, self._data, count)
            return
        for _ in range(count):
            self._data.ctrl[self._actuators] = self._find_motor_setpoints(self._supply)
            mujoco.mj_step(self._model, self._data)

    def _find_motor_setpoints(self, supply: SaggingSupply | None) -> Floats:
        """Return motor setpoints (n,) [rad] corrected for supply sag and backlash.

        With backlash the position of a motor differs from that of its hinge, which the servo measures.
        """
        data, goals = self._data, self._goals
        if supply:
            angles, velocities = (
                sum_hinge_values(values, self._joints, self._play) for values in (data.qpos, data.qvel)
            )
            goals, _ = supply.equivalent_setpoints(goals, angles, velocities, self._ratios)
        return goals - data.qpos[self._play] if len(self._play) else goals
