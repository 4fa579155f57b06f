import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinesic.capture.body_directions import clip_of_skeleton
from kinesic.capture.read import read_clip
from kinesic.capture.reading.bvh import read_bvh
from kinesic.capture.reading.gltf import read_gltf
from kinesic.capture.reading.text import CaptureError

from ..clips import bvh, reach
from ..gltf_files import GltfFile, moving_person, person, quaternions

AHEAD, LEFT, UP = np.eye(3)


def no_buffer(uri: str) -> bytes:
    raise AssertionError(uri)


def clip_of(data: bytes):
    joints, motion, _ = read_gltf(data, "a.glb", no_buffer)
    return clip_of_skeleton(joints, motion, "a.glb")


def left_wrists(file: GltfFile) -> np.ndarray:
    return clip_of(file.binary()).arms["l"].wrist


@pytest.mark.parametrize("kind", ["binary", "text"])
def test_gltf_and_bvh_of_the_same_motion_give_the_same_arm_paths(kind):
    """Compare glTF samples at 60 Hz with BVH frames at 30 Hz."""
    file, expected = moving_person(reach(20)), clip_of_skeleton(*read_bvh(bvh(reach(20)), "a.bvh"), "a.bvh")
    clip = clip_of(getattr(file, kind)())
    assert clip.times[::2] == pytest.approx(expected.times)
    for side in "lr":
        assert clip.arms[side].wrist[::2] == pytest.approx(expected.arms[side].wrist, abs=1e-5)
        assert clip.arms[side].elbow[::2] == pytest.approx(expected.arms[side].elbow, abs=1e-5)


def test_animated_rotation_replaces_the_static_rotation_of_a_gltf_node():
    nodes = person()
    arm = next(node for node in nodes if node["name"] == "LeftArm")
    arm["rotation"] = quaternions([[50.0, 20.0, -30.0]])[0].tolist()
    assert left_wrists(moving_person({"LeftArm": np.zeros((3, 3))}, nodes=nodes))[0] == pytest.approx(LEFT, abs=1e-6)


def test_gltf_node_without_animation_keeps_its_static_rotation():
    nodes = person()
    arm = next(node for node in nodes if node["name"] == "LeftArm")
    arm["rotation"] = quaternions([[90.0, 0.0, 0.0]])[0].tolist()
    assert left_wrists(moving_person({"Head": np.zeros((3, 3))}, nodes=nodes))[0] == pytest.approx(UP, abs=1e-6)


def test_matrix_of_a_gltf_node_gives_its_position_and_rotation():
    nodes = person()
    arm = next(node for node in nodes if node["name"] == "LeftArm")
    matrix = np.eye(4)
    matrix[:3, :3] = 2.0 * Rotation.from_euler("z", 90, degrees=True).as_matrix()
    matrix[:3, 3] = arm.pop("translation")
    arm["matrix"] = matrix.T.ravel().tolist()
    assert left_wrists(moving_person({"Head": np.zeros((3, 3))}, nodes=nodes))[0] == pytest.approx(UP, abs=1e-6)


def test_linear_gltf_rotations_have_constant_speed_along_the_shorter_arc():
    """Negate the second quaternion, which describes the same rotation."""
    quaternion = quaternions([[0.0, 0.0, 0.0], [90.0, 0.0, 0.0]]) * [[1.0], [-1.0]]
    wrists = left_wrists(GltfFile().animate("LeftArm", [0.0, 1.0], quaternion))
    raised = np.degrees(np.arctan2(wrists[:, 2], wrists[:, 1]))
    assert raised == pytest.approx(np.linspace(0.0, 90.0, 61), abs=1e-3)


def test_gltf_step_interpolation_holds_each_rotation_until_the_next_key():
    rotations = {"LeftArm": np.array([[0.0, 0, 0], [90, 0, 0], [0, 0, 0]])}
    wrists = left_wrists(moving_person(rotations, period=0.5, interpolation="STEP"))
    assert wrists[29] == pytest.approx(LEFT, abs=1e-6)
    assert wrists[30] == pytest.approx(UP, abs=1e-6)
    assert wrists[59] == pytest.approx(UP, abs=1e-6)
    assert wrists[60] == pytest.approx(LEFT, abs=1e-6)


