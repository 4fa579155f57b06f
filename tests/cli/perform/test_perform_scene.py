"""`kinesic perform --out scene.glb`."""

import json

import numpy as np
import pytest

from kinesic.body.robot import Robot

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
TO_GLTF = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # y up, z forward


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("scenes")
    (made / "nod.bml").write_bytes(NOD)
    return made


def test_the_performance_of_the_twin_is_a_scene(trimesh, kinesic_in, folder):
    ended = kinesic_in(folder, "perform", "nod.bml", "--out", "nod.glb", "--idle", "0")
    assert ended.code == 0, ended.err
    assert ended.out.splitlines()[-1] == "scene: nod.glb"
    assert "checks pass" in ended.out
    assert sorted(path.name for path in folder.iterdir()) == ["nod.bml", "nod.glb"]
    skeleton = Robot.load("upper22").skeleton
    place, _ = trimesh.load(folder / "nod.glb").graph.get("l_wrist")
    at_rest = skeleton.frames(skeleton.rest).origins[skeleton.segment("l_wrist")]
    np.testing.assert_allclose(place[:3, 3], TO_GLTF @ at_rest, atol=2e-3)


def test_a_scene_is_not_replaced_unasked_and_json_tells_the_report(kinesic_in, folder):
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
    ("given", "message"),
    [
        (("--on", "twin,face"), "a scene shows the twin alone"),
        (("--robot", "upper22,human"), "a scene has one robot"),
    ],
)
def test_what_a_scene_cannot_show_is_bad_input(kinesic_in, folder, given, message: str):
    ended = kinesic_in(folder, "perform", "nod.bml", "--out", "no.glb", *given)
    assert ended.code == 2
    assert message in ended.err
    assert not (folder / "no.glb").exists()


def test_a_text_is_said_into_a_scene(kinesic_in, folder):
    ended = kinesic_in(folder, "say", "Yes.", "--out", "yes.glb")
    assert ended.code == 0, ended.err
    assert (folder / "yes.glb").read_bytes().startswith(b"glTF")
