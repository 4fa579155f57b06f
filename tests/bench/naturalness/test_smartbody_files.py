import numpy as np
import pytest

from kinesic.bench.naturalness.smartbody_files import joint_positions, read_motion, read_skeleton
from kinesic.body.config import ConfigError
from kinesic.body.rotation import about

from .clips import CHANNELS, MARKS, write_clip, write_skeleton

Z = np.array([0.0, 0.0, 1.0])


@pytest.fixture
def skeleton(tmp_path):
    return read_skeleton(write_skeleton(tmp_path))


def test_a_skeleton_is_a_tree(skeleton):
    parents = {joint.name: joint.parent for joint in skeleton}
    assert parents["JtRoot"] is None
    assert parents["JtSpineC"] == "JtRoot"
    assert parents["JtShoulderLf"] == parents["JtShoulderRt"] == "JtSpineC"
    assert (parents["JtWristRt"], parents["JtElbowRt"]) == ("JtElbowRt", "JtShoulderRt")
    assert len(skeleton) == 8


def test_a_motion_has_frames_and_the_sync_points_of_bml(tmp_path):
    motion = read_motion(write_clip(tmp_path / "a.skm", {"JtRoot XPos": np.arange(5.0)[:, None]}))
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


def test_at_rest_the_arms_hang(skeleton, tmp_path):
    places = joint_positions(skeleton, read_motion(write_clip(tmp_path / "a.skm", {"JtRoot XPos": np.zeros((2, 1))})))
    assert places["JtWristLf"] == pytest.approx(np.array([[0.15, 1.0, 0.0]] * 2))
    assert places["JtElbowRt"] == pytest.approx(np.array([[-0.15, 1.2, 0.0]] * 2))


def test_joints_turn_what_comes_after_them(skeleton, tmp_path):
    """Against matrices that are multiplied one by one, from the root to the wrist."""
    vectors = np.random.default_rng(7).uniform(-1.5, 1.5, (4, 6, 3))
    names = ("JtRoot Quat", "JtSpineC Quat", "JtShoulderLf Quat", "JtElbowLf Quat")
    turns = {name: vectors[k] for k, name in enumerate(names)} | {"JtRoot XPos": np.linspace(0, 1, 6)[:, None]}
    places = joint_positions(skeleton, read_motion(write_clip(tmp_path / "a.skm", turns)))
    for frame in range(6):
        matrices = [about(v / np.linalg.norm(v), np.linalg.norm(v)) for v in vectors[:, frame]]
        chest = matrices[0] @ matrices[1]
        upper = chest @ about(Z, -np.pi / 2) @ matrices[2]
        place = np.array([frame / 5, 1.0, 0.0]) + matrices[0] @ [0, 0.3, 0] + chest @ [0.15, 0.2, 0]
        place = place + upper @ [0.3, 0, 0] + upper @ matrices[3] @ [0.2, 0, 0]
        assert places["JtWristLf"][frame] == pytest.approx(place, abs=1e-6)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("JtSpineC Quat", "JtSpineC Roll"), "JtSpineC Roll"),
        (("channels 7", "channels 6"), "16 numbers"),
        (("kt 0.000000 fr 0.000000000", "kt 0.000000 fr 0.0.0"), "could not convert"),
        (("kt 0.000000 fr 0.000000000", "kt 0.000000 fr nan"), "not finite"),
        (("kt 0.066667", "kt 0.033333"), "order of their times"),
        (("channels 7", "chanels 7"), "no motion"),
        (("kt", "key"), "no motion"),
    ],
)
def test_a_broken_motion_is_refused_with_its_reason(tmp_path, change, said):
    path = write_clip(tmp_path / "a.skm", {"JtRoot XPos": np.zeros((3, 1))})
    path.write_text(path.read_text().replace(*change))
    with pytest.raises(ConfigError, match=said) as raised:
        read_motion(path)
    assert str(raised.value).startswith(str(path))


def test_what_is_no_skeleton_or_not_there_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="No such file"):
        read_skeleton(tmp_path / "b.sk")
    (tmp_path / "b.sk").write_text("skeleton\n")
    with pytest.raises(ConfigError, match="no joints"):
        read_skeleton(tmp_path / "b.sk")
