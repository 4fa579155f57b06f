from dataclasses import replace

import mujoco
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.sim.kinematics import motion_frames
from kinesic.sim.model import build_model, joint_order
from kinesic.sim.worst_postures import random_postures

ROBOT = Robot.load()
POSTURES = random_postures(ROBOT.skeleton, 60, seed=5)


def test_a_motion_is_the_skeletons_kinematics_posture_by_posture():
    frames = motion_frames(ROBOT.skeleton, POSTURES)
    for k, posture in enumerate(POSTURES):
        one = ROBOT.skeleton.frames(posture)
        assert np.abs(frames.rotations[..., k] - one.rotations).max() < 1e-12
        assert np.abs(frames.origins[..., k] - one.origins).max() < 1e-12


def test_mujoco_has_the_same_skeleton():
    model = build_model(ROBOT)
    data = mujoco.MjData(model)
    ids = [model.body(segment.name).id for segment in ROBOT.skeleton.segments]
    for posture in POSTURES:
        data.qpos[:] = posture
        mujoco.mj_kinematics(model, data)
        frames = ROBOT.skeleton.frames(posture)
        assert np.abs(data.xpos[ids] - frames.origins).max() < 1e-12
        assert np.abs(data.xmat[ids].reshape(-1, 3, 3) - frames.rotations).max() < 1e-12


def test_points_move_with_their_segment():
    frames = motion_frames(ROBOT.skeleton, POSTURES)
    palm = ROBOT.sites["l_palm"]
    k = ROBOT.skeleton.segment(palm.segment)
    points = frames.points(k, palm.position)
    one = ROBOT.skeleton.frames(POSTURES[7])
    assert np.allclose(points[:, 7], one.origins[k] + one.rotations[k] @ palm.position, atol=1e-12)
    assert points.shape == (3, 60)


def test_hinges_that_miss_their_centre_move_as_in_mujoco():
    """A foreign robot's hinges: the skeleton, the motion's frames and the model are one."""
    random = np.random.default_rng(7)
    robot = Robot.load()
    hinges = tuple(replace(h, at=sealed(random.uniform(-0.02, 0.02, 3))) for h in robot.skeleton.hinges)
    robot = replace(robot, skeleton=replace(robot.skeleton, hinges=hinges))
    skeleton, model = robot.skeleton, build_model(robot)
    data = mujoco.MjData(model)
    angles = random.uniform(skeleton.lower, skeleton.upper, (5, len(hinges)))
    motion = motion_frames(skeleton, angles)
    for row, posture in enumerate(angles):
        frames = skeleton.frames(posture)
        data.qpos[joint_order(robot, model)] = posture
        mujoco.mj_kinematics(model, data)
        for k, segment in enumerate(skeleton.segments):
            assert np.allclose(frames.origins[k], data.body(segment.name).xpos, atol=1e-12)
            assert np.allclose(motion.origins[k][:, row], frames.origins[k], atol=1e-12)
            assert np.allclose(frames.rotations[k], data.body(segment.name).xmat.reshape(3, 3), atol=1e-12)
