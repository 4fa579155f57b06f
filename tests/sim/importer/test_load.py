import mujoco
import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer.couplings import urdf_joints
from kinesic.sim.importer.load import _find_effort, load_robot_tree
from kinesic.sim.importer.model_tree import BASE_INDEX, Follow
from kinesic.sim.importer.reading.robot_files import read_robot_files


def named(tree, name):
    return next(joint for joint in tree.joints if joint.name == name)


def test_robot_model_is_loaded_without_its_mesh_files(tee, hanging):
    assert len(tee.joints) == 4 + 2 * 9 + 2 * 3
    assert len(hanging.joints) == 1 + 2 * 7


def test_free_joint_gives_no_hinge_and_mimic_joints_are_read(tee, hanging):
    assert {joint.name for joint in hanging.joints if joint.follows} == {"left_mimic_joint", "right_mimic_joint"}
    assert all(joint.name for joint in tee.joints)


def test_hinges_of_a_loaded_robot_are_listed_after_their_parents(tee):
    assert all(joint.parent < k for k, joint in enumerate(tee.joints))
    assert named(tee, "waist").parent == BASE_INDEX
    assert tee.joints[named(tee, "l_bend").parent].name == "l_twist"


def test_motor_data_are_read_from_the_imported_robot_file(tee, hanging):
    pitch = named(tee, "l_pitch")
    assert (pitch.effort, pitch.gain, pitch.speed) == (20.0, 60.0, None)
    assert named(tee, "r_pitch").effort is None
    elbow = named(hanging, "left_elbow_joint")
    assert (elbow.effort, elbow.speed) == (30.0, 3.5)


def test_continuous_joint_of_a_robot_file_has_no_range(hanging):
    turn, elbow = named(hanging, "left_turn_joint"), named(hanging, "left_elbow_joint")
    assert (turn.lower, turn.upper) == (None, None)
    assert (elbow.lower, elbow.upper) == (-2.2, 0.0)


def test_masses_and_shapes_belong_to_the_hinge_that_moves_them(tee):
    k = [joint.name for joint in tee.joints].index("l_twist")
    assert tee.parts[k].mass == pytest.approx(1.2)
    (upper,) = tee.parts[k].shapes
    assert upper.radius == 0.035
    assert np.linalg.norm(upper.end - upper.start) == pytest.approx(0.28)
    assert tee.base.mass == pytest.approx(4.0)


def test_loading_a_robot_model_creates_no_files(tee_path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    load_robot_tree(tee_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<mujoco><worldbody><body></mujoco>", "not a readable MJCF or URDF"),
        ("<mujoco><nonsense/></mujoco>", "not a readable MJCF or URDF"),
        ('<robot name="r"><joint name="j"><limit velocity="fast"/></joint></robot>', "not a readable MJCF or URDF"),
    ],
)
def test_error_for_a_broken_robot_file_names_the_cause(written, text, message):
    with pytest.raises(ConfigError, match=message) as caught:
        load_robot_tree(written("broken.xml", text))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("ending", [".URDF", ".Urdf", ".XML", ".MJCF", ".mjcf", ""])
def test_suffix_of_a_robot_file_may_be_uppercase(tee_path, hanging_path, tmp_path, ending):
    source = hanging_path if ending.lower() == ".urdf" else tee_path
    (tmp_path / f"robot{ending}").write_bytes(source.read_bytes())
    (tmp_path / "robot.xml").write_text("<mujoco/>")  # a different file that must not be read
    model = load_robot_tree(tmp_path / f"robot{ending}")
    assert [joint.name for joint in model.joints] == [joint.name for joint in load_robot_tree(source).joints]


def test_included_files_are_found_next_to_a_robot_file_with_uppercase_suffix(tee_path, tmp_path):
    (tmp_path / "part.xml").write_bytes(tee_path.read_bytes())
    (tmp_path / "robot.MJCF").write_text('<mujoco><include file="part.xml"/></mujoco>')
    assert len(load_robot_tree(tmp_path / "robot.MJCF").joints) == len(load_robot_tree(tee_path).joints)


def test_error_names_a_missing_model_file(tmp_path):
    with pytest.raises(ConfigError, match=r"nowhere\.xml: no such file"):
        load_robot_tree(tmp_path / "nowhere.xml")


def test_urdf_velocities_and_mimics_are_read(hanging_path):
    joints = urdf_joints(read_robot_files(hanging_path).root)
    assert joints["left_elbow_joint"].speed == 3.5
    assert joints["left_mimic_joint"].follows == Follow("left_grip", 1.0, 0.0)
    assert joints["left_grip_joint"].follows is None


def test_no_urdf_joints_are_read_from_an_mjcf_file(tee_path):
    assert urdf_joints(read_robot_files(tee_path).root) == {}


@pytest.mark.parametrize(
    ("actuator", "effort"),
    [
        ('<motor joint="j" gear="3" ctrllimited="true" ctrlrange="-2 2"/>', 6.0),
        ('<motor joint="j" gear="3"/>', None),
        ('<position joint="j" kp="10" ctrllimited="true" ctrlrange="-1 1"/>', None),
        ('<position joint="j" kp="10" gear="2" ctrllimited="true" ctrlrange="-1 1" forcerange="-4 4"/>', 8.0),
    ],
)
def test_control_range_limits_the_torque_of_motors_only(actuator, effort):
    body = '<body><joint name="j"/><geom size="0.1" mass="1"/></body>'
    text = f"<mujoco><worldbody>{body}</worldbody><actuator>{actuator}</actuator></mujoco>"
    assert _find_effort(mujoco.MjModel.from_xml_string(text), 0) == effort
