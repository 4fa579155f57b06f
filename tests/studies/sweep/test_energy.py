import mujoco
import numpy as np

from kinesic.body.robot import Robot
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.model import build, joint_order
from kinesic.studies.sweep.energy import kinetic_energy

ROBOT = Robot.load()


def test_it_is_the_energy_that_mujoco_has():
    random = np.random.default_rng(3)
    angles = random.uniform(ROBOT.skeleton.lower, ROBOT.skeleton.upper, (5, len(ROBOT.skeleton.hinges)))
    speeds = random.normal(0.0, 2.0, angles.shape)
    model = build(ROBOT)
    data, order, wanted = mujoco.MjData(model), joint_order(ROBOT, model), []
    for posture, speed in zip(angles, speeds, strict=True):
        data.qpos[order], data.qvel[order] = posture, speed
        mujoco.mj_fwdPosition(model, data)
        full = np.empty((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        wanted.append(0.5 * data.qvel @ full @ data.qvel)
    np.testing.assert_allclose(kinetic_energy(MujocoDynamics(ROBOT), angles, speeds), wanted, rtol=1e-9)


def test_a_body_at_rest_has_none():
    still = np.zeros((2, len(ROBOT.skeleton.hinges)))
    assert kinetic_energy(MujocoDynamics(ROBOT), still + ROBOT.skeleton.rest, still).tolist() == [0.0, 0.0]
