"""Tests of motions as BVH files of the robot's skeleton."""

from pathlib import Path

import numpy as np

from kinesic.body.robot import Robot
from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.skeleton_motion import joint_frames
from kinesic.planning.files.bvh_writer import write_bvh

BVH_AXES = [1, 2, 0]  # kinesic's y, z and x are BVH's x, y and z
OFFSET_CENTRES = """
[[body]]
name = "l_shoulder"
pos = [0.0, 0.06, 0.0]
[[hinge]]
name = "l_shoulder_abduct"
at = [0.0, 0.0, 0.02]
[[coupling]]
name = "l_tip"
body = "l_elbow"
axis = [0, 0, 1]
range_deg = [-200, 200]
driver = "skullbase_tilt"
offset_deg = 10
"""


def slow_angles(robot: Robot) -> np.ndarray:
    """Return a motion between two random postures, without leaps."""
    skeleton = robot.skeleton
    first, last = np.random.default_rng(0).uniform(skeleton.lower, skeleton.upper, (2, len(skeleton.names)))
    return np.linspace(first, last, 30)


def test_joint_positions_in_a_written_bvh_file_equal_those_of_the_robot(tmp_path: Path):
    """Check robots with fingers, coupled joints and offset rotation centres."""
    extended = tmp_path / "robot.toml"
    extended.write_text(f'[robot]\nname = "mine"\nextends = "upper22"\n{OFFSET_CENTRES}', encoding="utf-8")
    for name in ("upper22", "human", extended):
        robot = Robot.load(name)
        angles, path = slow_angles(robot), tmp_path / "a.bvh"
        write_bvh(angles, robot, path, rate=50)
        joints, motion = read_bvh(path.read_bytes(), "a.bvh")
        reached = joint_frames(joints, motion)
        frames = robot.skeleton.frames(angles)
        for k, segment in enumerate(robot.skeleton.segments):
            hinges = [hinge for hinge in robot.skeleton.hinges if hinge.segment == segment.name]
            centre = hinges[-1].at if hinges else np.zeros(3)
            place = frames.origins[:, k] + frames.rotations[:, k] @ centre
            np.testing.assert_allclose(reached.positions[segment.name], 100.0 * place[:, BVH_AXES], atol=1e-3)
        assert np.diff(motion.times).round(6).tolist() == [0.02] * 29
    assert "l_shoulder_flexion" in {joint.name for joint in joints}  # a joint of its own, about another centre


def test_bvh_file_of_a_robot_is_read_as_a_human_skeleton(tmp_path: Path):
    robot = Robot.load("upper22")
    write_bvh(np.tile(robot.skeleton.rest, (30, 1)), robot, tmp_path / "a.bvh", rate=100)
    clip = clip_of_skeleton(*read_bvh((tmp_path / "a.bvh").read_bytes(), "a.bvh"), "a.bvh")
    assert clip.arms["l"].wrist[0, 2] < -0.8
