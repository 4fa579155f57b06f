"""Scene output of `kinesic perform --out scene.glb`."""

import json

import numpy as np
import pytest

from kinesic.body.robot import Robot

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
TO_GLTF = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # y up, z forward


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    scene_folder = tmp_path_factory.mktemp("scenes")
    (scene_folder / "nod.bml").write_bytes(NOD)
    return scene_folder


def test_perform_command_writes_a_gltf_scene(trimesh, kinesic_in, folder):
    ended = kinesic_in(folder, "perform", "nod.bml", "--out", "nod.glb", "--idle", "0", "--variation", "0")
    assert ended.code == 0, ended.err
    assert ended.out.splitlines()[-1] == "scene: nod.glb"
    assert "checks pass" in ended.out
    assert sorted(path.name for path in folder.iterdir()) == ["nod.bml", "nod.glb"]
    skeleton = Robot.load("upper22").skeleton
    wrist_pose, _ = trimesh.load(folder / "nod.glb").graph.get("l_wrist")
    at_rest = skeleton.frames(skeleton.rest).origins[skeleton.segment("l_wrist")]
    np.testing.assert_allclose(wrist_pose[:3, 3], TO_GLTF @ at_rest, atol=2e-3)


def test_gltf_scene_is_replaced_only_with_force(kinesic_in, folder):
    (folder / "there.glb").write_bytes(b"mine")
    ended = kinesic_in(folder, "perform", "nod.bml", "--out", "there.glb")
    assert ended.code == 2
    assert "--force" in ended.err
    assert (folder / "there.glb").read_bytes() == b"mine"
    ended = kinesic_in(folder, "perform", "nod.bml", "--out", "there.glb", "--force", "--json")
    assert ended.code == 0
    assert json.loads(ended.out)["ok"]
    assert (folder / "there.glb").read_bytes().startswith(b"glTF")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--on", "twin,face"), "a scene shows the twin alone"),
        (("--robot", "upper22,human"), "a scene has one robot"),
    ],
)
def test_options_unsupported_by_gltf_scenes_are_refused(kinesic_in, folder, options, message: str):
    ended = kinesic_in(folder, "perform", "nod.bml", "--out", "no.glb", *options)
    assert ended.code == 2
    assert message in ended.err
    assert not (folder / "no.glb").exists()


def test_say_writes_a_gltf_scene(kinesic_in, folder):
    ended = kinesic_in(folder, "say", "Yes.", "--out", "yes.glb")
    assert ended.code == 0, ended.err
    assert (folder / "yes.glb").read_bytes().startswith(b"glTF")
