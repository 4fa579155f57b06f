"""Shells of robots that extend another robot."""

from pathlib import Path

import numpy as np

from kinesic.body.config import CONFIGS
from kinesic.body.robot import Robot
from kinesic.sim.shells.shell import describe_segments, fingerprint, load_shell, write_shell
from kinesic.sim.shells.variant import find_shell

HEADER = '[robot]\nname = "own"\nextends = "upper22"\n'
THICK_HAND = """
[[body]]
name = "l_wrist"
parent = "l_elbow"
pos = [0, 0, -0.20]
capsules = [{ from = [0, 0, -0.020], to = [0, 0, -0.086], r = 0.050 }]
"""
ROBOT_SHELL = load_shell(Robot.load())
assert ROBOT_SHELL is not None


def write_robot(path: Path, text: str) -> Robot:
    path.write_text(text, encoding="utf-8")
    return Robot.load(path)


def test_robot_with_the_shape_of_its_base_robot_is_drawn_with_the_shell_of_the_base_robot(tmp_path: Path):
    robot = write_robot(tmp_path / "own.toml", HEADER + '[[hinge]]\nname = "l_elbow_flexion"\nrange_deg = [0, 90]\n')
    shell = find_shell(robot)
    assert shell is not None
    assert shell.made_from == fingerprint(robot)
    for name, surface in ROBOT_SHELL.segments.items():
        np.testing.assert_array_equal(shell.segments[name].vertices, surface.vertices)
    second = write_robot(tmp_path / "second.toml", '[robot]\nname = "second"\nextends = "own.toml"\n')
    assert find_shell(second) is not None


def test_segments_that_differ_from_the_base_robot_get_a_new_surface(tmp_path: Path):
    robot = write_robot(tmp_path / "own.toml", HEADER + THICK_HAND)
    assert load_shell(robot) is None
    shell = find_shell(robot)
    assert shell is not None
    assert set(shell.segments) == set(ROBOT_SHELL.segments)
    kept = {name for name, surface in shell.segments.items() if is_unchanged(surface.vertices, name)}
    assert {"l_wrist", "r_wrist"} <= set(shell.segments) - kept, "both hands, as the right arm mirrors the left one"
    assert {"skullbase", "l_shoulder", "sacroiliac"} & set(shell.segments) <= kept
    old, new = (np.ptp(part.segments["l_wrist"].vertices, axis=0).max() for part in (ROBOT_SHELL, shell))
    assert new - old > 0.04, "as much as the hand is thicker"
    assert find_shell(robot) is shell, "it is built once"


def is_unchanged(vertices: np.ndarray, name: str) -> bool:
    surface = ROBOT_SHELL.segments[name]
    return len(vertices) == len(surface.vertices) and float(np.abs(vertices - surface.vertices).max()) < 1e-4


def test_shell_file_of_the_robot_is_preferred_to_that_of_its_base_robot(tmp_path: Path):
    robot = write_robot(tmp_path / "own.toml", HEADER)
    without_head = {name: part for name, part in ROBOT_SHELL.segments.items() if name != "skullbase"}
    write_shell(type(ROBOT_SHELL)(without_head, fingerprint(robot)), tmp_path / "own.npz")
    shell = find_shell(robot)
    assert shell is not None
    assert set(shell.segments) == set(without_head)


def test_robot_without_base_robot_or_with_one_without_shell_has_no_shell(tmp_path: Path):
    whole = (CONFIGS / "robots" / "upper22.toml").read_text(encoding="utf-8")
    assert find_shell(write_robot(tmp_path / "copy.toml", whole)) is None
    assert find_shell(write_robot(tmp_path / "own.toml", '[robot]\nname = "own"\nextends = "copy.toml"\n')) is None
    assert find_shell(Robot.load("human")) is None


def test_segment_descriptions_differ_only_for_segments_with_other_shapes(tmp_path: Path):
    robot = write_robot(tmp_path / "own.toml", HEADER + THICK_HAND)
    old, new = describe_segments(Robot.load()), describe_segments(robot)
    assert {name for name in old if old[name] != new[name]} == {"l_wrist", "r_wrist"}
