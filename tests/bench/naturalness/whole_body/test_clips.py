import numpy as np
import pytest

from kinesic.bench.blocks import find_corpus
from kinesic.bench.naturalness import CAPTURE_FOLDER
from kinesic.bench.naturalness.whole_body.clips import UnreadClip, performance_name, read_clips, set_name
from kinesic.bench.naturalness.whole_body.measures import measure_whole_body
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.body.config import ConfigError

from ..clips import write_clip, write_skeleton

TIMES = np.arange(0.0, 3.0001, 1 / 30)


@pytest.fixture
def folder(tmp_path):
    """Write a clip of an actor leaning back with a raised arm."""
    path = write_skeleton(tmp_path / "skeletons")
    head = "joint JtSkullA { offset 0 0.2 0 channel Quat }"
    path.write_text(path.read_text().replace("joint JtShoulderLf", f"{head}\n    joint JtShoulderLf", 1))
    shape = 0.5 - 0.5 * np.cos(2 * np.pi * TIMES / 3.0)
    motion = {
        "JtSpineC Quat": np.radians(10.0) * np.outer(shape, [-1.0, 0.0, 0.0]),
        "JtShoulderRt Quat": np.outer(shape, [0.0, 1.0, 0.0]),
    }
    write_clip(tmp_path / "Some" / "motions" / "ChrTest@Idle01_BeatRt01.skm", motion)
    return tmp_path


def test_captured_clip_is_read_with_the_z_axis_upwards_and_the_name_of_its_set(folder):
    (motion,) = read_clips(folder)
    assert isinstance(motion, BodyMotion)
    assert (motion.set_name, motion.performance) == ("Some", "Idle01_Beat")
    assert motion.arm == pytest.approx(0.5)
    assert motion.shoulders[:, 0, 1] - motion.chest[0, 1] == pytest.approx([0.15, -0.15])
    assert motion.wrists[:, 0] - motion.shoulders[:, 0] == pytest.approx(np.array([[0, 0, -0.5]] * 2), abs=1e-6)
    measures = measure_whole_body(motion)
    assert measures.trunk == pytest.approx(10.0, rel=0.01)
    assert measures.head == pytest.approx(10.0, rel=0.01)  # the chest carries the head
    assert motion.chest_rotations[45] @ [0.0, 0.0, 1.0] == pytest.approx([-np.sin(np.radians(10)), 0, 0.985], abs=2e-3)


def test_captured_clip_without_a_head_is_reported(folder):
    path = folder / "skeletons" / "ChrTest.sk"
    path.write_text(path.read_text().replace("JtSkullA", "JtOther"))
    (clip,) = read_clips(folder)
    assert isinstance(clip, UnreadClip)
    assert "known names" in clip.why


def test_missing_folder_of_captured_clips_is_rejected(tmp_path):
    with pytest.raises(ConfigError, match="no such folder"):
        list(read_clips(tmp_path / "nowhere"))


@pytest.mark.parametrize(
    ("name", "performance"),
    [
        ("A@Idle01_BeatHighLf02", "Idle01_BeatHigh"),
        ("A@Idle01_OfferBoth01", "Idle01_Offer"),
        ("we_intense2", "we"),
        ("we2", "we"),
        ("Fluid_gesture", "Fluid_gesture"),
    ],
)
def test_performance_name_omits_the_side_and_number_of_a_clip(tmp_path, name, performance):
    assert performance_name(tmp_path / f"{name}.skm") == performance


def test_bvh_clips_without_gestures_have_a_set_of_their_own(tmp_path):
    assert set_name(tmp_path / "catch_Center.bvh") == "bvh other"
    assert set_name(tmp_path / "Fluid_gesture.bvh") == "bvh gestures"


@pytest.mark.soak
def test_all_bvh_files_of_the_corpus_are_read():
    corpus = find_corpus()
    if corpus is None or not (corpus / CAPTURE_FOLDER / "bvh").is_dir():
        pytest.skip("no captured gestures (KINESIC_CORPUS)")
    clips = list(read_clips(corpus / CAPTURE_FOLDER / "bvh"))
    assert len(clips) == 9
    for clip in clips:
        assert isinstance(clip, BodyMotion)
        assert 0.4 < clip.arm < 0.7
        assert (clip.wrists[:, 0, 2] < clip.shoulders[:, 0, 2]).all()  # nobody begins in a T-pose
