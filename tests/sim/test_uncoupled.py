import mujoco
import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.sim.model import build_model, describe, joint_order, turn_order
from kinesic.sim.uncoupled import uncouple

ROBOT = Robot.load("upper36")


def test_a_robot_without_couplings_is_itself():
    plain = Robot.load("upper22")
    assert uncouple(plain) is plain


def test_nothing_is_lost_by_weight_and_straight_fingers_stay_where_they_are():
    folded = uncouple(ROBOT)
    assert folded.skeleton.names == ROBOT.skeleton.names
    assert folded.skeleton.couplings == ()
    weight = [sum(segment.mass for segment in robot.skeleton.segments) for robot in (ROBOT, folded)]
    assert weight[0] == pytest.approx(weight[1])
    ends = []
    for robot in (ROBOT, folded):
        frames = robot.skeleton.straight
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


def test_physics_has_a_joint_for_each_drive_and_pictures_for_each_turn():
    physics, picture = build_model(ROBOT), describe(ROBOT).compile()
    assert physics.nv == len(ROBOT.skeleton.hinges)
    assert len(joint_order(ROBOT, physics)) == 36
    assert sorted(turn_order(ROBOT, picture)) == list(range(36 + len(ROBOT.skeleton.couplings)))


def test_a_picture_stands_as_forward_kinematics_has_it():
    model = describe(ROBOT).compile()
    data = mujoco.MjData(model)
    posture = np.random.default_rng(4).uniform(ROBOT.skeleton.lower, ROBOT.skeleton.upper)
    data.qpos[turn_order(ROBOT, model)] = ROBOT.skeleton.turns(posture)
    mujoco.mj_kinematics(model, data)
    frames = ROBOT.skeleton.frames(posture)
    for k, segment in enumerate(ROBOT.skeleton.segments):
        np.testing.assert_allclose(data.body(segment.name).xpos, frames.origins[k], atol=1e-9)
