"""Imported robots with meshes: positions, and meshes that are not read."""

from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.robot_schema import robot_text
from kinesic.sim.importer import mesh_reader as module
from kinesic.sim.importer.convert import import_humanoid
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.mesh_file import Triangles
from kinesic.sim.importer.shell import MAX_SEGMENT_TRIANGLES, build_imported_shell, split_creases
from kinesic.sim.shells.shell import fingerprint

from .test_mesh_file import ball, stl

ARM_XML = """<body name="{name}" pos="0 {y} 0.4"><joint name="{name}_pitch" axis="0 1 0" range="-2.5 1"/>
  <joint name="{name}_roll" axis="{side} 0 0" range="-0.3 2"/><joint name="{name}_yaw" axis="0 0 {side}" range="-1 1"/>
  <geom type="capsule" fromto="0 0 -0.05 0 0 -0.28" size="0.03" mass="1"/>
  <body pos="0 0 -0.28"><joint name="{name}_elbow" axis="0 1 0" range="-2.2 0"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.03" mass="0.8"/>
    <geom type="mesh" mesh="{mesh}" contype="0" conaffinity="0" pos="0.01 0 -0.1" euler="0 0 90" rgba="{rgba} 1"/>
  </body></body>"""
LINK_XML = """<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>
  <inertia ixx="1e-2" iyy="1e-2" izz="1e-2" ixy="0" ixz="0" iyz="0"/></inertial>{seen}</link>"""
JOINT_XML = """<joint name="{s}_{kind}" type="revolute"><parent link="{before}"/><child link="{s}_{kind}"/>
  <origin xyz="{at}"/><axis xyz="{axis}"/><limit lower="{low}" upper="{high}" effort="9" velocity="3"/></joint>"""
BALL_XML = """<visual><origin xyz="0.01 0 -0.1" rpy="0 0 1.5707963"/><geometry>
  <mesh filename="package://puppet/meshes/ball.stl" scale="0.1 0.05 0.05"/></geometry></visual>"""


def mjcf(mesh: str = "ball", rgba: str = "0.9 0.9 0.9") -> str:
    left, right = (
        ARM_XML.format(name=name, y=0.2 * side, side=side, mesh=mesh, rgba=rgba)
        for name, side in (("left", 1), ("right", -1))
    )
    return f"""<mujoco model="puppet"><compiler meshdir="meshes"/><asset>
      <mesh name="ball" file="ball.stl" scale="0.1 0.05 0.05"/><mesh name="lost" file="lost.stl"/>
      <mesh name="out" file="../../outside.stl"/></asset><worldbody><body pos="0 0 0.8">
      <geom type="capsule" fromto="0 0 0 0 0 0.35" size="0.09" mass="5"/>
      <body pos="0 0 0.45"><joint name="pan" axis="0 0 1" range="-1 1"/>
        <geom size="0.09" pos="0.02 0 0.1" mass="1"/></body>
      {left}{right}</body></worldbody></mujoco>"""


def urdf() -> str:
    parts = [LINK_XML.format(name="base", z=0, mass=5, seen="")]
    for s, side in (("left", 1), ("right", -1)):
        turns = (
            ("pitch", "base", f"0 {0.2 * side} 0.4", "0 1 0", -2.5, 1, 0, ""),
            ("roll", f"{s}_pitch", "0 0 0", f"{side} 0 0", -0.3, 2, 0, ""),
            ("yaw", f"{s}_roll", "0 0 0", f"0 0 {side}", -1, 1, -0.15, ""),
            ("elbow", f"{s}_yaw", "0 0 -0.28", "0 1 0", -2.2, 0, -0.12, BALL_XML),
        )
        for kind, before, at, axis, low, high, z, seen in turns:
            parts.append(JOINT_XML.format(s=s, kind=kind, before=before, at=at, axis=axis, low=low, high=high))
            parts.append(LINK_XML.format(name=f"{s}_{kind}", z=z, mass=1 if z else 0.1, seen=seen))
    return f'<robot name="puppet">{"".join(parts)}</robot>'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "robot"
    (folder / "meshes").mkdir(parents=True)
    for path in (folder / "meshes" / "ball.stl", tmp_path / "outside.stl"):
        path.write_bytes(stl(ball(20)))
    return folder


