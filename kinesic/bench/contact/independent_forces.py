"""Largest contact force or energy relative to its limit, from MuJoCo.

MuJoCo computes the Jacobians and the mass matrix.

The bound by the total kinetic energy excludes most instants. Only the policy and the points are shared with planning.
"""

import mujoco
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.impact_policy import ImpactRows
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import Trajectory
from kinesic.sim.model import build_model, find_joint_indices
from kinesic.sim.uncoupled import uncouple

SAMPLE_RATE = 100.0  # [Hz] sampling rate of the motion
POINTS_PER_CAPSULE = 4  # number of points along the axis of each capsule


class MujocoContacts:
    """Contacts of a robot with people, computed by MuJoCo alone."""

    def __init__(self, robot: Robot) -> None:
        """Build the model and collect points on the capsules of moving segments.

        Args:
            robot: robot whose capsules may touch people.
        """
        self._model = model = build_model(robot)
        self._data = mujoco.MjData(model)
        self._order = find_joint_indices(robot, model)
        self._points: list[tuple[int, Floats]] = []
        for segment in uncouple(robot).skeleton.segments:
            body = model.body(segment.name).id
            for capsule in segment.capsules if model.body_weldid[body] else ():
                self._points += [
                    (body, capsule.start + weight * (capsule.end - capsule.start))
                    for weight in np.linspace(0.0, 1.0, POINTS_PER_CAPSULE)
                ]
        self._jacobians = np.zeros((len(self._points), 3, model.nv))
        self._inertia = np.zeros((model.nv, model.nv))

    def largest_ratio(self, trajectory: Trajectory, rows: ImpactRows) -> float:
        """Return the largest ratio of a force or energy to its limit.

        An energy counts by the square root of its ratio.
        """
        times = np.arange(trajectory.start, trajectory.end, 1.0 / SAMPLE_RATE)
        angles, velocities, _ = trajectory.sample(times)
        return max((self._ratio(*state, rows) for state in zip(angles, velocities, strict=True)), default=0.0)

    def _ratio(self, angles: Floats, velocities: Floats, rows: ImpactRows) -> float:
        model, data = self._model, self._data
        data.qpos[self._order], data.qvel[self._order] = angles, velocities
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_makeM(model, data)
        mujoco.mj_fullM(model, data, self._inertia)
        bound = float(rows.scales.max() * np.sqrt(data.qvel @ self._inertia @ data.qvel))
        if bound <= 1.0:
            return bound
        for jacobian, (body, place) in zip(self._jacobians, self._points, strict=True):
            point = data.xpos[body] + data.xmat[body].reshape(3, 3) @ place
            mujoco.mj_jac(model, data, jacobian, None, point, body)
        solved = np.linalg.solve(self._inertia, self._jacobians.reshape(-1, model.nv).T)
        mobilities = self._jacobians @ solved.T.reshape(len(self._points), 3, model.nv).transpose(0, 2, 1)
        moved = self._jacobians @ data.qvel
        ratios = []
        for mass, scale in zip(rows.masses, rows.scales, strict=True):
            pressed = np.linalg.solve(mobilities + np.eye(3) / mass, moved[..., None])[..., 0]
            ratios.append(scale * np.sqrt(np.einsum("kd,kd->k", moved, pressed).max()))
        return float(max(ratios))
