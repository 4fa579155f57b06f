"""Judgement of motions without kinesic's motion and distance code.

Between two knots, a motion is a cubic polynomial of time. Its extreme positions and velocities lie at the ends of the
interval or at roots of the derivative, so that the limits are judged at every instant and not only at samples.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.planning.setup import Setup
from kinesic.sim.model import build_model, find_joint_indices

BASIS = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6.0  # powers of u x control points
MAX_RATIO = 1.001  # largest accepted ratio of value / limit
CONTACT_KNOTS = 2  # number of knots between two postures checked for contact: 50 postures per second
QUANTITIES = ("position", "velocity", "acceleration", "jerk")
CONTACT = "contact"  # name of the largest ratio of force or energy to the limit near an audience


@dataclass(frozen=True)
class Judgement:
    """Largest ratios of values to limits, and the deepest penetration."""

    ratios: dict[str, float]  # largest ratio by quantity; an angle beyond its range by x rad counts as 1 + x
    penetration: float  # [m] depth of the deepest self-contact; 0 without one

    @property
    def violated(self) -> list[str]:
        """Quantities beyond their limits."""
        return [name for name, ratio in self.ratios.items() if not ratio <= MAX_RATIO]


def judge(controls: Floats, setup: Setup) -> Judgement:
    """Judge a motion by its control points (k + 3, n) [rad].

    The motion is a uniform cubic B-spline. Contacts with people are judged at the knots, with kinesic's own model of
    contacts.
    """
    ratios = dict(zip(QUANTITIES, limit_ratios(controls, setup.limits), strict=True))
    angles = knot_angles(controls)
    if setup.policy is not None and setup.impacts is not None:
        velocities = (controls[2:] - controls[:-2]) / (2 * KNOT_INTERVAL)
        ratios[CONTACT] = float(setup.impacts.survey(angles, velocities, setup.policy.rows).values.max())
    return Judgement(ratios, deepest_penetration(angles[::CONTACT_KNOTS], setup.robot))


def limit_ratios(controls: Floats, limits: Limits) -> tuple[float, float, float, float]:
    """Return the largest ratios of the motion to its limits.

    The ratios are of position, velocity, acceleration and jerk, over all instants.
    """
    windows = np.lib.stride_tricks.sliding_window_view(controls, 4, axis=0)  # (k, n, 4)
    a, b, c, d = np.moveaxis(windows @ BASIS.T, -1, 0)  # angle = a + b u + c u^2 + d u^3 for u in [0, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        discriminant = np.sqrt(np.maximum(c**2 - 3 * b * d, 0.0))
        roots = [(-c + discriminant) / (3 * d), (-c - discriminant) / (3 * d), -b / (2 * c)]
        vertex = -c / (3 * d)
    turning = [np.clip(np.nan_to_num(root), 0.0, 1.0) for root in (0.0 * a, 0.0 * a + 1.0, *roots)]
    angles = np.array([a + u * (b + u * (c + u * d)) for u in turning])
    beyond = np.maximum(angles - limits.upper, limits.lower - angles).max()
    fastest = [np.clip(np.nan_to_num(u), 0.0, 1.0) for u in (0.0 * a, 0.0 * a + 1.0, vertex)]
    speed = max(np.max(np.abs(b + u * (2 * c + 3 * d * u)) / limits.speed) for u in fastest) / KNOT_INTERVAL
    bend = np.maximum(np.abs(2 * c), np.abs(2 * c + 6 * d)) / limits.acceleration
    jerk = np.abs(6 * d) / limits.jerk
    return 1.0 + float(beyond), float(speed), float(bend.max()) / KNOT_INTERVAL**2, float(jerk.max()) / KNOT_INTERVAL**3


def knot_angles(controls: Floats) -> Floats:
    """Return the angles (k + 1, n) [rad] at the knots."""
    return np.asarray((controls[:-2] + 4 * controls[1:-1] + controls[2:]) / 6.0)


def deepest_penetration(postures: Floats, robot: Robot) -> float:
    """Return the depth [m] of the deepest self-contact found by MuJoCo.

    The postures (m, n) are in rad.
    """
    model = build_model(robot)
    data, columns, depth = mujoco.MjData(model), find_joint_indices(robot, model), 0.0
    for posture in postures:
        data.qpos[columns] = posture
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        if data.ncon:
            depth = max(depth, -float(data.contact.dist[: data.ncon].min()))
    return depth
