"""Joint torques required by a motion, and worst-case loads of each hinge."""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import mujoco
import numpy as np

from kinesic._kernel import sim as kernel
from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Load
from kinesic.body.robot import Robot
from kinesic.sim.model import build_model, find_joint_indices
from kinesic.sim.stepping.addresses import function_address
from kinesic.sim.worst_postures import Extremes, extremes

INVERSE_DYNAMICS_STAGES = ("mj_kinematics", "mj_comPos", "mj_comVel", "mj_rne")  # unconstrained MuJoCo stages
INERTIA_STAGES = ("mj_kinematics", "mj_comPos", "mj_makeM")  # MuJoCo stages that compute the joint-space inertia
LOAD_CACHE_SIZE = 8  # largest number of robots whose worst-case loads are kept
COULOMB_FADE_VELOCITY = 0.05  # [rad/s] scale of the tanh that keeps Coulomb friction continuous


class MujocoDynamics:
    """Inverse dynamics of a robot computed with MuJoCo.

    Implements `body.dynamics.Dynamics`.
    """

    def __init__(self, robot: Robot) -> None:
        """Build the MuJoCo model of the robot without contacts and joint stops.

        Args:
            robot: Description with masses and drives.
        """
        self._robot = robot
        self._model = build_model(robot)
        # Contacts and stops would support the robot. `torques` adds continuous friction.
        self._model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        self._data = mujoco.MjData(self._model)
        self._order = find_joint_indices(robot, self._model)
        self._hinges = np.argsort(self._order)  # hinge index of each MuJoCo joint

    def torques(self, angles: Floats, velocities: Floats, accelerations: Floats) -> Floats:
        """Compute the joint torques required by each motion state.

        They include gravity, inertia, armature, damping and friction.

        Args:
            angles: (m, n) [rad].
            velocities: (m, n) [rad/s].
            accelerations: (m, n) [rad/s^2].

        Returns:
            (m, n) [Nm].
        """
        rigid = self._compute_link_torques(angles, velocities, accelerations)
        drives = self._robot.drives
        torques: Floats = rigid + drives.armature * accelerations + drives.damping * velocities
        torques += drives.frictionloss * np.tanh(velocities / COULOMB_FADE_VELOCITY)
        return torques

    def holding(self, angles: Floats) -> Floats:
        """Compute the torques [Nm] that hold postures (m, n) [rad] against gravity.

        Friction does not help to hold.
        """
        zeros = np.zeros_like(angles)
        return self._compute_link_torques(angles, zeros, zeros)

    def _compute_link_torques(self, angles: Floats, velocities: Floats, accelerations: Floats) -> Floats:
        """Compute joint torques [Nm] of the links alone by recursive Newton-Euler.

        Friction, damping and armature are not included. The result is (m, n).
        """
        model, data = self._model, self._data
        live = data.qpos, data.qvel, data.qacc
        motions = [np.ascontiguousarray(values[:, self._hinges]) for values in (angles, velocities, accelerations)]
        rigid = np.empty(angles.shape)
        *before, last = [address or 0 for address in map(function_address, INVERSE_DYNAMICS_STAGES)]
        if all((*before, last)):
            addresses = int(model._address), int(data._address)
            kernel.inverse(before, last, *addresses, True, *live, motions[0], motions[1], motions[2], rigid)
            return rigid[:, self._order]
        data = mujoco.MjData(model)  # a separate instance, as other threads may call at the same time
        for row, angle, velocity, acceleration in zip(rigid, *motions, strict=True):
            data.qpos[:], data.qvel[:], data.qacc[:] = angle, velocity, acceleration
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 1, row)
        return rigid[:, self._order]

    def static_ratios(self, angles: Floats) -> Floats:
        """Compute holding torque / stall torque in postures (m, n) [rad]."""
        ratios: Floats = np.abs(self.holding(angles)) / self._robot.drives.stall
        return ratios

    def inertias(self, angles: Floats) -> Floats:
        """Compute the diagonal of the joint-space inertia matrix in each posture.

        Armature is included.

        Args:
            angles: (m, n) [rad].

        Returns:
            (m, n) [kg m^2].
        """
        model, data = self._model, self._data
        ordered, inertias = np.ascontiguousarray(angles[:, self._hinges]), np.empty(angles.shape)
        diagonal = model.M_rowadr + model.M_rownnz - 1  # index of the last entry of each row of the lower triangle
        stages = [address or 0 for address in map(function_address, INERTIA_STAGES)]
        if all(stages):
            addresses = int(model._address), int(data._address)
            kernel.keep_left(stages, *addresses, data.qpos, data.M, diagonal.astype(np.int64), ordered, inertias)
            return inertias[:, self._order]
        data = mujoco.MjData(model)  # a separate instance, as above
        for row, angle in zip(inertias, ordered, strict=True):
            data.qpos[:] = angle
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_makeM(model, data)
            row[:] = data.M[diagonal]
        return inertias[:, self._order]

    @property
    def worst_static(self) -> Extremes:
        """Largest holding torque / stall torque of each hinge.

        With the posture that needs it.
        """
        return _find_worst_static(self._source)

    @property
    def load(self) -> Load:
        """Worst-case holding torque [Nm] and inertia [kg m^2] of each hinge.

        Each is the largest value over all postures, and of both hinges of a left-right pair.
        """
        return _compute_load(self._source)

    @cached_property
    def _source(self) -> "_LoadSource":
        """Dynamics with the data that determine their worst-case loads."""
        model = np.empty(mujoco.mj_sizeModel(self._model), dtype=np.uint8)
        mujoco.mj_saveModel(self._model, None, model)
        skeleton = self._robot.skeleton
        arrays = (model, skeleton.rest, skeleton.lower, skeleton.upper, self._robot.drives.stall)
        return _LoadSource(skeleton.names, tuple(values.tobytes() for values in arrays), self)

    def _combine_sides(self, worst: Floats) -> Floats:
        """Return worst-case values (n,), the larger of each left-right hinge pair."""
        names = self._robot.skeleton.names
        swapped = {f"l_{name[2:]}": f"r_{name[2:]}" for name in names if name.startswith("l_")}
        swapped |= {image: name for name, image in swapped.items()}
        partners = [names.index(image) if (image := swapped.get(n, n)) in names else k for k, n in enumerate(names)]
        return np.maximum(worst, worst[partners])


@dataclass(frozen=True)
class _LoadSource:
    """Data that determine the worst-case loads of a robot."""

    names: tuple[str, ...]  # names of the hinges
    data: tuple[bytes, ...]  # model of MuJoCo, rest posture, joint ranges and stall torques
    dynamics: MujocoDynamics = field(compare=False)


# Equal robots have the same worst-case loads, also if they were loaded from their file at different times.


@lru_cache(maxsize=LOAD_CACHE_SIZE)
def _find_worst_static(source: _LoadSource) -> Extremes:
    return extremes(source.dynamics._robot.skeleton, source.dynamics.static_ratios)


@lru_cache(maxsize=LOAD_CACHE_SIZE)
def _compute_load(source: _LoadSource) -> Load:
    dynamics, robot = source.dynamics, source.dynamics._robot
    return Load(
        holding=sealed(dynamics._combine_sides(_find_worst_static(source).values * robot.drives.stall)),
        inertia=sealed(dynamics._combine_sides(extremes(robot.skeleton, dynamics.inertias).values)),
    )
