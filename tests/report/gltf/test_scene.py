"""glTF scenes read by another library, compared with kinesic's forward kinematics."""

import json
import struct
from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.robot import SIDES, Robot
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.skinning import Skin
from kinesic.report.gltf.scene import (
    KEY_FRAME_RATE,
    SceneMotion,
    key_times,
    save_scene,
    write_scene,
)
from kinesic.report.segment_motion import segment_motions, smooth_quaternions
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.part_colours import PART_COLOURS
from kinesic.sim.shells.shell import load_shell

TO_GLTF = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # y up, z forward
ROBOTS = {name: Robot.load(name) for name in ("upper22", "upper36", "human")}


def wild(robot: Robot, count: int = 3) -> np.ndarray:
    lower, upper = robot.skeleton.lower, robot.skeleton.upper
    return np.random.default_rng(5).uniform(lower, upper, (count, len(lower)))


def written(robot: Robot, angles: np.ndarray, path: Path, units: dict[str, float] | None = None) -> Path:
    faces = [units or {}] * len(angles)
    write_scene(robot, SceneMotion(np.arange(len(angles)) / KEY_FRAME_RATE, angles, faces), path)
    return path


def read(path: Path) -> tuple[dict, bytes]:
    data = path.read_bytes()
    (length,) = struct.unpack("<I", data[12:16])
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def values(tables: dict, block: bytes, index: int) -> np.ndarray:
    accessor = tables["accessors"][index]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
    kind = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
    result = np.zeros(accessor["count"] * width, dtype=kind)
    if "bufferView" in accessor:
        offset = tables["bufferViews"][accessor["bufferView"]]["byteOffset"]
        result = np.frombuffer(block, kind, len(result), offset)
    return result.reshape(-1, width).astype(float)


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_segment_poses_read_by_another_gltf_library_equal_forward_kinematics(
    trimesh: ModuleType, robot: Robot, tmp_path: Path
):
    angles = wild(robot, 1)
    scene = trimesh.load(written(robot, angles, tmp_path / "robot.glb"))
    stand = robot.skeleton.frames(angles[0])
    for k, segment in enumerate(robot.skeleton.segments):
        result, _ = scene.graph.get(segment.name)
        np.testing.assert_allclose(result[:3, 3], TO_GLTF @ stand.origins[k], atol=1e-6)
        np.testing.assert_allclose(result[:3, :3], TO_GLTF @ stand.rotations[k], atol=1e-6)


@pytest.mark.parametrize("name", ["upper22", "upper36"])
def test_shell_meshes_are_read_by_another_gltf_library(trimesh: ModuleType, name: str, tmp_path: Path):
    robot = ROBOTS[name]
    shell = load_shell(robot)
    assert shell is not None
    scene = trimesh.load(written(robot, robot.skeleton.rest[None], tmp_path / "robot.glb"))
    hands = {side: {robot.arm(side).segments[-1], *robot.fingers(side)} for side in SIDES}
    parts = {name: next((side for side in SIDES if name in hands[side]), "body") for name in shell.segments}
    counts = Counter[str]()
    for name, surface in shell.segments.items():
        counts.update({parts[name]: len(surface.shell), "joint": len(surface.joint)})
    assert min(counts.values()) > 500
    meshes = [mesh for mesh in scene.geometry.values() if mesh.visual.material.name != "face"]
    results = {tuple(mesh.visual.material.baseColorFactor): 0 for mesh in meshes}
    for mesh in meshes:
        results[tuple(mesh.visual.material.baseColorFactor)] += len(mesh.faces)
    assert sorted(results.values()) == sorted(counts.values()), "hands have colours of their own"
    np.testing.assert_allclose(scene.extents[1], 0.62 + 0.5, atol=0.15)  # y is up


