"""Drawn robot face in glTF scenes, compared with the face in films."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.report.gltf.scene import SceneMotion, write_scene
from kinesic.sim.filming.drawn_face import DESIGN_SIZE, build_strips, read_controls
from kinesic.sim.filming.face_screen import build_face_screen

from .test_scene import read, values

ROBOT = Robot.load()
SHOWN_FACES = ({"12": 1.0, "6": 0.6, "26": 0.4}, {"L45": 1.0, "61": 0.7, "4": 0.5})


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict, bytes]:
    return write(tmp_path_factory.mktemp("face") / "face.glb", ROBOT, SHOWN_FACES)


def write(path: Path, robot: Robot, faces: tuple[dict[str, float], ...]) -> tuple[dict, bytes]:
    angles = np.repeat(robot.skeleton.rest[None], len(faces), axis=0)
    write_scene(robot, SceneMotion(np.arange(len(faces)) / 30.0, angles, faces), path)
    return read(path)


def moves(tables: dict, block: bytes, index: int) -> np.ndarray:
    """Return the displacements (n, 3) [m] of a sparse accessor."""
    accessor = tables["accessors"][index]
    result = np.zeros((accessor["count"], 3))
    if "sparse" in accessor:
        views, sparse = tables["bufferViews"], accessor["sparse"]
        begin, count = views[sparse["indices"]["bufferView"]]["byteOffset"], sparse["count"]
        places = np.frombuffer(block, "<u4", count, begin)
        begin = views[sparse["values"]["bufferView"]]["byteOffset"]
        result[places] = np.frombuffer(block, "<f4", 3 * count, begin).reshape(-1, 3)
    return result


def test_gltf_morph_targets_show_the_same_face_as_the_film(scene: tuple[dict, bytes]):
    tables, block = scene
    (face,) = [mesh for mesh in tables["meshes"] if mesh["name"] == "face"]
    (animation,) = tables["animations"]
    (channel,) = [c for c in animation["channels"] if c["target"]["path"] == "weights"]
    shown = values(tables, block, animation["samplers"][channel["sampler"]]["output"]).reshape(len(SHOWN_FACES), -1)
    assert ((shown >= -1e-6) & (shown <= 1.0 + 1e-6)).all()
    assert len(face["extras"]["targetNames"]) == shown.shape[1] == len(face["weights"])
    screen = build_face_screen(ROBOT)
    assert screen is not None
    for units, weights in zip((*SHOWN_FACES, {}), (*shown, np.array(face["weights"])), strict=True):
        strips = build_strips(read_controls(units))
        assert len(strips) == len(face["primitives"])
        for strip, primitive in zip(strips, face["primitives"], strict=True):
            drawn = values(tables, block, primitive["attributes"]["POSITION"])
            targets = [moves(tables, block, target["POSITION"]) for target in primitive["targets"]]
            drawn = drawn + np.einsum("s,svj->vj", weights, np.array(targets))
            expected, _ = screen.surface.place(strip.rows.reshape(-1, 2) / np.array(DESIGN_SIZE))
            away = np.linalg.norm(drawn - expected, axis=1)
            assert 1e-4 < away.min() < away.max() < 0.003


def test_gltf_face_and_screen_are_children_of_the_head(scene: tuple[dict, bytes]):
    tables, _ = scene
    (head,) = [node for node in tables["nodes"] if node["name"] == "skullbase"]
    assert {tables["nodes"][child]["name"] for child in head["children"]} == {"screen", "face"}


def test_gltf_face_without_motion_has_no_morph_targets(tmp_path: Path):
    tables, _ = write(tmp_path / "still.glb", ROBOT, ({}, {}))
    (face,) = [mesh for mesh in tables["meshes"] if mesh["name"] == "face"]
    assert all("targets" not in primitive for primitive in face["primitives"])
    assert "weights" not in face
    assert {channel["target"]["path"] for channel in tables["animations"][0]["channels"]} == {"rotation"}


def test_gltf_of_a_robot_without_a_screen_has_no_face(tmp_path: Path):
    blind = replace(ROBOT, sites={name: site for name, site in ROBOT.sites.items() if name != "eyes"})
    tables, _ = write(tmp_path / "blind.glb", blind, ({}, {}))
    assert "face" not in {mesh["name"] for mesh in tables["meshes"]}
