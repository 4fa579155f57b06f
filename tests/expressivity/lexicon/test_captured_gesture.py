"""Captured gestures in the lexicon: files, keys and performance."""

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.capture.certification import correlate
from kinesic.capture.robot_motion import arm_paths
from kinesic.expressivity.lexicon.captured_form import nearest_shape
from kinesic.expressivity.lexicon.gesture_motion import pack_motion, read_gesture_motion
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.space import CAPTURED_REACH, pull_within_reach
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import plan_gesture

from .captured_clips import MARKERS, TIMES, motion, write_gesture


def arrays(**changes) -> bytes:
    """Return a motion file with changed arrays, without arrays set to None."""
    with np.load(BytesIO(pack_motion(motion()))) as file:
        values = {**file, **changes}
    data = BytesIO()
    np.savez(data, **{name: value for name, value in values.items() if value is not None})
    return data.getvalue()


def test_motion_file_of_a_captured_gesture_returns_all_written_arrays(tmp_path):
    (tmp_path / "a.npz").write_bytes(pack_motion(motion(sides="lr")))
    read = read_gesture_motion(tmp_path, "a.npz")
    assert read.hands.keys() == {"l", "r"}
    for name in ("wrist", "swivel", "pointing", "palm", "straight"):
        np.testing.assert_allclose(getattr(read.hands["l"], name), getattr(motion().hands["r"], name), atol=1e-6)


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"times": None}, "times"),
        ({"times": TIMES[::-1]}, "increase"),
        ({"times": np.full(len(TIMES), np.nan)}, "increase"),
        ({"times": np.arange(2.0)}, "2 samples"),
        ({"right_wrist": None}, "no array left_wrist"),
        ({"right_wrist": np.zeros((3, 3))}, "shape"),
        ({"right_wrist": np.full((len(TIMES), 3), 1e9)}, "beyond 5"),
        ({"right_palm": np.zeros((len(TIMES), 3))}, "length than 1"),
        ({"head": np.full((len(TIMES), 3), np.nan)}, "beyond"),
        ({"right_straight": np.full((len(TIMES), 5), 2.0)}, "beyond 1"),
    ],
)
def test_invalid_motion_file_of_a_captured_gesture_is_refused(tmp_path, changes, problem):
    (tmp_path / "a.npz").write_bytes(arrays(**changes))
    with pytest.raises(ConfigError, match=problem):
        read_gesture_motion(tmp_path, "a.npz")


def test_motion_file_of_a_gesture_outside_the_lexicon_folder_is_refused(tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "a.npz").write_bytes(pack_motion(motion()))
    with pytest.raises(ConfigError, match="outside"):
        read_gesture_motion(inner, "../a.npz")
    with pytest.raises(ConfigError):
        read_gesture_motion(inner, "missing.npz")


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"stroke": 0.1}, "increase"),
        ({"end": 9.0}, "lasts"),
        ({"other": 1.0}, "markers must be"),
        ({"start": float("nan")}, "nan"),
    ],
)
def test_invalid_markers_of_a_captured_gesture_are_refused(tmp_path, changes, problem):
    write_gesture(tmp_path, markers={**MARKERS, **changes})
    with pytest.raises(ConfigError, match=problem):
        Lexicon.load(tmp_path)


def test_captured_gesture_of_a_hand_missing_in_its_motion_file_is_refused(tmp_path):
    write_gesture(tmp_path, hand="both", data=pack_motion(motion(sides="r")))
    with pytest.raises(ConfigError, match="no motion of hand 'l'"):
        Lexicon.load(tmp_path)


def test_captured_gesture_has_keys_at_its_markers_and_follows_the_captured_path(tmp_path):
    form = Lexicon.load(write_gesture(tmp_path)).forms_by_id["swing"]
    assert form.sides == {"r"}
    assert form.shapes == ("open",)
    wrist = motion().hands["r"].wrist
    for key, name in zip(form.keys, ("strokeStart", "stroke", "strokeEnd"), strict=True):
        np.testing.assert_allclose(key.hands["r"].position, wrist[round(MARKERS[name] / 0.02)], atol=2e-3)
    start, stroke = form.keys[0].hands["r"], form.keys[1].hands["r"]
    assert stroke.path.course.duration == pytest.approx(0.6)
    half = stroke.path.at(start.position, stroke.position, np.array([0.5]))[0]
    np.testing.assert_allclose(half, wrist[round(0.7 / 0.02)], atol=2e-3)


