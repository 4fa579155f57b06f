import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.model import build_model, describe, find_joint_indices, find_turn_indices
from kinesic.sim.uncoupled import uncouple

ROBOT = Robot.load("upper36")


def test_robot_without_couplings_is_returned_unchanged():
    plain = Robot.load("upper22")
    assert uncouple(plain) is plain


def test_merging_coupled_segments_keeps_mass_and_positions_of_straight_fingers():
    folded = uncouple(ROBOT)
    assert folded.skeleton.names == ROBOT.skeleton.names
    assert folded.skeleton.couplings == ()
    weight = [sum(segment.mass for segment in robot.skeleton.segments) for robot in (ROBOT, folded)]
    assert weight[0] == pytest.approx(weight[1])
    ends = []
    for robot in (ROBOT, folded):
        frames = robot.skeleton.zero_frames
        ends.append(
            [
                frames.origins[k] + frames.rotations[k] @ capsule.end
                for k, segment in enumerate(robot.skeleton.segments)
                for capsule in segment.capsules
            ]
        )
    lowest = [min(np.round(rows, 9).tolist()) for rows in ends]
    assert lowest[0] == lowest[1]
    assert len(ends[0]) == len(ends[1])


def test_physics_model_omits_coupled_joints_and_drawing_model_contains_them():
    physics, picture = build_model(ROBOT), describe(ROBOT).compile()
    assert physics.nv == len(ROBOT.skeleton.hinges)
    assert len(find_joint_indices(ROBOT, physics)) == 36
    assert sorted(find_turn_indices(ROBOT, picture)) == list(range(36 + len(ROBOT.skeleton.couplings)))


def test_segment_origins_of_the_drawing_model_equal_forward_kinematics():
    model = describe(ROBOT).compile()
    data = mujoco.MjData(model)
    posture = np.random.default_rng(4).uniform(ROBOT.skeleton.lower, ROBOT.skeleton.upper)
    data.qpos[find_turn_indices(ROBOT, model)] = ROBOT.skeleton.with_couplings(posture)
    mujoco.mj_kinematics(model, data)
    frames = ROBOT.skeleton.frames(posture)
    for k, segment in enumerate(ROBOT.skeleton.segments):
        np.testing.assert_allclose(data.body(segment.name).xpos, frames.origins[k], atol=1e-9)