def test_capsules_of_a_robot_without_shell_are_read_by_another_gltf_library(trimesh: ModuleType, tmp_path: Path):
    robot = replace(ROBOTS["upper22"], path=tmp_path / "robot.toml")
    scene = trimesh.load(written(robot, robot.skeleton.rest[None], tmp_path / "robot.glb"))
    head = next(segment for segment in robot.skeleton.segments if segment.name == "skullbase").capsules[0]
    shape = trimesh.Trimesh(scene.geometry["skullbase"].vertices, scene.geometry["skullbase"].faces)
    assert shape.is_watertight
    assert shape.volume == pytest.approx(np.pi * head.radius**2 * (0.04 + 4 / 3 * head.radius), rel=0.06)
    np.testing.assert_allclose(scene.extents[1], 0.62 + 0.5, atol=0.15)  # y is up


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_gltf_animation_reproduces_each_posture_of_the_motion(trimesh: ModuleType, robot: Robot, tmp_path: Path):
    angles = wild(robot)
    tables, block = read(written(robot, angles, tmp_path / "robot.glb"))
    (animation,) = tables["animations"]
    names = {node["name"]: k for k, node in enumerate(tables["nodes"])}
    moved = {
        (c["target"]["node"], c["target"]["path"]): animation["samplers"][c["sampler"]] for c in animation["channels"]
    }
    parents = {child: k for k, node in enumerate(tables["nodes"]) for child in node.get("children", [])}

    def place(node: int, frame: int) -> tuple[np.ndarray, np.ndarray]:
        own = tables["nodes"][node]
        turn = own.get("rotation", [0, 0, 0, 1])
        if (node, "rotation") in moved:
            turn = values(tables, block, moved[node, "rotation"]["output"])[frame]
        way = np.array(own.get("translation", [0, 0, 0]))
        local = trimesh.transformations.quaternion_matrix(np.roll(turn, 1))[:3, :3]
        if node not in parents:
            return local, way
        rotation, origin = place(parents[node], frame)
        return rotation @ local, origin + rotation @ way

    stand = robot.skeleton.frames(angles)
    for k, segment in enumerate(robot.skeleton.segments):
        for frame in range(len(angles)):
            rotation, origin = place(names[segment.name], frame)
            np.testing.assert_allclose(rotation, TO_GLTF @ stand.rotations[frame, k], atol=1e-5)
            np.testing.assert_allclose(origin, TO_GLTF @ stand.origins[frame, k], atol=1e-5)
    times = values(tables, block, next(iter(moved.values()))["input"])
    np.testing.assert_allclose(times.ravel(), np.arange(len(angles)) / KEY_FRAME_RATE, atol=1e-6)


def test_gltf_skin_moves_like_the_rendered_skin(trimesh: ModuleType, tmp_path: Path):
    """Compute vertices from the file's joints, inverse bind matrices and weights."""
    human, figure = ROBOTS["human"], load_figure()
    angles = wild(human, 1)
    path = written(human, angles, tmp_path / "human.glb")
    tables, block = read(path)
    graph = trimesh.load(path).graph
    (skin,) = tables["skins"]
    bound = values(tables, block, skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
    joints = np.array([graph.get(tables["nodes"][node]["name"])[0] for node in skin["joints"]]) @ bound
    (body,) = [mesh for mesh in tables["meshes"] if mesh["name"] == "hands and clothes"]
    rest, seen = [], []
    for primitive in body["primitives"]:
        read_in = {name: values(tables, block, index) for name, index in primitive["attributes"].items()}
        weights = np.concatenate([read_in["WEIGHTS_0"], read_in["WEIGHTS_1"]], axis=1) / 255.0
        np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-9)
        places = np.concatenate([read_in["JOINTS_0"], read_in["JOINTS_1"]], axis=1).astype(int)
        mixed = np.einsum("vk,vkij->vij", weights, joints[places])
        rest.append(read_in["POSITION"])
        seen.append(np.einsum("vij,vj->vi", mixed[:, :3, :3], read_in["POSITION"]) + mixed[:, :3, 3])
    drawn = Skin(figure, human.skeleton).move_skin(figure.mesh.positions, angles[0]) @ TO_GLTF.T
    where = {tuple(np.round(point, 5)): k for k, point in enumerate(figure.mesh.positions.astype("f4").astype(float))}
    known = [(where[key], k) for k, key in enumerate(map(tuple, np.round(np.concatenate(rest), 5))) if key in where]
    own, theirs = np.array(known).T
    assert len(own) > 5000
    np.testing.assert_allclose(np.concatenate(seen)[theirs], drawn[own], atol=2e-5)


def test_gltf_face_has_morph_targets(tmp_path: Path):
    human = ROBOTS["human"]
    tables, block = read(written(human, human.skeleton.rest[None], tmp_path / "human.glb", {"26": 1.0}))
    (face,) = [mesh for mesh in tables["meshes"] if mesh["name"] == "face"]
    names = face["extras"]["targetNames"]
    assert {len(primitive["targets"]) for primitive in face["primitives"]} == {len(names)}
    (animation,) = tables["animations"]
    (weights,) = [c for c in animation["channels"] if c["target"]["path"] == "weights"]
    shown = values(tables, block, animation["samplers"][weights["sampler"]]["output"]).ravel()
    assert {name for name, weight in zip(names, shown, strict=True) if weight} == {"jawOpen"}


def test_quaternions_exported_to_gltf_have_no_sign_jumps():
    turns = np.linspace(0.0, 4 * np.pi, 50)
    rotations = np.array([[[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]] for t in turns])
    result = smooth_quaternions(rotations)
    assert (np.einsum("mi,mi->m", result[1:], result[:-1]) > 0.9).all()


def test_gltf_animation_of_a_plan_lasts_as_long_as_the_plan(tmp_path: Path):
    bml = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="1"/></bml>'
    planned = plan(bml, set_up())
    tables, block = read(save_scene(planned, tmp_path / "nod.glb", force=False))
    last = values(tables, block, tables["animations"][0]["samplers"][0]["input"]).max()
    assert last == pytest.approx(planned.duration, abs=1e-5)
    assert tables["asset"]["generator"].startswith("kinesic ")


