import numpy as np
import pytest

from kinesic.bench import naturalness
from kinesic.bench.blocks import find_corpus
from kinesic.bench.naturalness import CAPTURE_FOLDER, bench_clips
from kinesic.bench.naturalness.captured import IDLE_CLIPS, captured_metrics, measure_clips, smooth_path
from kinesic.body.config import ConfigError

from .clips import write_clip, write_skeleton

TIMES = np.arange(0.0, 3.0001, 1 / 30)
ARM = 0.5  # [m] arm length of the actor


def raise_arm(fraction):
    """Return a shoulder's rotation vectors in a minimum-jerk raise to one radian."""
    fraction = np.clip(fraction, 0.0, 1.0)
    return np.outer(10 * fraction**3 - 15 * fraction**4 + 6 * fraction**5, [0.0, 1.0, 0.0])


@pytest.fixture
def folder(tmp_path):
    """Write one gesture that moves an arm up, sideways and back."""
    write_skeleton(tmp_path / "skeletons")
    aside = raise_arm((TIMES - 1.0) / 0.5)[:, [1, 0, 2]]
    turns = raise_arm((TIMES - 0.5) / 0.5) - raise_arm(TIMES - 2.0)
    motion = {"JtShoulderRt Quat": turns, "JtSpineC Quat": aside, "JtRoot XPos": np.sin(9 * TIMES)[:, None]}
    write_clip(tmp_path / "set" / "ChrTest@Idle01_BeatRt01.skm", motion)
    return tmp_path


def test_hand_of_a_captured_clip_is_measured_relative_to_the_chest(folder):
    (clip,) = measure_clips(folder)
    hand = clip.hand
    assert hand.duration == pytest.approx(3.0)
    assert (hand.stroke_time, hand.hold_time, hand.return_time) == pytest.approx((0.5, 0.5, 1.0), abs=1e-6)
    assert hand.preparation_speed == pytest.approx(
        1.875 / 0.5, rel=0.08
    )  # of an arm that rotates by one radian, smoothed
    assert hand.return_speed == pytest.approx(1.875, rel=0.05)
    assert hand.flow == pytest.approx(0.0, abs=0.15)


def test_skeleton_files_of_captured_clips_are_found_in_or_next_to_the_clip_folder(folder):
    assert measure_clips(folder / "set") == measure_clips(folder)
    (folder / "skeletons" / "ChrTest.sk").unlink()
    (clip,) = measure_clips(folder)
    assert clip.hand is None
    assert clip.why == "no skeleton ChrTest.sk"


def test_unreadable_captured_clips_are_counted_with_their_reason(folder):
    (folder / "set" / "ChrTest@Broken01.skm").write_text("SkMotion\n")
    metrics = {metric.name: metric for metric in captured_metrics(measure_clips(folder))}
    assert metrics["naturalness.captured.clips"].value == 1
    assert metrics["naturalness.captured.unread"].value == 1
    assert "ChrTest@Broken01" in metrics["naturalness.captured.unread"].why
    assert metrics["naturalness.captured.duration"].value == pytest.approx(3.0)


def test_clip_whose_skeleton_lacks_a_wrist_is_reported_with_the_missing_joint(folder):
    path = folder / "skeletons" / "ChrTest.sk"
    path.write_text(path.read_text().replace("JtWristLf", "JtHandLf"))
    (clip,) = measure_clips(folder)
    assert clip.why.endswith("lacks JtWristLf")


def test_motion_capture_clip_without_sync_points_has_no_gesture_phases(folder):
    write_clip(folder / "set" / "ChrTest@Idle01_BeatRt01.skm", {"JtShoulderRt Quat": raise_arm(TIMES)}, marks={})
    (clip,) = measure_clips(folder)
    assert clip.hand.stroke_speed is clip.hand.flow is clip.hand.return_time is None
    assert clip.hand.units == 1


def test_motionless_actor_has_no_movement_units(folder):
    write_clip(folder / "set" / "ChrTest@Idle01_BeatRt01.skm", {"JtRoot XPos": np.ones((60, 1))})
    (clip,) = measure_clips(folder)
    assert (clip.hand.units, clip.hand.largest_speed) == (0, 0.0)
    assert clip.hand.sparc is clip.hand.flow is clip.hand.stroke_to_preparation is None