def test_captured_hands_that_would_meet_on_a_robot_are_moved_apart_over_the_whole_path(tmp_path):
    close = motion(sides="lr", shift=-0.28)
    form = Lexicon.load(write_gesture(tmp_path, hand="both", data=pack_motion(close))).forms_by_id["swing"]
    for key in form.keys[1:]:
        for side in "lr":
            assert min(key.hands[side].position[1], key.hands[side].path.points[:, 1].min()) > 0.09


def test_captured_position_beyond_the_reach_of_a_robot_moves_towards_its_shoulder():
    robot = set_up("upper22").robot
    near, far = np.array([0.5, 0.3, 0.2]), np.array([1.2, 0.4, 0.5])
    assert pull_within_reach(near, robot) is near
    shoulder = pull_within_reach(1e9 * far, robot) - CAPTURED_REACH * far / np.linalg.norm(far)
    assert np.linalg.norm(pull_within_reach(far, robot) - shoulder) == pytest.approx(CAPTURED_REACH, abs=1e-6)


def test_captured_gesture_is_performed_on_its_path_in_its_time(tmp_path):
    setup = set_up("upper22", lexicon=write_gesture(tmp_path))
    form = setup.lexicon.forms_by_id["swing"]
    plan = plan_gesture(form, setup)
    times = {sync.sync: sync.planned for sync in plan.syncs}
    assert times["stroke"] == pytest.approx(2.0, abs=1e-3)
    assert times["stroke"] - times["strokeStart"] == pytest.approx(0.6, abs=0.02)
    assert times["strokeEnd"] - times["stroke"] == pytest.approx(0.4, abs=0.02)
    source = np.arange(MARKERS["strokeStart"], MARKERS["strokeEnd"], 0.02)
    angles = plan.trajectory.angles(plan.trajectory.zero + source - MARKERS["stroke"] + times["stroke"])
    wrist = np.stack([np.interp(source, TIMES, column) for column in motion().hands["r"].wrist.T], axis=1)
    assert correlate(wrist * [1, -1, 1], arm_paths(setup.robot, angles)["r"].wrist) > 0.98
    fast = plan_gesture(form, replace(setup, style=setup.style.changed(["temporal=1"])))
    quick = {sync.sync: sync.planned for sync in fast.syncs}
    assert quick["stroke"] - quick["strokeStart"] < 0.95 * (times["stroke"] - times["strokeStart"])
    wide = plan_gesture(form, replace(setup, style=setup.style.changed(["spatial=1"])))

    def extent(planned):
        paths = arm_paths(setup.robot, planned.trajectory.angles(np.arange(1.4, 2.4, 0.02) + planned.trajectory.zero))
        return np.ptp(paths["r"].wrist[:, 1])

    assert extent(wide) > 1.1 * extent(plan)


def test_lexicon_gesture_with_both_keys_and_a_motion_file_is_refused(tmp_path):
    write_gesture(tmp_path)
    text = (
        (tmp_path / "swing.toml").read_text().replace('says = "captured"', "keys = [{ right = { at = [0, 0, 0.5] } }]")
    )
    (tmp_path / "swing.toml").write_text(text)
    with pytest.raises(ConfigError, match="keys and a motion"):
        Lexicon.load(tmp_path)


def test_captured_fingers_select_a_special_hand_shape_only_if_they_differ_clearly_from_relaxed_ones():
    assert nearest_shape(np.array([0.8, 0.8, 0.8, 0.75, 0.7])) == "relaxed"
    assert nearest_shape(np.array([0.7, 0.9, 0.1, 0.05, 0.0])) in ("index", "pistol")
    assert nearest_shape(np.zeros(5)) == "fist"
    assert not hand_shapes()[nearest_shape(np.array([0.5, 0.6, 0.6, 0.6, 0.6]))].meets
