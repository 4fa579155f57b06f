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
INERTIA_STAGES = ("mj_kinematics", "mj_comPos", "mj_makeM")  # of the joint-space inertia
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
        rigid = self._newton_euler(angles, speeds, accelerations)
        drives = self._robot.drives
        torques: Floats = rigid + drives.armature * accelerations + drives.damping * speeds
        torques += drives.frictionloss * np.tanh(speeds / FRICTION_SPEED)
        return torques

    def holding(self, angles: Floats) -> Floats:
        """Computes the torque (m, n) [Nm] that holds postures (m, n) [rad] against gravity; friction does not help."""
        still = np.zeros_like(angles)
        return self._newton_euler(angles, still, still)

    def _newton_euler(self, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        """Computes the torques (m, n) of the links alone by the recursive Newton-Euler method."""
        model, data = self._model, self._data
        moving = data.qpos, data.qvel, data.qacc
        motions = [np.ascontiguousarray(values[:, self._hinges]) for values in (angles, speeds, accelerations)]
        rigid = np.empty(angles.shape)
        *before, last = [address or 0 for address in map(function_address, STAGES)]
        if KERNEL == "compiled" and all((*before, last)):
            places = int(model._address), int(data._address)
            _kernel.inverse(before, last, *places, True, *moving, motions[0], motions[1], motions[2], rigid)
            return rigid[:, self._order]
        data = mujoco.MjData(model)  # of this call alone: other threads may ask meanwhile
        for row, angle, speed, acceleration in zip(rigid, *motions, strict=True):
            data.qpos[:], data.qvel[:], data.qacc[:] = angle, speed, acceleration
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 1, row)
        return rigid[:, self._order]

    def static_ratios(self, angles: Floats) -> Floats:
        """Computes the share (m, n) of the stall torque that holds each hinge in postures (m, n) [rad]."""
        ratios: Floats = np.abs(self.holding(angles)) / self._robot.drives.stall
        return ratios

    def inertias(self, angles: Floats) -> Floats:
        """Computes the diagonal (m, n) [kg m^2] of the joint-space inertia, armature included, for (m, n) [rad]."""
        model, data = self._model, self._data
        ordered, inertias = np.ascontiguousarray(angles[:, self._hinges]), np.empty(angles.shape)
        diagonal = model.M_rowadr + model.M_rownnz - 1  # each row of the matrix's lower half ends there
        stages = [address or 0 for address in map(function_address, INERTIA_STAGES)]
        if KERNEL == "compiled" and all(stages):
            places = int(model._address), int(data._address)
            _kernel.keep_left(stages, *places, data.qpos, data.M, diagonal.astype(np.int64), ordered, inertias)
            return inertias[:, self._order]
        data = mujoco.MjData(model)  # as above
        for row, angle in zip(inertias, ordered, strict=True):
            data.qpos[:] = angle
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_makeM(model, data)
            row[:] = data.M[diagonal]
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
