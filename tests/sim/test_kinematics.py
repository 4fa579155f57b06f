from dataclasses import replace

import mujoco
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.sim.kinematics import compute_motion_frames
from kinesic.sim.model import build_model, find_joint_indices
from kinesic.sim.worst_postures import random_postures

ROBOT = Robot.load()
SAMPLE_POSTURES = random_postures(ROBOT.skeleton, 60, seed=5)


def test_motion_frames_equal_skeleton_frames_per_posture():
    frames = compute_motion_frames(ROBOT.skeleton, SAMPLE_POSTURES)
    for k, posture in enumerate(SAMPLE_POSTURES):
        one = ROBOT.skeleton.frames(posture)
        assert np.abs(frames.rotations[..., k] - one.rotations).max() < 1e-12
        assert np.abs(frames.origins[..., k] - one.origins).max() < 1e-12


def test_segment_frames_equal_those_of_mujoco_kinematics():
    model = build_model(ROBOT)
    data = mujoco.MjData(model)
    ids = [model.body(segment.name).id for segment in ROBOT.skeleton.segments]
    for posture in SAMPLE_POSTURES:
        data.qpos[:] = posture
        mujoco.mj_kinematics(model, data)
        frames = ROBOT.skeleton.frames(posture)
        assert np.abs(data.xpos[ids] - frames.origins).max() < 1e-12
        assert np.abs(data.xmat[ids].reshape(-1, 3, 3) - frames.rotations).max() < 1e-12


def test_points_of_a_segment_move_with_the_segment():
    frames = compute_motion_frames(ROBOT.skeleton, SAMPLE_POSTURES)
    palm = ROBOT.sites["l_palm"]
    k = ROBOT.skeleton.segment(palm.segment)
    starts, ends = frames.axes([k], palm.position[None], 2.0 * palm.position[None])
    one = ROBOT.skeleton.frames(SAMPLE_POSTURES[7])
    for factor, points in ((1.0, starts), (2.0, ends)):
        expected = one.origins[k] + one.rotations[k] @ (factor * palm.position)
        assert np.allclose(points[0, :, 7], expected, atol=1e-12)


def test_offset_hinge_axes_move_as_in_mujoco():
    """On an imported robot, skeleton frames, motion frames and MuJoCo agree."""
    random = np.random.default_rng(7)
    robot = Robot.load()
    hinges = tuple(replace(h, at=sealed(random.uniform(-0.02, 0.02, 3))) for h in robot.skeleton.hinges)
    robot = replace(robot, skeleton=replace(robot.skeleton, hinges=hinges))
    skeleton, model = robot.skeleton, build_model(robot)
    data = mujoco.MjData(model)
    angles = random.uniform(skeleton.lower, skeleton.upper, (5, len(hinges)))
    motion = compute_motion_frames(skeleton, angles)
    for row, posture in enumerate(angles):
        frames = skeleton.frames(posture)
        data.qpos[find_joint_indices(robot, model)] = posture
        mujoco.mj_kinematics(model, data)
        for k, segment in enumerate(skeleton.segments):
            assert np.allclose(frames.origins[k], data.body(segment.name).xpos, atol=1e-12)
            assert np.allclose(motion.origins[k][:, row], frames.origins[k], atol=1e-12)
            assert np.allclose(frames.rotations[k], data.body(segment.name).xmat.reshape(3, 3), atol=1e-12)
