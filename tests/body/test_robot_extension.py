import os
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot

EXTENSION_HEADER = '[robot]\nname = "mine"\nextends = "upper22"\n'


@pytest.fixture
def extended(tmp_path: Path):
    def load(lines: str) -> Robot:
        path = tmp_path / "mine.toml"
        path.write_text(EXTENSION_HEADER + lines, encoding="utf-8")
        return Robot.load(path)

    return load


def test_robot_file_that_extends_another_overrides_given_values_and_inherits_the_rest(extended):
    plain = Robot.load("upper22")
    robot = extended("""
[[hinge]]
name = "l_elbow_flexion"
range_deg = [0, 90]

[[body]]
name = "l_ring"
parent = "l_wrist"
pos = [0, 0, -0.05]
mass = 0.001
capsules = []

[rest]
l_elbow_flexion = 30

[collision]
exclude = [{ pair = ["l_ring", "l_elbow"], why = "a test" }]
""")
    assert robot.name == "mine"
    assert robot.skeleton.names == plain.skeleton.names
    for side in "lr":
        elbow = robot.skeleton.joint(f"{side}_elbow_flexion")
        assert robot.skeleton.upper[elbow] == pytest.approx(1.5708, abs=1e-4)
        assert robot.skeleton.rest[elbow] == pytest.approx(0.5236, abs=1e-4)
        assert robot.mounts[elbow].drive == plain.mounts[elbow].drive
        assert robot.skeleton.segments[robot.skeleton.segment(f"{side}_ring")].parent == f"{side}_wrist"
    assert len(robot.exclusions) == len(plain.exclusions) + 2
    assert robot.min_clearance == plain.min_clearance


def test_robot_file_in_same_folder_can_be_extended(extended, tmp_path: Path):
    extended("[rest]\nl_elbow_flexion = 40\n")
    path = tmp_path / "other.toml"
    path.write_text('[robot]\nname = "other"\nextends = "mine.toml"\n[rest]\nl_wrist_pivot = 5\n', encoding="utf-8")
    robot = Robot.load(path)
    assert robot.skeleton.rest[robot.skeleton.joint("l_elbow_flexion")] == pytest.approx(0.698, abs=1e-3)
    assert robot.skeleton.rest[robot.skeleton.joint("r_wrist_pivot")] == pytest.approx(0.0873, abs=1e-4)


def test_robot_files_that_extend_each_other_are_refused(tmp_path: Path):
    for name, other in (("one", "two"), ("two", "one")):
        (tmp_path / f"{name}.toml").write_text(
            f'[robot]\nname = "{name}"\nextends = "{other}.toml"\n', encoding="utf-8"
        )
    with pytest.raises(ConfigError, match=r"extends itself: one\.toml, which extends two\.toml, which extends one"):
        Robot.load(tmp_path / "one.toml")


def test_extending_an_unknown_robot_is_refused_with_a_suggestion(tmp_path: Path):
    path = tmp_path / "mine.toml"
    path.write_text(EXTENSION_HEADER.replace("upper22", "uper22"), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"no robot uper22; did you mean upper22\?"):
        Robot.load(path)


def robot(extends: str) -> str:
    return f'[robot]\nname = "mine"\nextends = "{extends}"\n'


@pytest.mark.parametrize("place", ["base.toml", "below/base.toml"])
def test_robot_file_in_the_folder_or_a_subfolder_may_be_extended(place: str, tmp_path: Path):
    (tmp_path / place).parent.mkdir(exist_ok=True)
    (tmp_path / place).write_text(robot("upper22"))
    (tmp_path / "mine.toml").write_text(robot(place))
    assert Robot.load(tmp_path / "mine.toml").name == "mine"


@pytest.mark.parametrize(
    "extends", ["../secret.toml", "{outside}/secret.toml", "link.toml", "../secret", "{outside}/secret"]
)
def test_robot_file_that_extends_a_file_outside_its_folder_is_refused(extends: str, tmp_path: Path):
    home = tmp_path / "home"
    home.mkdir()
    (tmp_path / "secret.toml").write_text(robot("upper22"))
    (home / "link.toml").symlink_to("../secret.toml")
    (home / "mine.toml").write_text(robot(extends.format(outside=tmp_path)))
    message = r"mine\.toml: .*(outside of the folder .*copy that file there|no robot .*secret[; ])"
    with pytest.raises(ConfigError, match=message):
        Robot.load(home / "mine.toml")


def test_pipe_in_place_of_a_robot_or_calibration_file_is_refused(tmp_path: Path):
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "mine.toml").write_text(robot("pipe.toml"))
    with pytest.raises(ConfigError, match=r"mine\.toml: extends = 'pipe\.toml': .* is not a regular file"):
        Robot.load(tmp_path / "mine.toml")
    (tmp_path / "mine.toml").write_text(robot("upper22"))
    os.mkfifo(tmp_path / "mine.calibration.toml")
    with pytest.raises(ConfigError, match="not a regular file"):
        Robot.load(tmp_path / "mine.toml")


@pytest.mark.parametrize("name", ['["x"]', "[]", '{ x = "y" }', "1"])
def test_hinge_name_in_a_robot_file_must_be_a_string(extended, name: str):
    with pytest.raises(ConfigError, match=r"Expected `str`, got"):
        extended(f"[[hinge]]\nname = {name}\n")


@pytest.mark.parametrize("axis", ["[1e300, 1e300, 0]", "[1e-200, 0, 0]"])
def test_hinge_axis_in_a_robot_file_with_huge_or_tiny_length_is_refused(extended, axis: str):
    with pytest.raises(ConfigError, match="must be a direction such as"):
        extended(f'[[hinge]]\nname = "l_elbow_flexion"\naxis = {axis}\n')
