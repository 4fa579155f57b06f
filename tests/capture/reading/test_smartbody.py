import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.rotation import rotation_about
from kinesic.capture.reading.smartbody import read_motion, read_skeleton
from kinesic.capture.skeleton_motion import joint_positions

from ...bench.naturalness.clips import CHANNELS, MARKS, write_clip, write_skeleton
from .files import load

Z = np.array([0.0, 0.0, 1.0])


@pytest.fixture
def skeleton(tmp_path):
    return load(read_skeleton, write_skeleton(tmp_path))


def test_smartbody_skeleton_file_gives_each_joint_its_parent(skeleton):
    parents = {joint.name: joint.parent for joint in skeleton}
    assert parents["JtRoot"] is None
    assert parents["JtSpineC"] == "JtRoot"
    assert parents["JtShoulderLf"] == parents["JtShoulderRt"] == "JtSpineC"
    assert (parents["JtWristRt"], parents["JtElbowRt"]) == ("JtElbowRt", "JtShoulderRt")
    assert len(skeleton) == 8


def test_smartbody_motion_file_gives_frames_and_bml_sync_points(tmp_path):
    motion = load(read_motion, write_clip(tmp_path / "a.skm", {"JtRoot XPos": np.arange(5.0)[:, None]}))
    assert motion.times == pytest.approx(np.arange(5) / 30, abs=1e-6)
    assert motion.frames.shape == (5, 1 + 3 * (len(CHANNELS) - 1))
    assert motion.frames[:, motion.columns["JtRoot", "XPos"]].ravel().tolist() == [0, 1, 2, 3, 4]
    assert motion.syncs == {
        "ready": MARKS["ready"],
        "strokeStart": MARKS["strokeStart"],
        "stroke": MARKS["emphasis"],
        "strokeEnd": MARKS["stroke"],
        "relax": MARKS["relax"],
    }


def test_arms_of_a_smartbody_skeleton_without_rotations_hang_at_the_sides(skeleton, tmp_path):
    positions = joint_positions(
        skeleton, load(read_motion, write_clip(tmp_path / "a.skm", {"JtRoot XPos": np.zeros((2, 1))}))
    )
    assert positions["JtWristLf"] == pytest.approx(np.array([[0.15, 1.0, 0.0]] * 2))
    assert positions["JtElbowRt"] == pytest.approx(np.array([[-0.15, 1.2, 0.0]] * 2))


def test_smartbody_joint_rotations_move_all_child_joints(skeleton, tmp_path):
    """Compare with the product of all joint matrices from root to wrist."""
    vectors = np.random.default_rng(7).uniform(-1.5, 1.5, (4, 6, 3))
    names = ("JtRoot Quat", "JtSpineC Quat", "JtShoulderLf Quat", "JtElbowLf Quat")
    turns = {name: vectors[k] for k, name in enumerate(names)} | {"JtRoot XPos": np.linspace(0, 1, 6)[:, None]}
    positions = joint_positions(skeleton, load(read_motion, write_clip(tmp_path / "a.skm", turns)))
    for frame in range(6):
        matrices = [rotation_about(v / np.linalg.norm(v), np.linalg.norm(v)) for v in vectors[:, frame]]
        chest = matrices[0] @ matrices[1]
        upper = chest @ rotation_about(Z, -np.pi / 2) @ matrices[2]
        position = np.array([frame / 5, 1.0, 0.0]) + matrices[0] @ [0, 0.3, 0] + chest @ [0.15, 0.2, 0]
        position = position + upper @ [0.3, 0, 0] + upper @ matrices[3] @ [0.2, 0, 0]
        assert positions["JtWristLf"][frame] == pytest.approx(position, abs=1e-6)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (("JtSpineC Quat", "JtSpineC Roll"), "JtSpineC Roll"),
        (("channels 7", "channels 6"), "16 numbers"),
        (("kt 0.000000 fr 0.000000000", "kt 0.000000 fr 0.0.0"), "could not convert"),
        (("kt 0.000000 fr 0.000000000", "kt 0.000000 fr nan"), "not finite"),
        (("kt 0.066667", "kt 0.033333"), "order of time"),
        (("channels 7", "chanels 7"), "not a motion"),
        (("kt", "key"), "0 frames"),
    ],
)
def test_broken_smartbody_motion_is_rejected_with_path_and_reason(tmp_path, change, reason):
    path = write_clip(tmp_path / "a.skm", {"JtRoot XPos": np.zeros((3, 1))})
    path.write_text(path.read_text().replace(*change))
    with pytest.raises(ConfigError, match=reason) as raised:
        load(read_motion, path)
    assert str(raised.value).startswith(str(path))


def test_missing_or_empty_smartbody_skeleton_is_rejected(tmp_path):
    with pytest.raises(ConfigError, match="No such file"):
        load(read_skeleton, tmp_path / "b.sk")
    (tmp_path / "b.sk").write_text("skeleton\n")
    with pytest.raises(ConfigError, match="no joints"):
        load(read_skeleton, tmp_path / "b.sk")
