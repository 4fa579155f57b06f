"""Import of real robots from two optional wheels (extra `robots`)."""

import os
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.body.robot_schema import robot_text
from kinesic.ik.arm.refine import refine_posture
from kinesic.sim.importer.convert import Mapped, import_humanoid

# name: wheel, end of the path, number of moved hinges, joint of the left elbow
ROBOT_FILES = {
    "op3": ("playground", "op3/xmls/op3_mjx_feetonly.xml", 8, "l_el"),
    "g1": ("playground", "g1/xmls/g1_mjx_feetonly.xml", 17, "left_elbow_joint"),
    "h1": ("playground", "h1/xmls/h1_mjx_feetonly.xml", 9, "left_elbow"),
    "t1": ("playground", "t1/xmls/t1_mjx_feetonly.xml", 10, "Left_Elbow_Yaw"),
    "apollo": ("playground", "apollo/xmls/apollo_mjx_feetonly.xml", 20, "l_elbow_fe"),
    "g1 (URDF)": ("example-robot-data", "g1_description/urdf/g1_29dof_rev_1_0.urdf", 17, "left_elbow_joint"),
    "talos": ("example-robot-data", "talos_data/robots/talos_full_v2.urdf", 18, "arm_left_4_joint"),
    "romeo": ("example-robot-data", "romeo_description/urdf/romeo.urdf", 19, "LElbowYaw"),
    "icub": ("example-robot-data", "icub_description/robots/icub.urdf", 20, "l_elbow"),
    "baxter": ("example-robot-data", "baxter_description/urdf/baxter.urdf", 15, "left_e1"),
    "pr2": ("example-robot-data", "pr2_description/urdf/pr2.urdf", 16, "l_elbow_flex_joint"),
    "alex": ("example-robot-data", "alex_description/urdf/alex_psyonic_hands.urdf", 19, "LeftElbowPitch"),
    "simple": ("example-robot-data", "simple_humanoid_description/urdf/simple_humanoid.urdf", 17, "LARM_ELBOW"),
    "tiago pro": ("example-robot-data", "tiago_pro_description/robots/tiago_pro.urdf", 16, "arm_left_4_joint"),
}
SAMPLE_ROBOTS = ("op3", "t1", "tiago pro")  # robots imported in every run; `make soak` imports all


def model(name: str) -> Path:
    wheel, end, _, _ = ROBOT_FILES[name]
    try:
        results = [file for file in files(wheel) or () if str(file).endswith(end)]
    except PackageNotFoundError:
        pytest.skip(f"{wheel} is not installed (pip install --no-deps {wheel})")
    return Path(os.fspath(results[0].locate()))


def check(name: str, found: Mapped, folder: Path) -> None:
    """Check an import: hinge count, elbow, confidence and reachable targets."""
    _, _, hinges, elbow = ROBOT_FILES[name]
    joints = {hinge.name: found.figure.tree.joints[hinge.joint].name for hinge in found.hinges}
    assert len(joints) == hinges
    assert joints["l_elbow_flexion"] == elbow
    assert not found.doubtful
    path = folder / "robot.toml"
    path.write_text(robot_text(found.file, heading=[], remarks=found.remarks), encoding="utf-8")
    robot = Robot.load(path)
    hand, joints_of_arm = robot.skeleton.segment("l_wrist"), list(robot.joints("l_arm"))
    random = np.random.default_rng(0)
    for _ in range(5):
        posture = np.array(robot.skeleton.rest)
        posture[joints_of_arm] = random.uniform(robot.skeleton.lower, robot.skeleton.upper)[joints_of_arm]
        target = robot.skeleton.frames(posture).origins[hand]
        rest = robot.skeleton.rest
        solved = refine_posture(robot, "l", Reach(target), rest, near=rest)
        assert np.linalg.norm(robot.skeleton.frames(solved).origins[hand] - target) < 2e-3


@pytest.mark.parametrize("name", SAMPLE_ROBOTS)
def test_sample_of_corpus_robots_is_imported_without_manual_edits(name, tmp_path):
    check(name, import_humanoid(model(name)), tmp_path)


@pytest.mark.soak
@pytest.mark.parametrize("name", [name for name in ROBOT_FILES if name not in SAMPLE_ROBOTS])
def test_other_corpus_robots_are_imported_without_manual_edits(name, tmp_path):
    check(name, import_humanoid(model(name)), tmp_path)
