"""Human figure in a glTF file: colours, textures, morph targets, joints."""

import io
import json
import struct
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from kinesic.body.robot import Robot
from kinesic.face.assets.action_units import compute_gaze_rotation, read_intensities
from kinesic.face.assets.body import load_figure
from kinesic.face.assets.chart import compute_vertex_chart
from kinesic.face.assets.mesh import MESH_PARTS
from kinesic.face.assets.paint import COMPLEXIONS, EYE_HALF_WIDTH, paint_skin
from kinesic.face.assets.rig import FRAME_INDICES
from kinesic.report.gltf.scene import KEY_FRAME_RATE, SceneMotion, is_scene, save_performed, write_scene
from kinesic.report.gltf.skin_pictures import screen_colours
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

HAIRLINE_RANGE = (-0.06, 0.12)  # heights in the chart between which skin becomes hair
HEM_HALF_WIDTH = 0.04  # [m] width of the texture of clothes on each side of a border
TEXTURE_SIZE = 512  # [pixels] width and height of the skin texture
FIGURE = load_figure()
MESH = FIGURE.mesh
GAZE_UNITS = {"61": 0.5, "63": 0.4}  # action units: eyes to the left and up
COMPONENT_TYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
ACCESSOR_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class GltfScene:
    """JSON tables and binary values of a glTF file."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        (length,) = struct.unpack("<I", data[12:16])
        self.tables, self.block = json.loads(data[20 : 20 + length]), data[28 + length :]

    def view(self, index: int) -> bytes:
        view = self.tables["bufferViews"][index]
        return self.block[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]

    def values(self, index: int) -> np.ndarray:
        """Return the values (n, width) of an accessor, also of a sparse one."""
        accessor = self.tables["accessors"][index]
        shape = accessor["count"], ACCESSOR_WIDTHS[accessor["type"]]
        result = np.zeros(shape)
        kind = COMPONENT_TYPES[accessor["componentType"]]
        if "bufferView" in accessor:
            result[:] = np.frombuffer(self.view(accessor["bufferView"]), kind, shape[0] * shape[1]).reshape(shape)
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            index_kind = COMPONENT_TYPES[sparse["indices"]["componentType"]]
            places = np.frombuffer(self.view(sparse["indices"]["bufferView"]), index_kind, sparse["count"])
            moved = np.frombuffer(self.view(sparse["values"]["bufferView"]), kind, sparse["count"] * shape[1])
            result[places] = moved.reshape(-1, shape[1])
        return result

    def primitives(self, mesh: str, material: str) -> list[dict]:
        (result,) = [table for table in self.tables["meshes"] if table["name"] == mesh]
        return [item for item in result["primitives"] if self.material(item)["name"] == material]

    def material(self, primitive: dict) -> dict:
        return self.tables["materials"][primitive["material"]]

    def attribute(self, primitive: dict, name: str) -> np.ndarray:
        return self.values(primitive["attributes"][name])

    def picture(self, primitive: dict) -> Image.Image:
        texture = self.material(primitive)["pbrMetallicRoughness"]["baseColorTexture"]["index"]
        image = self.tables["images"][self.tables["textures"][texture]["source"]]
        return Image.open(io.BytesIO(self.view(image["bufferView"])))

    def rotations(self, name: str) -> np.ndarray:
        """Return the rotations (m, 3, 3) of a node in the animation."""
        (animation,) = self.tables["animations"]
        node = [table["name"] for table in self.tables["nodes"]].index(name)
        (channel,) = [item for item in animation["channels"] if item["target"] == {"node": node, "path": "rotation"}]
        return Rotation.from_quat(self.values(animation["samplers"][channel["sampler"]]["output"])).as_matrix()


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> GltfScene:
    human = Robot.load("human")
    angles = np.repeat(human.skeleton.rest[None], 2, axis=0)
    path = tmp_path_factory.mktemp("scene") / "human.glb"
    write_scene(human, SceneMotion(np.arange(2) / KEY_FRAME_RATE, angles, [{}, GAZE_UNITS]), path)
    return GltfScene(path)


def vertices_of(scene: GltfScene, primitive: dict, *parts: str) -> np.ndarray:
    """Return the mesh vertices that a primitive contains."""
    drawn = MESH.positions + MESH.normals(MESH.positions) * FIGURE.hair[:, None]
    candidates = np.flatnonzero(np.isin(MESH.parts, [MESH_PARTS.index(part) for part in parts]))
    distances, result = cKDTree(drawn[candidates]).query(scene.attribute(primitive, "POSITION"))
    assert distances.max() < 1e-6
    return candidates[result]


def test_linear_colours_of_gltf_textures_are_converted_to_srgb() -> None:
    linear = np.array([-1.0, 0.0, 0.001, 0.0031307, 0.0031309, 0.01, 0.5, 1.0, 2.0])
    expected = [0.0, 0.0, 0.01292, 0.04045, 0.04045, 0.09985, 0.73536, 1.0, 1.0]
    np.testing.assert_allclose(screen_colours(linear), expected, atol=2e-5)


def test_gltf_scene_of_the_human_has_face_body_and_hair_nodes_beside_the_skeleton(scene: GltfScene) -> None:
    shown = [scene.tables["nodes"][node] for node in scene.tables["scenes"][0]["nodes"]]
    assert [node["name"] for node in shown] == ["human", "face", "body", "hair"]
    assert all("skin" in node for node in shown[1:])


@pytest.mark.parametrize(
    ("mesh", "name", "colour", "roughness"),
    [
        ("face", "skin", [1, 1, 1, 1], 0.55),
        ("face", "eyes", [1, 1, 1, 1], 0.15),
        ("face", "teeth", [0.68, 0.63, 0.55, 1], 0.6),
        ("face", "tongue", [0.42, 0.12, 0.11, 1], 0.6),
        ("face", "lashes", [0.02, 0.014, 0.012, 1], 0.6),
        ("hands and clothes", "skin", [1, 1, 1, 1], 0.55),
    ],
)
def test_gltf_materials_are_opaque_and_not_metallic(
    scene: GltfScene, mesh: str, name: str, colour: list[float], roughness: float
) -> None:
    (primitive,) = scene.primitives(mesh, name)
    material = scene.material(primitive)
    look = material["pbrMetallicRoughness"]
    assert look["baseColorFactor"] == pytest.approx(colour)
    assert look["metallicFactor"] == 0.0
    assert look["roughnessFactor"] == roughness
    assert "alphaMode" not in material
    assert ("baseColorTexture" in look) == (name in ("skin", "eyes"))


def test_gltf_skin_texture_is_the_vertically_flipped_skin_painting(scene: GltfScene) -> None:
    (primitive,) = scene.primitives("face", "skin")
    picture = scene.picture(primitive)
    assert picture.format == "JPEG"
    assert picture.size == (TEXTURE_SIZE, TEXTURE_SIZE)
    painted = np.asarray(paint_skin(COMPLEXIONS["female"]))[:, :, :3]
    side = len(painted) // TEXTURE_SIZE
    expected = 255 * screen_colours(painted[::-1][side // 2 :: side, side // 2 :: side])
    assert np.abs(np.asarray(picture, dtype=float) - expected).mean() < 4.0


def test_gltf_texture_of_clothes_is_transparent_beyond_their_border(scene: GltfScene) -> None:
    cloth = scene.primitives("hands and clothes", "cloth")
    assert len(cloth) > 1
    for primitive in cloth:
        material = scene.material(primitive)
        assert (material["alphaMode"], material["alphaCutoff"], material["doubleSided"]) == ("MASK", 0.5, True)
        assert material["pbrMetallicRoughness"]["roughnessFactor"] == 0.95
        own = vertices_of(scene, primitive, "cloth")
        across = scene.attribute(primitive, "TEXCOORD_0")
        np.testing.assert_allclose(
            across[:, 0], np.clip(0.5 + MESH.tips[own] / (2 * HEM_HALF_WIDTH), 0.0, 1.0), atol=1e-6
        )
        np.testing.assert_allclose(across[:, 1], 0.5, atol=1e-6)
    picture = np.asarray(scene.picture(cloth[0]))
    assert (picture[:, :64, 3] == 255).all()
    assert (picture[:, 64:, 3] == 0).all()
    seam = round(0.007 / HEM_HALF_WIDTH * 64)  # pixels
    assert (picture[:, : 64 - seam - 1, :3] == 255).all()
    assert (picture[:, 64 - seam + 1 : 64, :3] == 225).all()


def test_gltf_clothes_have_the_colours_of_the_human_figure(scene: GltfScene) -> None:
    for primitive in scene.primitives("hands and clothes", "cloth"):
        own = vertices_of(scene, primitive, "cloth")
        colour = scene.material(primitive)["pbrMetallicRoughness"]["baseColorFactor"]
        np.testing.assert_allclose(MESH.plain[own[0]][:3] ** 2, colour[:3], atol=1e-6)
        assert colour[3] == 1.0


def test_gltf_locks_of_hair_follow_the_head(scene: GltfScene) -> None:
    (primitive,) = scene.primitives("hair", "hair")
    np.testing.assert_allclose(scene.attribute(primitive, "POSITION"), FIGURE.locks.positions, atol=1e-6)
    joints, weights = (scene.attribute(primitive, name) for name in ("JOINTS_0", "WEIGHTS_0"))
    assert (joints[:, 0] == FRAME_INDICES["skullbase"]).all()
    assert (weights == [255, 0, 0, 0]).all()
    assert scene.material(primitive)["doubleSided"]
    base = scene.material(primitive)["pbrMetallicRoughness"]["baseColorFactor"][:3]
    assert max(base) < 0.2, "hair is dark, also where colours of vertices are ignored"
    colours = scene.attribute(primitive, "COLOR_0") * base
    roots = FIGURE.locks.places[:, 1] == 0.0
    assert colours[roots].mean() < 0.7 * colours[~roots].mean()


def test_gltf_jaw_blend_shape_turns_normals_of_the_skin_but_not_of_the_eyes(scene: GltfScene) -> None:
    (primitive,) = scene.primitives("face", "skin")
    own, shape = vertices_of(scene, primitive, "skin"), MESH.shapes.index("jawOpen")
    moves = MESH.deltas[:, [shape]].toarray().reshape(-1, 3)
    turned = scene.attribute(primitive, "NORMAL") + scene.values(primitive["targets"][shape]["NORMAL"])
    expected = MESH.normals(MESH.positions + moves)[own]
    np.testing.assert_allclose(turned, expected, atol=0.005)
    assert np.abs(expected - MESH.normals(MESH.positions)[own]).max() > 0.3
    (eyes,) = scene.primitives("face", "eyes")
    assert all(not scene.values(target["NORMAL"]).any() for target in eyes["targets"])


def test_hair_colour_of_the_gltf_skin_begins_at_the_hairline(scene: GltfScene) -> None:
    (primitive,) = scene.primitives("face", "skin")
    own = vertices_of(scene, primitive, "skin")
    height = compute_vertex_chart(MESH)[own, 3]
    colours = scene.attribute(primitive, "COLOR_0")
    hair = np.clip(np.asarray(COMPLEXIONS["female"].hair) / COMPLEXIONS["female"].skin, 0.0, 1.0)
    np.testing.assert_allclose(colours[height <= HAIRLINE_RANGE[0]], 1.0, atol=1e-6)
    bald = height >= HAIRLINE_RANGE[1]
    assert bald.any()
    np.testing.assert_allclose(colours[bald], np.broadcast_to(hair, colours[bald].shape), atol=1e-6)
    between = (height > HAIRLINE_RANGE[0]) & (height < HAIRLINE_RANGE[1])
    share = (height[between] - HAIRLINE_RANGE[0]) / (HAIRLINE_RANGE[1] - HAIRLINE_RANGE[0])
    result = ((1.0 - colours[between]) / (1.0 - hair)).mean(axis=1)
    assert between.sum() > 20
    np.testing.assert_allclose(result, share, atol=0.1)  # smooth at both ends
    assert (result[share < 0.45] < share[share < 0.45]).all()
    assert (result[share > 0.55] > share[share > 0.55]).all()


def test_iris_is_in_the_middle_of_the_gltf_eye_texture(scene: GltfScene) -> None:
    (primitive,) = scene.primitives("face", "eyes")
    chart = compute_vertex_chart(MESH)[vertices_of(scene, primitive, "eyes"), :2]
    across = scene.attribute(primitive, "TEXCOORD_0")
    np.testing.assert_allclose((across[:, 0] - 0.5) * 2 * EYE_HALF_WIDTH, chart[:, 0], atol=1e-5)
    np.testing.assert_allclose((0.5 - across[:, 1]) * 2 * EYE_HALF_WIDTH, chart[:, 1], atol=1e-5)  # from the top


def test_gltf_texture_coordinates_of_the_skin_are_inside_its_texture(scene: GltfScene) -> None:
    for mesh in ("face", "hands and clothes"):
        (primitive,) = scene.primitives(mesh, "skin")
        across = scene.attribute(primitive, "TEXCOORD_0")
        assert across.min() >= 0.0
        assert across.max() <= 1.0
    (primitive,) = scene.primitives("face", "skin")
    assert scene.attribute(primitive, "TEXCOORD_0").std(axis=0).min() > 0.05


def test_gltf_morph_targets_move_only_vertices_of_their_blend_shape(scene: GltfScene) -> None:
    (face,) = [mesh for mesh in scene.tables["meshes"] if mesh["name"] == "face"]
    deltas = MESH.deltas.tocsc()
    for part in ("skin", "teeth", "tongue"):
        (primitive,) = scene.primitives("face", part)
        own = vertices_of(scene, primitive, part)
        for shape in (face["extras"]["targetNames"].index("jawOpen"), 0):
            expected = deltas[:, [shape]].toarray().reshape(-1, 3)[own]
            index = primitive["targets"][shape]["POSITION"]
            np.testing.assert_allclose(scene.values(index), expected, atol=1e-6)
            count = scene.tables["accessors"][index].get("sparse", {"count": 0})["count"]
            assert count == (np.abs(expected).max(axis=1) > 0.0).sum()
    assert face["weights"] == [0.0] * len(MESH.shapes)


def test_gltf_body_mesh_has_no_morph_targets(scene: GltfScene) -> None:
    for name in ("skin", "cloth"):
        assert all("targets" not in primitive for primitive in scene.primitives("hands and clothes", name))


def test_each_gltf_eyeball_follows_its_own_joint(scene: GltfScene) -> None:
    (primitive,) = scene.primitives("face", "eyes")
    joints = scene.attribute(primitive, "JOINTS_0")
    is_left = scene.attribute(primitive, "POSITION")[:, 1] > 0.0
    assert (joints[is_left, 0] == len(FRAME_INDICES)).all()
    assert (joints[~is_left, 0] == len(FRAME_INDICES) + 1).all()
    (skin,) = scene.tables["skins"]
    names = [scene.tables["nodes"][node]["name"] for node in skin["joints"][-2:]]
    assert names == ["l_eyeball", "r_eyeball"]


def test_gltf_eyeballs_turn_with_the_gaze(scene: GltfScene) -> None:
    for number, name in enumerate(("l_eyeball", "r_eyeball")):
        straight, turned = scene.rotations(name)
        np.testing.assert_allclose(straight, np.eye(3), atol=1e-6)
        np.testing.assert_allclose(turned, compute_gaze_rotation(read_intensities(GAZE_UNITS), number), atol=1e-6)
        assert np.abs(turned - np.eye(3)).max() > 0.1


def test_gltf_of_a_performance_shows_the_measured_motion(tmp_path: Path) -> None:
    bml = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="1"/></bml>'
    planned = plan(bml, set_up())
    skeleton = planned.setup.robot.skeleton
    times = np.linspace(0.0, 1.0, 201)
    angles = np.repeat(skeleton.rest[None], len(times), axis=0)
    turned = skeleton.names.index("vc7_left_right") if "vc7_left_right" in skeleton.names else 0
    angles[:, turned] += 0.2 * times
    performance = SimpleNamespace(measured=SimpleNamespace(times=times, angles=angles), plan=planned, duration=1.0)
    path = save_performed(performance, tmp_path / "run.glb", force=False)
    assert is_scene(path)
    scene = GltfScene(path)
    expected = skeleton.frames(angles[[0, 100, 200]])
    for k, (parent, _, _) in enumerate(skeleton.steps):
        if parent < 0:
            continue
        local = expected.rotations[:, parent].transpose(0, 2, 1) @ expected.rotations[:, k]
        result = scene.rotations(skeleton.segments[k].name)
        np.testing.assert_allclose(result[[0, round(KEY_FRAME_RATE / 2), -1]], local, atol=1e-5)


def test_only_files_with_suffix_glb_are_recognised_as_gltf_scenes() -> None:
    assert is_scene(Path("a/run.GLB"))
    assert not is_scene(Path("run.gltf"))
    assert not is_scene(None)


def test_only_gltf_materials_of_clothes_and_hair_are_double_sided(scene: GltfScene) -> None:
    assert {material["name"] for material in scene.tables["materials"] if material.get("doubleSided")} == {
        "cloth",
        "hair",
    }
    for material in scene.tables["materials"]:
        assert material["pbrMetallicRoughness"]["metallicFactor"] == 0.0
