"""Checks of certified motions without kinesic's motion and distance code."""

import mujoco
import numpy as np
from scipy.interpolate import BSpline

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.sim.model import build_model, find_joint_indices

LIMIT_RATE = 10_000.0  # [Hz] rate at which limits are checked
CONTACT_RATE = 100.0  # [Hz] rate at which contacts are checked
SPLINE_DEGREE = 3  # degree of a trajectory's B-splines


def find_largest_ratio(trajectory: Trajectory, limits: Limits) -> float:
    """Return a trajectory's largest ratio of value to limit, by SciPy's B-splines.

    Considers positions, velocities, accelerations, jerks and duties of all joints at `LIMIT_RATE`. An angle beyond its
    range by x rad counts as 1 + x.
    """
    controls = np.asarray(trajectory.controls)
    count = len(controls) - SPLINE_DEGREE
    spline = BSpline(KNOT_INTERVAL * np.arange(-SPLINE_DEGREE, count + SPLINE_DEGREE + 1), controls, SPLINE_DEGREE)
    times = np.arange(0.0, count * KNOT_INTERVAL, 1.0 / LIMIT_RATE)
    angles = spline(times)
    velocities, accelerations, jerks = (spline.derivative(order)(times) for order in (1, 2, 3))
    ratios = (
        1.0 + np.maximum(angles - limits.upper, limits.lower - angles),
        np.abs(velocities) / limits.speed,
        np.abs(accelerations) / limits.acceleration,
        np.abs(jerks) / limits.jerk,
        np.abs(limits.inertial * accelerations + limits.viscous * velocities) / limits.duty,
    )
    return max(float(values.max()) for values in ratios)


def has_penetration(trajectory: Trajectory, robot: Robot) -> bool:
    """Return whether a robot touches itself during a motion, according to MuJoCo."""
    times = trajectory.start + np.arange(0.0, trajectory.duration, 1.0 / CONTACT_RATE)
    return touches_itself(trajectory.angles(times), robot)


def touches_itself(angles: Floats, robot: Robot) -> bool:
    """Return whether a robot touches itself in any posture (m, n) [rad].

    Fingers and pairs that the robot's file excludes do not count.
    """
    model = build_model(robot)
    data, columns = mujoco.MjData(model), find_joint_indices(robot, model)
    for posture in angles:
        data.qpos[columns] = posture
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        if bool((data.contact.dist[: data.ncon] < 0.0).any()):
            return True
    return False
