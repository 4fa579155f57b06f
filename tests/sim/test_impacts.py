"""Contact forces against MuJoCo's Jacobians and mass matrix."""

import mujoco
import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.impact_policy import ImpactRows, force_rows, read_impact_limits
from kinesic.body.robot import Robot
from kinesic.sim.impacts import POINTS_PER_CAPSULE, RobotImpacts
from kinesic.sim.model import build_model, find_joint_indices
from kinesic.sim.uncoupled import uncouple

ROWS = force_rows(read_impact_limits().regions)
POSTURES = 6  # number of random postures, not a multiple of the kernel's batch size


def random_motion(robot: Robot) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(3)
    skeleton = robot.skeleton
    angles = rng.uniform(skeleton.lower, skeleton.upper, (POSTURES, len(skeleton.names)))
    return angles, rng.normal(size=angles.shape)


def points_of(robot: Robot, model: mujoco.MjModel) -> list[tuple[int, Floats]]:
    """Return body and position of each contact point that can move."""
    points = []
    for segment in uncouple(robot).skeleton.segments:
        body = model.body(segment.name).id
        for capsule in segment.capsules if model.body_weldid[body] else ():
            is_ball = np.array_equal(capsule.start, capsule.end)
            for weight in [0.0] if is_ball else np.linspace(0.0, 1.0, POINTS_PER_CAPSULE):
                points.append((body, (1.0 - weight) * capsule.start + weight * capsule.end))
    return points


def forces_by_mujoco(robot: Robot, angles: Floats, velocities: Floats, rows: ImpactRows) -> tuple[Floats, list[Floats]]:
    """Return the largest contact values (r,) in one posture.

    Returns the Jacobian of each point, too.
    """
    model = build_model(robot)
    data, order = mujoco.MjData(model), find_joint_indices(robot, model)
    data.qpos[order], data.qvel[order] = angles, velocities
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_makeM(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    values, jacobians = [], []
    for body, place in points_of(robot, model):
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, jacobian, None, data.xpos[body] + data.xmat[body].reshape(3, 3) @ place, body)
        mobility, velocity = jacobian @ np.linalg.solve(inertia, jacobian.T), jacobian @ data.qvel
        inverses = [np.linalg.inv(mobility + np.eye(3) / mass) for mass in rows.masses]
        values.append([np.sqrt(velocity @ inverse @ velocity) for inverse in inverses] * rows.scales)
        jacobians.append(jacobian[:, order])
    return np.max(values, axis=0), jacobians


@pytest.mark.parametrize("name", ["upper22", "upper36"])
def test_contact_forces_and_jacobians_equal_those_of_mujoco(name: str):
    robot = Robot.load(name)
    impacts = RobotImpacts(robot)
    angles, velocities = random_motion(robot)
    survey = impacts.survey(angles, velocities, ROWS)
    columns = impacts.jacobians(angles, survey.points[:, 0])
    for k in range(POSTURES):
        expected, jacobians = forces_by_mujoco(robot, angles[k], velocities[k], ROWS)
        np.testing.assert_allclose(survey.values[k], expected, rtol=1e-9)
        np.testing.assert_allclose(columns[k], jacobians[survey.points[k, 0]], atol=1e-12)
    assert len(impacts.owners) == len(jacobians)


def test_contact_forces_far_below_the_limit_are_replaced_by_upper_bounds():
    robot = Robot.load()
    impacts = RobotImpacts(robot)
    angles, velocities = random_motion(robot)
    velocities = velocities * np.repeat([1e-3, 1.0], [4, 2])[:, None]  # the kernel decides for groups of four
    exact = impacts.survey(angles, velocities, ROWS).values
    gated = impacts.survey(angles, velocities, ROWS, gate=1.0)
    assert (gated.points[:4] == -1).all()
    assert (gated.values[:4] <= 1.0).all()
    assert (gated.values[:4] >= exact[:4]).all()
    np.testing.assert_array_equal(gated.values[4:], np.maximum(exact[4:], 1.0))
    np.testing.assert_array_equal(gated.points[4:] == -1, exact[4:] <= 1.0)
    assert (exact[4:] <= 1.0).any()


def test_contact_forces_are_proportional_to_velocity():
    robot = Robot.load()
    angles, velocities = random_motion(robot)
    values = RobotImpacts(robot).survey(angles, velocities, ROWS).values
    faster = RobotImpacts(robot).survey(angles, 2.0 * velocities, ROWS).values
    np.testing.assert_allclose(faster, 2.0 * values, rtol=1e-9)


def test_contact_points_are_only_on_moving_segments():
    owners = set(RobotImpacts(Robot.load()).owners)
    assert "humanoid_root" not in owners
    assert {"vt1", "skullbase", "l_wrist", "r_wrist"} <= owners