def written(folder: Path, text: str, name: str = "puppet.xml") -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def imported(path: Path):
    result = import_humanoid(path)
    target = path.with_suffix(".toml")
    target.write_text(robot_text(result.file, heading=[], remarks=result.remarks), encoding="utf-8")
    robot = Robot.load(target)
    return result, robot, build_imported_shell(result, robot)


def test_imported_mesh_is_at_its_file_position_and_belongs_to_the_part_of_its_hinge(folder: Path):
    tree = load_robot_tree(written(folder, mjcf()))
    elbow = [joint.name for joint in tree.joints].index("left_elbow")
    (surface,) = tree.parts[elbow].surfaces
    assert [len(part.surfaces) for part in tree.parts].count(1) == 2
    places = surface.mesh.vertices
    np.testing.assert_allclose((places.max(0) + places.min(0)) / 2, [0.01, 0.2, 0.8 + 0.4 - 0.28 - 0.1], atol=0.003)
    np.testing.assert_allclose(np.ptp(places, axis=0), [0.1, 0.2, 0.1], atol=0.006)  # rotated by 90 deg
    bent = tree.turned({elbow: -np.pi / 2}).parts[elbow].surfaces[0].mesh.vertices
    np.testing.assert_allclose((bent.max(0) + bent.min(0)) / 2, [0.1, 0.2, 0.93], atol=0.003)
    assert not tree.base.surfaces


@pytest.mark.parametrize(("text", "name"), [(mjcf(), "puppet.xml"), (urdf(), "puppet.urdf")])
def test_shell_of_an_imported_robot_has_meshes_and_generated_housings_for_other_segments(
    folder: Path, text: str, name: str
):
    result, robot, shell = imported(written(folder, text, name))
    assert shell is not None
    assert not result.figure.tree.left_out
    assert shell.made_from == fingerprint(robot)
    assert set(shell.segments) == {s.name for s in robot.skeleton.segments if s.capsules}
    fore = shell.segments["l_elbow"]
    assert 0 < len(fore.triangles) <= MAX_SEGMENT_TRIANGLES
    np.testing.assert_allclose((fore.vertices.max(0) + fore.vertices.min(0)) / 2, [0.01, 0.0, -0.1], atol=0.004)
    np.testing.assert_allclose(np.linalg.norm(fore.normals, axis=1), 1.0, atol=1e-6)
    assert len(shell.segments["l_shoulder"].triangles) > 100


def test_dark_mesh_of_an_imported_robot_is_drawn_as_joint_and_not_as_shell(folder: Path):
    _, _, shell = imported(written(folder, mjcf(rgba="0.1 0.1 0.1")))
    assert shell is not None
    assert not len(shell.segments["l_elbow"].shell)
    assert len(shell.segments["l_elbow"].joint)


@pytest.mark.parametrize(
    ("mesh", "why"), [("lost", "lost.stl: not in the folder robot"), ("out", "outside.stl: not in the folder")]
)
def test_mesh_file_missing_or_outside_the_robot_folder_is_omitted_with_a_note(folder: Path, mesh: str, why: str):
    result, _, shell = imported(written(folder, mjcf(mesh)))
    assert shell is None
    (said,) = result.figure.tree.left_out
    assert why in said


def test_mesh_that_is_a_symbolic_link_out_of_the_robot_folder_is_omitted_with_a_note(folder: Path):
    (folder / "meshes" / "ball.stl").unlink()
    (folder / "meshes" / "ball.stl").symlink_to(folder.parent / "outside.stl")
    assert "not in the folder" in load_robot_tree(written(folder, mjcf())).left_out[0]


def test_meshes_of_an_imported_robot_beyond_the_size_limit_are_omitted_with_a_note(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(module, "MAX_MESH_BYTES", 100)
    assert "MB of meshes" in load_robot_tree(written(folder, mjcf())).left_out[0]


def test_imported_cube_mesh_keeps_sharp_edges_and_imported_ball_mesh_is_smooth():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    cube = Triangles(corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]))
    places, normals, _ = split_creases(cube)
    assert len(places) == 24
    np.testing.assert_allclose(np.abs(normals).max(axis=1), 1.0, atol=1e-9)
    round_one = ball(30)
    places, normals, _ = split_creases(round_one)
    assert np.einsum("vi,vi->v", places, normals).min() > 0.9
