"""The robot's hinges as its servos turn them: each driven to an angle with a share of its torque, or limp."""

import mujoco
import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.robot import Robot
from kinesic.sim.model import actuator_order, build_model, joint_order, of_hinges, play_order
from kinesic.sim.power import Supply
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.twin import STEP

GROUPS = 31  # of actuators that MuJoCo can disable


class Shafts:
    """The same physics as the twin's, without its measurements, and with torque that comes and goes."""

    def __init__(self, robot: Robot, *, factors: Factors = NOMINAL, start: Floats | None = None) -> None:
        """Stands still, limp.

        Args:
            robot: what is simulated.
            factors: how far its servos and masses are from the description.
            start: (n,) [rad] first posture; the robot's rest posture if not given.

        Raises:
            ValueError: there are more hinges than torque can be taken from one by one.
        """
        if len(robot.skeleton.hinges) > GROUPS:
            raise ValueError(f"{robot.name} has {len(robot.skeleton.hinges)} hinges, must be at most {GROUPS}")
        self._drives = factors.applied(robot).drives
        self._model = build_model(robot, servos=factors)
        self._data = mujoco.MjData(self._model)
        self._joints: Indices = joint_order(robot, self._model)
        self._play = play_order(robot, self._model)
        self._supply = Supply.of(self._drives, factors)
        self._actuators: Indices = actuator_order(robot, self._model)
        self._model.actuator_group[self._actuators] = np.arange(len(self._actuators))
        self._goals = np.array(robot.skeleton.rest if start is None else start)
        self._shares = np.zeros(len(self._goals))
        self._data.qpos[self._joints] = self._goals

    @property
    def angles(self) -> Floats:
        """(n,) [rad]."""
        # MuJoCo's semi-implicit steps run half a step ahead of the held goals; its speeds lie on time
        now = self._data.qpos - self._model.opt.timestep / 2 * self._data.qvel
        return sealed(of_hinges(now, self._joints, self._play))

    @property
    def speeds(self) -> Floats:
        """(n,) [rad/s]."""
        return sealed(of_hinges(self._data.qvel, self._joints, self._play))

    @property
    def duties(self) -> Floats:
        """(n,) -1..1 of the servos' law."""
        return sealed(np.clip(self._drives.gain * (self._goals - self.angles), -self._shares, self._shares))

    @property
    def loads(self) -> Floats:
        """(n,) torque over stall torque."""
        return sealed(self._data.actuator_force[self._actuators] / self._drives.stall)

    def advance(self, seconds: float, goals: Floats, shares: Floats) -> None:
        """Moves time on, in steps no longer than the twin's.

        Args:
            seconds: [s].
            goals: (n,) [rad] that the servos hold.
            shares: (n,) 0..1 of the stall torque that each may use; 0: limp.
        """
        if seconds <= 0.0:
            return
        self._goals, self._shares = np.array(goals), np.array(shares)
        limp: Flags = self._shares <= 0.0
        self._data.ctrl[self._actuators] = self._goals
        self._model.opt.disableactuator = int(np.sum(1 << np.flatnonzero(limp)))
        self._model.actuator_forcelimited[self._actuators] = self._shares < 1.0
        limits = (self._drives.stall * self._shares)[:, None] * [-1.0, 1.0]
        self._model.actuator_forcerange[self._actuators] = limits
        count = int(np.ceil(seconds / STEP - 1e-9))
        self._model.opt.timestep = seconds / count
        if not self._supply and not len(self._play):
            mujoco.mj_step(self._model, self._data, count)
            return
        for _ in range(count):
            self._data.ctrl[self._actuators] = self._asked(self._supply)
            mujoco.mj_step(self._model, self._data)

    def _asked(self, supply: Supply | None) -> Floats:
        """(n,) [rad] goals of motors, whose position is not the hinge's where gears have play; servos measure it."""
        data, goals = self._data, self._goals
        if supply:
            angles, speeds = (of_hinges(values, self._joints, self._play) for values in (data.qpos, data.qvel))
            goals, _ = supply.goals(goals, angles, speeds, self._shares)
        return goals - data.qpos[self._play] if len(self._play) else goals
