import numpy as np
import pytest

from kinesic.face.assets import bake_body
from kinesic.face.assets.rig import FRAME_INDICES, SKINNING_FRAMES

STRIP_FACES = np.array([[k, k + 1, k + 12, k + 11] for k in range(10)])  # 10 squares in a row


def strip_weights(split: int) -> dict[str, np.ndarray]:
    chest = np.array([float(k % 11 < split) for k in range(22)])
    return {"vl5": chest, "l_shoulder": 1.0 - chest, "l_wrist": np.zeros(22)}


def test_skinning_weight_smoothing_keeps_sums_and_blurs_borders():
    parts = strip_weights(5)
    parts["l_wrist"][:] = 0.5
    bake_body._smooth_weights(parts, STRIP_FACES)
    np.testing.assert_allclose(parts["vl5"] + parts["l_shoulder"], 1.0)
    np.testing.assert_array_equal(parts["l_wrist"], 0.5)
    assert 0.2 < parts["vl5"][5] < 0.5
    assert (np.diff(parts["vl5"][:11]) <= 1e-12).all()


def test_shared_skinning_weights_move_to_the_half_way_frame_of_a_joint():
    parts = {"a": np.array([1.0, 0.5, 0.0, 0.2]), "b": np.array([0.0, 0.0, 0.0, 0.2]), "c": np.array([0, 0.5, 1, 0.4])}
    bake_body._split_joint_weights(parts, ("a", "b"), "c")
    np.testing.assert_allclose(parts["a"], [1.0, 0.25, 0.0, 0.1])
    np.testing.assert_allclose(parts["c_half"], [0.0, 0.5, 0.0, 0.4])
    np.testing.assert_allclose(sum(parts.values()), [1.0, 1.0, 1.0, 0.8])


def test_strongest_skinning_weights_per_vertex_are_kept_and_normalised():
    frames = np.random.default_rng(1).uniform(size=(50, 62)) ** 8
    places, weights = bake_body._select_strongest(frames)
    assert (weights.sum(axis=1) == 255).all()
    assert (places[:, 0] == frames.argmax(axis=1)).all()


def test_straight_hanging_arm_has_zero_bind_angles():
    down = {"shoulder": 0.0, "elbow": -0.3, "wrist": -0.6}
    centres = {f"l_{name}": np.array([0.0, 0.2, z]) for name, z in down.items()}
    centres["l_wrist"] = centres["l_wrist"] + (1e-6, 0.0, 0.0)  # slightly bent, so that the elbow has an axis
    for k, finger in enumerate(("index", "middle", "ring", "pinky")):
        for j in (1, 2, 3, 4):  # bent by 0.3 rad at the knuckle
            bone = 0.03 * (j - 1) * np.array([0.0, -np.sin(0.3), -np.cos(0.3)])
            centres[f"l_{finger}{j}"] = np.array([0.03 - 0.02 * k, 0.2, -0.7]) + bone
    actual = bake_body._compute_bind_angles(centres)
    arm = {name: angle for name, angle in actual.items() if name[2:].startswith(("shoulder", "elbow", "wrist"))}
    assert len(arm) == 14
    assert max(abs(angle) for angle in arm.values()) < 0.01
    assert actual["r_index_flexion1"] == actual["l_index_flexion1"] == pytest.approx(0.3)
    assert actual["l_ring_abduct"] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(("bone", "part"), [("finger2-3", "index3"), ("head", "skullbase"), ("metacarpal2", "wrist")])
def test_bones_of_the_source_mesh_are_mapped_to_skeleton_segments(bone: str, part: str):
    parts = bake_body._merge_bones({f"{bone}.L": np.array([2.0]), "root": np.array([2.0])})
    assert parts[part if part == "skullbase" else f"l_{part}"].tolist() == [0.5]


def test_all_62_skinning_frames_have_unique_names():
    assert len(FRAME_INDICES) == len(SKINNING_FRAMES) == 62
