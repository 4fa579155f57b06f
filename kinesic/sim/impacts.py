"""Contacts of a moving robot with a person.

The largest contact force and energy are computed at points on the robot's capsules. A contact presses a linear spring
of the person's stiffness k, with the person's mass m behind it. The worst contact normal at a point with velocity v has
the closed form F = sqrt(k v' (W + I / m)^-1 v). W = J M^-1 J' is the mobility of the point, with rotors in the inertia
M. Drives and gravity add little within the milliseconds of a contact.
"""

import numpy as np

from kinesic._kernel import sim as kernel
from kinesic.body.arrays import Floats, Indices, seal_in_place
from kinesic.body.dynamics import ImpactSurvey
from kinesic.body.impact_policy import ImpactRows
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Capsule
from kinesic.sim.model import build_model
from kinesic.sim.uncoupled import uncouple

POINTS_PER_CAPSULE = 4  # points along a capsule's axis; its ends alone miss up to 7 % of the force
MIN_ROTOR_INERTIA = 1e-9  # [kg m^2] rotor inertia of drives without data


class RobotImpacts:
    """Contacts of a robot with people.

    Implements `body.dynamics.Impacts`.
    """

    def __init__(self, robot: Robot) -> None:
        """Collect links, rotors and points of a robot.

        Args:
            robot: Description with masses and drives.
        """
        self._robot = robot
        self._tree, self._owners = _compile(robot)

    @property
    def owners(self) -> tuple[str, ...]:
        """Segment of each point."""
        return self._owners

    def survey(self, angles: Floats, velocities: Floats, rows: ImpactRows, *, gate: float = 0.0) -> ImpactSurvey:
        """Find the largest contact force and energy over the robot's points.

        Args:
            angles: (m, n) [rad].
            velocities: (m, n) [rad/s].
            rows: quantities to compute.
            gate: value below which an upper bound suffices.
        """
        shape = (len(angles), len(rows.names))
        values, points = np.empty(shape), np.empty(shape, dtype=np.int64)
        self._tree.survey(
            np.ascontiguousarray(angles),
            np.ascontiguousarray(velocities),
            1.0 / rows.masses,
            rows.scales**2,
            gate,
            values,
            points,
        )
        return ImpactSurvey(rows, seal_in_place(values), points)

    def jacobians(self, angles: Floats, points: Indices) -> Floats:
        """Compute the Jacobian (m, 3, n) of one point in each posture.

        Args:
            angles: (m, n) [rad].
            points: (m,) indices of points.
        """
        columns = np.empty((len(angles), 3, angles.shape[1]))
        self._tree.jacobians(np.ascontiguousarray(angles), np.ascontiguousarray(points, dtype=np.int64), columns)
        return columns


def _compile(robot: Robot) -> tuple[kernel.ImpactTree, tuple[str, ...]]:
    """Pack the robot's physics for the kernel.

    Returns the packed robot and the segment of each point.
    """
    body, model = uncouple(robot), build_model(robot)
    tree, owners, armatures = kernel.ImpactTree(), list[str](), robot.drives.armature
    is_moving = set[str]()
    for segment, (parent, origin, turns) in zip(body.skeleton.segments, body.skeleton.steps, strict=True):
        link = model.body(segment.name)
        joints = [joint for joint, _ in turns]
        if joints or segment.parent in is_moving:
            is_moving.add(segment.name)
        capsules = segment.capsules if segment.name in is_moving else ()
        points = np.array([point for capsule in capsules for point in _spread(capsule)]).reshape(-1, 3)
        owners += [segment.name] * len(points)
        rotation = _rotation_matrix(link.iquat)
        inertia = rotation @ np.diag(link.inertia) @ rotation.T
        tree.add_link(
            parent,
            np.ascontiguousarray(origin),
            np.array([link.mass[0], *link.ipos, *inertia[np.tril_indices(3)]]),
            joints,
            np.ascontiguousarray(body.skeleton.axes[joints]),
            np.array([np.zeros(3) if at is None else at for _, at in turns]).reshape(-1, 3),
            np.maximum(armatures[joints], MIN_ROTOR_INERTIA),
            points,
        )
    return tree, tuple(owners)


def _spread(capsule: Capsule) -> Floats:
    """Return points (p, 3) [m] along the axis of a capsule.

    A ball has a single point.
    """
    if np.array_equal(capsule.start, capsule.end):
        return capsule.start[None]
    weights = np.linspace(0.0, 1.0, POINTS_PER_CAPSULE)[:, None]
    return np.asarray((1.0 - weights) * capsule.start + weights * capsule.end)


def _rotation_matrix(quaternion: Floats) -> Floats:
    """Return the rotation matrix of a unit quaternion (w, x, y, z)."""
    w, x, y, z = quaternion.tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