def test_missing_folder_of_captured_gestures_is_rejected(tmp_path):
    with pytest.raises(ConfigError, match="no such folder"):
        measure_clips(tmp_path / "nowhere")


@pytest.mark.parametrize("name", ["A@Idle03", "A@IdleStand01", "A@Idle02_ToIdle03", "A@Idle01_WeightShift02"])
def test_idle_clips_of_motion_capture_are_recognised_by_name(name):
    assert IDLE_CLIPS.search(name)
    assert not IDLE_CLIPS.search("A@Idle01_BeatLf01")


def test_smoothing_of_captured_paths_keeps_constant_and_linear_paths():
    line = np.outer(np.arange(9.0), [1.0, 2.0, 3.0])
    assert smooth_path(line)[2:-2] == pytest.approx(line[2:-2])
    assert smooth_path(np.ones((6, 3))) == pytest.approx(np.ones((6, 3)))
    assert smooth_path(np.eye(9)[:, [4]]).ravel()[2:7] * 16 == pytest.approx([1, 4, 6, 4, 1])


@pytest.fixture(scope="module")
def clips():
    """Return the folder of captured gestures."""
    corpus = find_corpus()
    if corpus is None or not (corpus / CAPTURE_FOLDER).is_dir():
        pytest.skip("no captured gestures (KINESIC_CORPUS)")
    return corpus / CAPTURE_FOLDER


@pytest.fixture(scope="module")
def captured(clips):
    """Return measurements of all captured gestures."""
    return measure_clips(clips)


# Duration [s], largest speed [arm lengths/s], path [m] and spectral arc length, measured by another program.
REFERENCE_VALUES = {
    "ChrBrad@Idle01_ArmStretch01": (5.133, 2.177, 1.338, -4.309),
    "ChrBrad@Idle01_BeatHighBt01": (2.8, 2.427, 1.232, -2.539),
    "ChrBrad@Idle01_BeatHighBt02": (3.0, 2.432, 1.255, -2.763),
    "ChrBrad@Idle01_BeatHighLf01": (3.167, 2.956, 1.463, -2.544),
    "ChrGarza@IdleStand01_ChopRt01": (2.667, 3.159, 1.363, -2.271),
}


def test_captured_gestures_match_an_independent_measurement(clips, tmp_path):
    for path in (path for path in clips.rglob("*.sk*") if path.suffix == ".sk" or path.stem in REFERENCE_VALUES):
        (tmp_path / path.name).symlink_to(path)
    hands = {clip.name: clip.hand for clip in measure_clips(tmp_path)}
    assert hands.keys() == REFERENCE_VALUES.keys()
    for name, (duration, speed, path, sparc) in REFERENCE_VALUES.items():
        hand = hands[name]
        assert (hand.duration, hand.largest_speed, hand.path) == pytest.approx((duration, speed, path), rel=0.02)
        assert hand.sparc == pytest.approx(sparc, abs=0.001)
    assert hands["ChrBrad@Idle01_BeatHighBt01"].preparation_sparc == pytest.approx(-1.316, abs=0.001)


@pytest.mark.soak
def test_all_127_motion_capture_clips_of_the_corpus_are_read(captured):
    assert len({clip.name for clip in captured}) == 127
    assert all(clip.hand is not None for clip in captured)


@pytest.mark.soak
def test_motion_capture_metrics_agree_with_the_stored_table(captured, monkeypatch, tmp_path):
    monkeypatch.setattr(naturalness, "measure_clips", {tmp_path: captured}.get)
    metrics = {metric.name: metric for metric in bench_clips(tmp_path)}
    assert metrics["naturalness.captured.sparc"].value == pytest.approx(-2.59, abs=0.05)
    assert metrics["naturalness.captured.units"].value == 2.0
    assert metrics["naturalness.captured.units_per_second"].value == pytest.approx(0.83, abs=0.05)
    assert metrics["naturalness.captured.return_speed"].value == pytest.approx(1.17, abs=0.05)
    assert "captured 0.12 0.33 0.63 0.87 1.00" in metrics["naturalness.captured.flow"].why
