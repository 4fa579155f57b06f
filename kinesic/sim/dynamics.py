"""What torque a motion needs, and what each hinge bears at worst."""

from functools import cached_property

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Load
from kinesic.body.robot import Robot
from kinesic.sim.kinematics import KERNEL
from kinesic.sim.model import build_model, joint_order
from kinesic.sim.stepping.addresses import function_address
from kinesic.sim.worst_postures import Extremes, extremes

if KERNEL == "compiled":
    from kinesic.sim import _kernel

STAGES = ("mj_kinematics", "mj_comPos", "mj_comVel", "mj_rne")  # of MuJoCo's inverse dynamics, without constraints
FRICTION_SPEED = 0.05  # [rad/s] within which Coulomb friction fades, so that a plan's torque has no jumps


class MujocoDynamics:
    """Implements `body.dynamics.Dynamics` with MuJoCo's inverse dynamics."""

    def __init__(self, robot: Robot) -> None:
        """Builds the robot's model, free of contacts and stops.

        Args:
            robot: whose masses and drives.
        """
        self._robot = robot
        self._model = build_model(robot)
        # contacts and stops would hold the robot; friction is added smoothly below
        self._model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        self._data = mujoco.MjData(self._model)
        self._order = joint_order(robot, self._model)
        self._hinges = np.argsort(self._order)  # MuJoCo's order, as positions of the skeleton's hinges

    def torques(self, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        """Computes the torque that each motion needs: gravity, inertia, armature, damping and friction.

        Args:
            angles: (m, n) [rad].
            speeds: (m, n) [rad/s].
            accelerations: (m, n) [rad/s^2].

        Returns:
            (m, n) [Nm].
        """
        rigid = np.empty(angles.shape)  # of the links, by the recursive Newton-Euler method
        ordered = [np.ascontiguousarray(values[:, self._hinges]) for values in (angles, speeds, accelerations)]
        self._newton_euler(ordered[0], ordered[1], ordered[2], rigid)
        drives = self._robot.drives
        torques: Floats = rigid[:, self._order] + drives.armature * accelerations + drives.damping * speeds
        torques += drives.frictionloss * np.tanh(speeds / FRICTION_SPEED)
        return torques

    def _newton_euler(self, angles: Floats, speeds: Floats, accelerations: Floats, rigid: Floats) -> None:
        """Writes the torques (m, n) of the links for motions (m, n), all of them in MuJoCo's order."""
        model, data = self._model, self._data
        qpos, qvel, qacc = data.qpos, data.qvel, data.qacc
        stages = [function_address(name) for name in STAGES]
        *before, last = [stage for stage in stages if stage is not None] or [0]
        if KERNEL == "compiled" and len(before) == len(STAGES) - 1:
            places = int(model._address), int(data._address)
            _kernel.inverse(before, last, *places, True, qpos, qvel, qacc, angles, speeds, accelerations, rigid)
            return
        for row, angle, speed, acceleration in zip(rigid, angles, speeds, accelerations, strict=True):
            qpos[:], qvel[:], qacc[:] = angle, speed, acceleration
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 1, row)

    def holding(self, angles: Floats) -> Floats:
        """Computes the torque (m, n) [Nm] that holds postures (m, n) [rad] against gravity; friction does not help."""
        model, data, qpos = self._model, self._data, self._data.qpos
        data.qvel[:] = 0.0
        mujoco.mj_comVel(model, data)  # nothing moves in any posture
        rigid = np.empty(angles.shape)
        for row, angle in zip(rigid, angles[:, self._hinges], strict=True):
            qpos[:] = angle
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_rne(model, data, 0, row)
        torques: Floats = rigid[:, self._order]
        return torques

    def static_ratios(self, angles: Floats) -> Floats:
        """Computes the share (m, n) of the stall torque that holds each hinge in postures (m, n) [rad]."""
        ratios: Floats = np.abs(self.holding(angles)) / self._robot.drives.stall
        return ratios

    def inertias(self, angles: Floats) -> Floats:
        """Computes the diagonal (m, n) [kg m^2] of the joint-space inertia, armature included, for (m, n) [rad]."""
        model, data, qpos = self._model, self._data, self._data.qpos
        matrix, diagonal = data.M, model.M_rowadr + model.M_rownnz - 1  # each row of its lower half ends there
        inertias = np.empty(angles.shape)
        for row, angle in zip(inertias, angles[:, self._hinges], strict=True):
            qpos[:] = angle
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_makeM(model, data)
            row[:] = matrix[diagonal]
        return inertias[:, self._order]

    @cached_property
    def worst_static(self) -> Extremes:
        """The largest share of its stall torque that each hinge needs to hold any posture, and that posture."""
        return extremes(self._robot.skeleton, self.static_ratios)

    @cached_property
    def load(self) -> Load:
        """What each hinge bears at worst: gravity and inertia, each the largest found in any posture."""
        return Load(
            holding=sealed(self._of_both_sides(self.worst_static.values * self._robot.drives.stall)),
            inertia=sealed(self._of_both_sides(extremes(self._robot.skeleton, self.inertias).values)),
        )

    def _of_both_sides(self, worst: Floats) -> Floats:
        """The larger of each hinge and its mirror image, (n,)."""
        names = self._robot.skeleton.names
        swapped = {f"l_{name[2:]}": f"r_{name[2:]}" for name in names if name.startswith("l_")}
        swapped |= {image: name for name, image in swapped.items()}
        partners = [names.index(image) if (image := swapped.get(n, n)) in names else k for k, n in enumerate(names)]
        return np.maximum(worst, worst[partners])