@pytest.mark.parametrize("duration", [11.2, 0.01, 1 / 30, 1.0, 2.0333334, 100 / 30 + 1e-9])
def test_gltf_key_frame_times_are_distinct_and_end_with_the_motion(duration: float):
    times = key_times(duration).astype("f4")
    assert times[0] == 0.0
    assert times[-1] == np.float32(duration)
    assert (np.diff(times) > 1e-4).all()
    assert (np.diff(times) < 1.02 / KEY_FRAME_RATE).all()


def test_gltf_node_of_a_segment_with_an_offset_joint_axis_is_translated(tmp_path: Path):
    robot, tilt = ROBOTS["upper22"], ROBOTS["upper22"].joints("neck")[1]
    hinges = [
        replace(hinge, at=sealed([0.0, 0.0, 0.02])) if k == tilt else hinge
        for k, hinge in enumerate(robot.skeleton.hinges)
    ]
    offset = replace(robot, skeleton=replace(robot.skeleton, hinges=tuple(hinges)))
    angles = wild(offset)
    tables, block = read(written(offset, angles, tmp_path / "offset.glb"))
    (animation,) = tables["animations"]
    translated = {
        tables["nodes"][channel["target"]["node"]]["name"]: animation["samplers"][channel["sampler"]]["output"]
        for channel in animation["channels"]
        if channel["target"]["path"] == "translation"
    }
    head = hinges[tilt].segment
    assert set(translated) == {head}
    (expected,) = (
        motion.translations
        for motion in segment_motions(offset, angles)
        if offset.skeleton.segments[motion.segment].name == head
    )
    np.testing.assert_allclose(values(tables, block, translated[head]), expected, atol=1e-6)


@pytest.mark.parametrize("name", ["upper22", "human"])
def test_gltf_nodes_stand_in_the_first_posture_without_the_animation(name: str, tmp_path: Path):
    robot = ROBOTS[name]
    angles = wild(robot)
    tables, block = read(written(robot, angles, tmp_path / "robot.glb"))
    (animation,) = tables["animations"]
    for channel in animation["channels"]:
        path, node = channel["target"]["path"], tables["nodes"][channel["target"]["node"]]
        sampler = animation["samplers"][channel["sampler"]]
        assert sampler["interpolation"] == "LINEAR"
        if path != "weights":
            rows = values(tables, block, sampler["output"])
            np.testing.assert_allclose(node[path], rows[0], atol=1e-6)
    moved = {tables["nodes"][channel["target"]["node"]]["name"] for channel in animation["channels"]}
    assert {segment.name for segment in robot.skeleton.segments[1:]} <= moved
    assert tables["nodes"][0]["name"] == robot.name
    assert animation["name"] == "performance"


def test_gltf_materials_of_the_shell_are_not_metallic_and_have_linear_colours(tmp_path: Path):
    robot = ROBOTS["upper22"]
    tables, _ = read(written(robot, robot.skeleton.rest[None], tmp_path / "robot.glb"))
    looks = [material["pbrMetallicRoughness"] for material in tables["materials"] if material.get("name") != "face"]
    assert all(look["metallicFactor"] == 0.0 for look in looks)
    colours = [look["baseColorFactor"] for look in looks]
    assert colours[:2] == [[0.78, 0.80, 0.83, 1.0], [0.16, 0.19, 0.24, 1.0]]
    for colour, part in zip(colours[2:4], ("l_hand", "r_hand"), strict=True):
        screen = np.array(PART_COLOURS[part])
        expected = np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
        np.testing.assert_allclose(colour, [*expected[:3], screen[3]], atol=1e-9)


def test_gltf_capsules_of_limbs_are_light_and_of_the_trunk_dark(tmp_path: Path):
    robot = replace(ROBOTS["upper22"], path=tmp_path / "robot.toml")
    tables, block = read(written(robot, robot.skeleton.rest[None], tmp_path / "robot.glb"))
    meshes = {
        mesh["name"]: mesh["primitives"][0] for mesh in tables["meshes"] if mesh["name"] not in ("face", "screen")
    }
    assert set(meshes) == {segment.name for segment in robot.skeleton.segments if segment.capsules}
    torso = set(robot.chains["torso"])
    elbow = next(name for name in meshes if "elbow" in name)
    trunk = next(name for name in meshes if name in torso)
    assert (meshes[elbow]["material"], meshes[trunk]["material"]) == (0, 1)
    for primitive in meshes.values():
        lengths = np.linalg.norm(values(tables, block, primitive["attributes"]["NORMAL"]), axis=1)
        np.testing.assert_allclose(lengths, 1.0, atol=1e-5)


def test_gltf_normals_of_the_shell_are_of_unit_length(tmp_path: Path):
    robot = ROBOTS["upper22"]
    tables, block = read(written(robot, robot.skeleton.rest[None], tmp_path / "robot.glb"))
    for mesh in tables["meshes"]:
        for primitive in mesh["primitives"] if mesh["name"] != "face" else ():
            lengths = np.linalg.norm(values(tables, block, primitive["attributes"]["NORMAL"]), axis=1)
            np.testing.assert_allclose(lengths, 1.0, atol=1e-5)
