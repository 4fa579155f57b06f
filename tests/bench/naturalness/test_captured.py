import numpy as np
import pytest

from kinesic.bench import naturalness
from kinesic.bench.blocks import corpus_folder
from kinesic.bench.naturalness import CAPTURE, bench_clips
from kinesic.bench.naturalness.captured import BETWEEN, captured_figures, measure_clips, smoothed
from kinesic.body.config import ConfigError

from .clips import write_clip, write_skeleton

TIMES = np.arange(0.0, 3.0001, 1 / 30)
ARM = 0.5  # [m] of the actor


def raised(share):
    """The right shoulder turns by one radian forward, up to a share of the way."""
    share = np.clip(share, 0.0, 1.0)
    return np.outer(10 * share**3 - 15 * share**4 + 6 * share**5, [0.0, 1.0, 0.0])


@pytest.fixture
def folder(tmp_path):
    """One gesture: up in half a second, aside in half a second, home in a second."""
    write_skeleton(tmp_path / "skeletons")
    aside = raised((TIMES - 1.0) / 0.5)[:, [1, 0, 2]]
    turns = raised((TIMES - 0.5) / 0.5) - raised(TIMES - 2.0)
    motion = {"JtShoulderRt Quat": turns, "JtSpineC Quat": aside, "JtRoot XPos": np.sin(9 * TIMES)[:, None]}
    write_clip(tmp_path / "set" / "ChrTest@Idle01_BeatRt01.skm", motion)
    return tmp_path


def test_the_hand_is_measured_as_the_chest_carries_it(folder):
    (clip,) = measure_clips(folder)
    hand = clip.hand
    assert hand.duration == pytest.approx(3.0)
    assert (hand.stroke_time, hand.hold_time, hand.return_time) == pytest.approx((0.5, 0.5, 1.0), abs=1e-6)
    assert hand.preparation_speed == pytest.approx(
        1.875 / 0.5, rel=0.08
    )  # of an arm that turns by one radian, smoothed
    assert hand.return_speed == pytest.approx(1.875, rel=0.05)
    assert hand.flow == pytest.approx(0.0, abs=0.15)


def test_skeletons_stand_below_the_folder_or_beside_it(folder):
    assert measure_clips(folder / "set") == measure_clips(folder)
    (folder / "skeletons" / "ChrTest.sk").unlink()
    (clip,) = measure_clips(folder)
    assert clip.hand is None
    assert clip.why == "no skeleton ChrTest.sk"


def test_what_cannot_be_read_is_counted_with_its_reason(folder):
    (folder / "set" / "ChrTest@Broken01.skm").write_text("SkMotion\n")
    figures = {figure.name: figure for figure in captured_figures(measure_clips(folder))}
    assert figures["naturalness.captured.clips"].value == 1
    assert figures["naturalness.captured.unread"].value == 1
    assert "ChrTest@Broken01" in figures["naturalness.captured.unread"].why
    assert figures["naturalness.captured.duration"].value == pytest.approx(3.0)


def test_a_skeleton_without_arms_is_no_actor(folder):
    path = folder / "skeletons" / "ChrTest.sk"
    path.write_text(path.read_text().replace("JtWristLf", "JtHandLf"))
    (clip,) = measure_clips(folder)
    assert clip.why.endswith("lacks JtWristLf")


def test_without_marks_a_clip_has_no_phases(folder):
    write_clip(folder / "set" / "ChrTest@Idle01_BeatRt01.skm", {"JtShoulderRt Quat": raised(TIMES)}, marks={})
    (clip,) = measure_clips(folder)
    assert clip.hand.stroke_speed is clip.hand.flow is clip.hand.return_time is None
    assert clip.hand.units == 1


def test_an_actor_who_stands_still_has_no_units(folder):
    write_clip(folder / "set" / "ChrTest@Idle01_BeatRt01.skm", {"JtRoot XPos": np.ones((60, 1))})
    (clip,) = measure_clips(folder)
    assert (clip.hand.units, clip.hand.largest_speed) == (0, 0.0)
    assert clip.hand.sparc is clip.hand.flow is clip.hand.stroke_to_preparation is None