def test_gltf_cubic_spline_follows_the_slopes_at_its_keys():
    """Use a translation t^3 - t of the hips, a cubic polynomial."""
    keys = [[[0.0, 0, 0], [0, 90, 0], [-1, 0, 0]], [[11.0, 0, 0], [6, 90, 0], [0, 0, 0]]]
    file = GltfFile().animate(
        "Hips", [0.0, 2.0], np.reshape(keys, (-1, 3)), path="translation", interpolation="CUBICSPLINE"
    )
    joints, motion, _ = read_gltf(file.binary(), "a.glb", no_buffer)
    column = motion.frames[:, motion.columns["Hips", "XPos"]][:, 0]
    assert column / 0.01 == pytest.approx(motion.times**3 - motion.times, abs=1e-5)
    assert clip_of_skeleton(joints, motion, "a").arms["l"].wrist[30] == pytest.approx(LEFT, abs=1e-6)


def test_gltf_rotations_in_normalised_integers_are_read():
    """Allow an error of the integers' resolution, 1 / 32767."""
    expected = left_wrists(moving_person(reach(10)))
    assert left_wrists(moving_person(reach(10), dtype="<i2")) == pytest.approx(expected, abs=2e-4)


def test_gltf_buffer_file_is_read_inside_the_folder_of_the_gltf_file_and_refused_outside(tmp_path):
    file, folder = moving_person(reach(5)), tmp_path / "inside"
    folder.mkdir()
    (folder / "the data.bin").write_bytes(file.data)
    (folder / "a.gltf").write_bytes(file.text("the%20data.bin"))
    assert len(read_clip(folder / "a.gltf").times) == 9
    (tmp_path / "b.bin").write_bytes(file.data)
    for uri, problem in (("../b.bin", "outside of the folder"), ("c.bin", "No such file"), ("%00", "null")):
        (folder / "a.gltf").write_bytes(file.text(uri))
        with pytest.raises(CaptureError, match=rf"a.gltf: buffer .*{problem}"):
            read_clip(folder / "a.gltf")


def test_unread_further_animations_of_a_gltf_file_are_reported():
    file = moving_person(reach(5))
    file.json["animations"].append({"name": "nod", "channels": [], "samplers": []})
    assert read_gltf(file.binary(), "a.glb", no_buffer)[2] == ("first of 2 animations: 'wave'",)


def changed(**parts) -> bytes:
    file = moving_person(reach(5))
    file.json.update(parts)
    return file.binary()


def changed_accessor(**parts) -> bytes:
    file = moving_person(reach(5))
    file.json["accessors"][1].update(parts)
    return file.binary()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"{", "not glTF"),
        (b"glTF", "no JSON chunk"),
        (moving_person(reach(5)).binary()[:-4], r"ends within a chunk of \d+ bytes"),
        (changed(animations=[]), "no animation"),
        (GltfFile().binary(), "moves no joint"),
        (changed(nodes=[{"children": [0]}]), "own ancestor"),
        (changed(nodes=[{"children": [9]}]), r"child 9 of nodes\[0\] does not exist"),
        (changed(nodes=[{"children": [2]}, {"children": [2]}, {}]), r"nodes\[2\] has two parents"),
        (changed(nodes=[{"rotation": [0, 0, 0, 0]}]), r"nodes\[0\]: its rotation is a quaternion of zero length"),
        (changed(nodes=[{"matrix": [0.0] * 16}]), r"nodes\[0\]: its matrix is mirrored or singular"),
        (changed(nodes=[{"matrix": [0.0] * 15}]), r"nodes\[0\]: its matrix has 15 numbers; it needs 16"),
        (changed_accessor(count=6), r"accessors\[1\]: 6 elements from byte \d+ are outside"),
        (changed_accessor(count=4), "rotation of 'LeftArm' needs increasing times with a value for each"),
        (changed_accessor(type="VEC3"), r"accessors\[1\]: it must be a dense array of VEC4"),
        (changed_accessor(sparse={"count": 1}), r"accessors\[1\]: it must be a dense array"),
        (changed_accessor(bufferView=99), r"accessors\[1\]: bufferView 99 does not exist"),
        (changed_accessor(byteOffset=-8), "from byte"),
        (GltfFile().animate("LeftArm", [0.0, 1.0], np.zeros((2, 4))).binary(), "quaternion of zero length"),
        (GltfFile().animate("LeftArm", [0.0, np.nan], np.ones((2, 4))).binary(), "not finite"),
        (GltfFile().animate("LeftArm", [1.0, 0.0], np.ones((2, 4))).binary(), "increasing times"),
        (GltfFile().animate("LeftArm", [0.0, 1e9], np.ones((2, 4))).binary(), "it has 200001 frames"),
        (GltfFile().animate("LeftArm", [0.0], np.ones((1, 4))).binary(), "it has 1 frames"),
    ],
)
def test_invalid_gltf_is_rejected(data, message):
    with pytest.raises(CaptureError, match=message):
        clip_of(data)
