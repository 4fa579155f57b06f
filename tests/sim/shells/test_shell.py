"""Shell files: reading, rejection, and robots with or without shells."""

import zipfile
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.sim.model import build_model, capsule_name
from kinesic.sim.scene_style import styled_model
from kinesic.sim.shells import shell as module
from kinesic.sim.shells.bake import main
from kinesic.sim.shells.shell import fingerprint, is_stale, load_shell, read_shell, write_shell

ROBOT = Robot.load()
ROBOT_SHELL = load_shell(ROBOT)
assert ROBOT_SHELL is not None


def make_changed_robot(robot: Robot, path: Path) -> Robot:
    """Return a robot with a 1 mm thicker forearm in a separate file."""
    segments = list(robot.skeleton.segments)
    k = robot.skeleton.segment("l_elbow")
    fat = [replace(shape, radius=shape.radius + 0.001) for shape in segments[k].capsules]
    segments[k] = replace(segments[k], capsules=tuple(fat))
    return replace(robot, path=path, skeleton=replace(robot.skeleton, segments=tuple(segments)))


def test_robot_without_shell_file_has_no_shell(tmp_path: Path):
    assert load_shell(replace(ROBOT, path=tmp_path / "own.toml")) is None
    assert not is_stale(replace(ROBOT, path=tmp_path / "own.toml"))
    assert load_shell(Robot.load("human")) is None


def test_shell_made_for_another_robot_description_is_not_drawn(tmp_path: Path):
    write_shell(ROBOT_SHELL, tmp_path / "own.npz")
    same, other = replace(ROBOT, path=tmp_path / "own.toml"), make_changed_robot(ROBOT, tmp_path / "own.toml")
    assert load_shell(same) is not None
    assert not is_stale(same)
    assert load_shell(other) is None
    assert is_stale(other)


def test_shell_stays_valid_if_the_robot_description_changes_without_its_shapes():
    narrow = replace(ROBOT.skeleton, hinges=tuple(replace(h, upper=h.upper - 0.1) for h in ROBOT.skeleton.hinges))
    assert fingerprint(replace(ROBOT, skeleton=narrow, min_clearance=0.02)) == fingerprint(ROBOT)


def test_bake_writes_the_shell_next_to_the_robot_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "own.toml"
    path.write_text('[robot]\nname = "own"\nextends = "upper22"\n')
    main([str(path)])
    assert "11 surfaces" in capsys.readouterr().out
    baked = load_shell(Robot.load(path))
    assert baked is not None
    assert set(baked.segments) == set(ROBOT_SHELL.segments)
    surface, same = baked.segments["skullbase"], ROBOT_SHELL.segments["skullbase"]
    np.testing.assert_allclose(surface.vertices.max(axis=0), same.vertices.max(axis=0), atol=1e-3)


def test_broken_shell_files_are_rejected_with_a_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "own.npz"
    write_shell(ROBOT_SHELL, path)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ConfigError, match=r"not a valid robot shell .* python -m kinesic.sim.shells.bake own.toml"):
        read_shell(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("step.npy", "no numbers")
    with pytest.raises(ConfigError, match="not a valid robot shell"):
        read_shell(path)
    path.write_bytes(whole)
    monkeypatch.setattr(module, "MAX_UNPACKED_SIZE", 1000)
    with pytest.raises(ConfigError, match="at most"):
        read_shell(path)


@pytest.mark.parametrize(
    ("key", "value"), [("triangles", np.full((10, 3), 9)), ("step", np.array(2.0)), ("counts", np.zeros((11, 3)))]
)
def test_shell_file_with_inconsistent_arrays_is_rejected(tmp_path: Path, key: str, value: np.ndarray):
    path = tmp_path / "own.npz"
    write_shell(ROBOT_SHELL, path)
    with np.load(path) as data:
        tables = {name: data[name] for name in data.files}
    np.savez_compressed(path, **(tables | {key: value}))
    with pytest.raises(ConfigError, match="not a valid robot shell"):
        read_shell(path)


def test_shell_file_with_pickled_objects_is_rejected(tmp_path: Path):
    path = tmp_path / "own.npz"
    np.savez(path, made_from=np.array([object()], dtype=object))
    with pytest.raises(ConfigError, match="not a valid robot shell"):
        read_shell(path)


MESH_GEOM = mujoco.mjtGeom.mjGEOM_MESH


def test_only_the_shell_is_visible_and_it_has_no_mass(tmp_path: Path):
    dressed = styled_model(ROBOT, width=64, height=48)
    bare = styled_model(replace(ROBOT, path=tmp_path / "own.toml"), width=64, height=48)
    meshes = [k for k in range(dressed.ngeom) if dressed.geom_type[k] == MESH_GEOM and dressed.geom_group[k] == 2]
    assert len(meshes) > len(ROBOT_SHELL.segments)
    assert not dressed.geom_contype[meshes].any()
    assert not dressed.geom_conaffinity[meshes].any()
    assert not [k for k in range(bare.ngeom) if bare.geom_type[k] == MESH_GEOM and bare.geom_group[k] == 2]
    np.testing.assert_allclose(dressed.body_mass, bare.body_mass)
    np.testing.assert_allclose(dressed.body_inertia, build_model(ROBOT).body_inertia)
    hidden = [capsule_name("l_elbow", 0), "l_elbow_flexion_servo"]
    assert all(dressed.geom(name).rgba[3] == 0.0 for name in hidden)
    assert all(bare.geom(name).rgba[3] == 1.0 for name in hidden)
    assert build_model(ROBOT).nmesh == 0


def test_meshes_of_the_physics_model_have_the_vertices_of_the_shell():
    model = styled_model(ROBOT, width=64, height=48)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    geom, straight = model.geom("skullbase_shell").id, ROBOT.skeleton.zero_frames
    mesh = model.geom_dataid[geom]
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    seen = model.mesh_vert[first : first + count] @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
    surface = ROBOT_SHELL.segments["skullbase"]
    result = surface.vertices[np.unique(surface.shell)] + straight.origins[ROBOT.skeleton.segment("skullbase")]
    np.testing.assert_allclose(seen.max(axis=0), result.max(axis=0), atol=1e-5)
    np.testing.assert_allclose(seen.min(axis=0), result.min(axis=0), atol=1e-5)