def test_a_folder_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="no such folder"):
        measure_clips(tmp_path / "nowhere")


@pytest.mark.parametrize("name", ["A@Idle03", "A@IdleStand01", "A@Idle02_ToIdle03", "A@Idle01_WeightShift02"])
def test_clips_between_gestures_are_left_out(name):
    assert BETWEEN.search(name)
    assert not BETWEEN.search("A@Idle01_BeatLf01")


def test_smoothing_keeps_what_stands_and_what_goes_evenly():
    line = np.outer(np.arange(9.0), [1.0, 2.0, 3.0])
    assert smoothed(line)[2:-2] == pytest.approx(line[2:-2])
    assert smoothed(np.ones((6, 3))) == pytest.approx(np.ones((6, 3)))
    assert smoothed(np.eye(9)[:, [4]]).ravel()[2:7] * 16 == pytest.approx([1, 4, 6, 4, 1])


@pytest.fixture(scope="module")
def clips():
    """The folder of captured gestures."""
    where = corpus_folder()
    if where is None or not (where / CAPTURE).is_dir():
        pytest.skip("no captured gestures (KINESIC_CORPUS)")
    return where / CAPTURE


@pytest.fixture(scope="module")
def captured(clips):
    """What was measured of all of them."""
    return measure_clips(clips)


# Duration [s], largest speed [arm lengths/s], path [m] and spectral arc length, as another program measured them.
MEASURED = {
    "ChrBrad@Idle01_ArmStretch01": (5.133, 2.177, 1.338, -4.309),
    "ChrBrad@Idle01_BeatHighBt01": (2.8, 2.427, 1.232, -2.539),
    "ChrBrad@Idle01_BeatHighBt02": (3.0, 2.432, 1.255, -2.763),
    "ChrBrad@Idle01_BeatHighLf01": (3.167, 2.956, 1.463, -2.544),
    "ChrGarza@IdleStand01_ChopRt01": (2.667, 3.159, 1.363, -2.271),
}


def test_captured_gestures_are_measured_as_others_do(clips, tmp_path):
    for path in (path for path in clips.rglob("*.sk*") if path.suffix == ".sk" or path.stem in MEASURED):
        (tmp_path / path.name).symlink_to(path)
    hands = {clip.name: clip.hand for clip in measure_clips(tmp_path)}
    assert hands.keys() == MEASURED.keys()
    for name, (duration, speed, path, sparc) in MEASURED.items():
        hand = hands[name]
        assert (hand.duration, hand.largest_speed, hand.path) == pytest.approx((duration, speed, path), rel=0.02)
        assert hand.sparc == pytest.approx(sparc, abs=0.001)
    assert hands["ChrBrad@Idle01_BeatHighBt01"].preparation_sparc == pytest.approx(-1.316, abs=0.001)


@pytest.mark.soak
def test_captured_gestures_are_all_read(captured):
    assert len({clip.name for clip in captured}) == 127
    assert all(clip.hand is not None for clip in captured)


@pytest.mark.soak
def test_figures_of_clips_stand_beside_the_table(captured, monkeypatch, tmp_path):
    monkeypatch.setattr(naturalness, "measure_clips", {tmp_path: captured}.get)
    found = {figure.name: figure for figure in bench_clips(tmp_path)}
    assert found["naturalness.captured.sparc"].value == pytest.approx(-2.59, abs=0.05)
    assert found["naturalness.captured.units"].value == 2.0
    assert found["naturalness.captured.units_per_second"].value == pytest.approx(0.83, abs=0.05)
    assert found["naturalness.captured.return_speed"].value == pytest.approx(1.17, abs=0.05)
    assert "captured 0.12 0.33 0.63 0.87 1.00" in found["naturalness.captured.flow"].why
