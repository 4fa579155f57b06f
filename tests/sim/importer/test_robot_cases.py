"""Robot files that were once imported incorrectly, or refused without the reason."""

import os
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.sim.importer.convert import Mapped, import_humanoid

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
CASE_FOLDER = CORPUS_FOLDER.parent / "cases" / "robots"
ARM_WORDS = ("shoulder", "elbow", "wrist", "forearm", "yaw_drive")

pytestmark = pytest.mark.skipif(not CASE_FOLDER.is_dir(), reason=f"no cases at {CASE_FOLDER} (KINESIC_CORPUS)")


@cache
def imported(name: str) -> Mapped:
    return import_humanoid(CASE_FOLDER / name)


def robot_of(name: str) -> Robot:
    return Robot.of(robot_from_tables(imported(name).file, CASE_FOLDER / name))


def joints(name: str) -> dict[str, str]:
    """Return the joint of the file for each hinge."""
    mapped = imported(name)
    return {hinge.name: mapped.figure.tree.joints[hinge.joint].name for hinge in mapped.hinges}


def review(name: str) -> str:
    return "; ".join(imported(name).file.robot.imported.review)


@pytest.mark.parametrize("name", ["arms_fixed_legs_free.urdf", "biped_without_arms.urdf"])
def test_robot_whose_only_limbs_are_legs_is_refused(name):
    with pytest.raises(ConfigError, match="no movable arms; the mirrored limbs end in feet"):
        imported(name)


def test_robot_without_a_movable_joint_is_refused():
    with pytest.raises(ConfigError, match="no movable joint"):
        imported("only_fixed_joints.urdf")


@pytest.mark.parametrize(
    "name",
    [
        "ok_reference.urdf",
        "shoulder_pitch_on_midline.urdf",
        "gear_drives_the_arm_by_mimic.urdf",
        "one_gripper_only.urdf",
        "dynamics_twice.urdf",
        "massless_antenna_bad_inertia.urdf",
        "lidar_spindle_on_head.urdf",
        "last_joint_is_forearm_twist.urdf",
    ],
)
def test_arm_hinges_have_the_arm_joints_of_the_file(name):
    arms = {hinge: joint for hinge, joint in joints(name).items() if hinge.startswith(("l_", "r_"))}
    assert len(arms) == 10
    for hinge, joint in arms.items():
        assert joint.startswith("left" if hinge.startswith("l_") else "right")
        assert any(word in joint for word in ARM_WORDS)
    assert joints(name)["l_elbow_flexion"] == "left_elbow"
    assert not imported(name).doubtful


def test_joint_of_only_one_side_is_named_as_omitted_in_the_import_review():
    assert "right_grip" not in joints("one_gripper_only.urdf").values()
    assert "right_grip" in review("one_gripper_only.urdf")


@pytest.mark.parametrize(
    ("name", "part", "repair"),
    [
        ("massless_antenna_bad_inertia.urdf", "link ant", "inertia"),
        ("dynamics_twice.urdf", "joint right_shoulder_pitch", "<dynamics> twice"),
    ],
)
def test_repair_of_a_robot_file_is_noted_with_the_name_of_the_part(name, part, repair):
    assert part in review(name)
    assert repair in review(name)


def test_rotating_sensor_on_the_head_of_an_imported_robot_is_no_neck_joint():
    assert {"lidar_spindle", "antenna"}.isdisjoint(joints("lidar_spindle_on_head.urdf").values())
    assert "antenna" not in joints("massless_antenna_bad_inertia.urdf").values()


def test_surplus_neck_joints_about_one_axis_are_named_as_omitted_in_the_import_review():
    name = "neck_of_five_same_axis.urdf"
    mapped = set(joints(name).values())
    neck = [joint.name for joint in imported(name).figure.tree.joints if "neck" in joint.name]
    unmapped = [joint for joint in neck if joint not in mapped]
    assert len(unmapped) == len(neck) - 4 > 0
    assert all(joint in review(name) for joint in unmapped)


def test_neck_joints_about_one_axis_are_named_after_vertebrae_from_the_lowest_up():
    neck = {joint: hinge for hinge, joint in joints("neck_of_five_same_axis.urdf").items() if "neck" in joint}
    assert [neck[f"neck{k}"] for k in range(4)] == ["vc7_tilt", "vc4_tilt", "vc2_tilt", "skullbase_tilt"]


def test_rest_angles_of_an_imported_hand_are_within_their_ranges():
    robot = robot_of("thumb_never_at_zero.urdf")
    rest, skeleton = robot.skeleton.rest, robot.skeleton
    assert ((skeleton.lower <= rest) & (rest <= skeleton.upper)).all()
    assert any("thumb" in hinge.name and hinge.lower > 0 for hinge in skeleton.hinges)


def test_robot_model_of_60_xml_files_is_imported():
    assert len(joints("mjcf_of_60_files/robot.xml")) > 6


def test_hand_of_an_imported_arm_with_a_final_twist_joint_does_not_exceed_the_links_of_the_file():
    mapped = imported("last_joint_is_forearm_twist.urdf")
    tip = min(
        float(end[2]) - shape.radius
        for k in mapped.figure.tree.below(mapped.figure.arms["l"].joints[-1])
        for shape in mapped.figure.tree.parts[k].shapes
        for end in (shape.start, shape.end)
    )
    robot = robot_of("last_joint_is_forearm_twist.urdf")
    frames, palm = robot.skeleton.zero_frames, robot.arm("l").palm
    base = float(mapped.figure.arms["l"].centres.shoulder[2] - frames.origins[robot.arm("l").shoulder][2])
    hand = robot.skeleton.segment(palm.segment)
    ends = [end for capsule in robot.skeleton.segments[hand].capsules for end in (capsule.start, capsule.end)]
    for point in (palm.position, *ends):
        assert float((frames.origins[hand] + frames.rotations[hand] @ point)[2]) + base > tip - 0.002


def test_mesh_in_millimetres_is_scaled_before_far_triangles_are_removed():
    mapped = imported("mesh_in_millimetres.urdf")
    (surface,) = [surface for part in (mapped.figure.tree.base, *mapped.figure.tree.parts) for surface in part.surfaces]
    extent = np.ptp(surface.mesh.vertices, axis=0)
    assert len(surface.mesh.corners) >= 12
    assert 0.1 < float(extent.max()) < 1.0


def test_mesh_in_a_sibling_folder_of_a_ros_package_is_found():
    tree = imported("ros_layout/urdf/robot.urdf").figure.tree
    assert sum(len(part.surfaces) for part in (tree.base, *tree.parts)) == 1
    assert not tree.left_out


def test_robot_file_with_only_one_arm_is_imported():
    robot = robot_of("one_arm.urdf")
    assert robot.sides == ("r",)
    assert joints("one_arm.urdf")["r_elbow_flexion"] == "right_elbow"
    assert "no left arm" in review("one_arm.urdf")


@pytest.mark.parametrize("name", ["robot.urdf.xacro", "robot2.urdf.xacro"])
def test_xacro_file_is_expanded_if_xacro_is_installed_or_refused_with_the_expansion_command(name):
    has_xacro = find_spec("xacro") is not None
    with pytest.raises(ConfigError, match="no movable joint" if has_xacro else rf"xacro {name} > robot.urdf"):
        imported(name)


def test_captured_motion_is_refused_with_the_verb_that_reads_it():
    with pytest.raises(ConfigError, match="captured motion"):
        imported("t.bvh")
