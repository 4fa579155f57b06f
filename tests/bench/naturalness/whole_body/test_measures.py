import numpy as np
import pytest

from kinesic.bench.naturalness.whole_body.measures import (
    cut_clips,
    elbow_angles,
    measure_whole_body,
    rotation_angles,
)

from .bodies import ARM, make_body, turn


def test_rotations_of_trunk_and_head_are_measured_in_degrees():
    measures = measure_whole_body(make_body(trunk=6.0, head=12.0, swing=(0.0, 0.2)))
    assert measures.trunk == pytest.approx(6.0, rel=0.01)
    assert measures.head == pytest.approx(12.0, rel=0.01)
    assert measures.trunk_speed == pytest.approx(np.pi * 6.0 / 2.5, rel=0.02)
    assert measures.head_speed == pytest.approx(np.pi * 12.0 / 2.5, rel=0.02)


def test_motion_measures_of_a_still_body_are_zero():
    measures = measure_whole_body(make_body())
    assert (measures.trunk, measures.head) == pytest.approx((0.0, 0.0), abs=1e-5)
    assert measures.free_arm == 0.0
    assert (measures.path, measures.largest_speed, measures.collar) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_free_arm_metric_is_the_path_length_of_the_hand_that_moves_less():
    assert measure_whole_body(make_body(swing=(0.01, 0.2))).free_arm == pytest.approx(0.05, rel=0.01)
    assert measure_whole_body(make_body(swing=(0.2, 0.01))).free_arm == pytest.approx(0.05, rel=0.01)
    assert measure_whole_body(make_body(swing=(0.2, 0.2))).free_arm == pytest.approx(1.0)


def test_collar_displacement_and_path_are_in_arm_lengths():
    measures = measure_whole_body(make_body(lift=0.02, swing=(0.0, 0.2)))
    assert measures.collar == pytest.approx(0.02 / ARM, rel=0.01)
    assert measures.path == pytest.approx(2 * 0.2 / ARM, rel=0.02)
    assert measures.path_metres == pytest.approx(0.4, rel=0.02)


def test_hand_turning_excludes_rotation_with_the_chest():
    alone = measure_whole_body(make_body(turning=90.0, swing=(0.0, 0.2)))
    assert alone.hand_turning == pytest.approx(np.pi * 90.0 / 2.5, rel=0.02)
    carried = make_body(turning=30.0, swing=(0.0, 0.2))
    with_chest = make_body(turning=30.0, swing=(0.0, 0.2))
    object.__setattr__(with_chest, "chest_rotations", carried.hand_rotations[0])
    assert measure_whole_body(with_chest).hand_turning == pytest.approx(0.0, abs=1e-3)


def test_body_size_does_not_change_motion_measures():
    small, large = (measure_whole_body(make_body(scale=s, lift=0.02, swing=(0.02, 0.2))) for s in (0.7, 1.4))
    for name in ("collar", "free_arm", "path", "largest_speed", "elbow_range", "sparc", "stroke_speed", "flow"):
        assert getattr(small, name) == pytest.approx(getattr(large, name))
    assert small.path_metres == pytest.approx(large.path_metres / 2)


def test_elbow_flexion_is_zero_for_a_straight_arm():
    assert elbow_angles(make_body(bend=(0.0, 35.0)))[:, 0] == pytest.approx([0.0, 35.0], abs=1e-3)


@pytest.mark.parametrize("angle", [1e-4, 0.5, 90.0, 179.0])
def test_rotation_angles_are_exact_for_small_and_large_rotations(angle):
    assert rotation_angles(turn("x", angle)) == pytest.approx([angle], rel=1e-6)


def test_gesture_clip_with_sync_points_is_one_clip_from_start_to_end():
    (gesture,) = cut_clips(make_body(swing=(0.0, 0.2)))
    assert (gesture.times[0], gesture.times[-1]) == pytest.approx((0.0, 2.5), abs=1 / 30)
    assert gesture.syncs["end"] == pytest.approx(2.5)


def test_clip_without_sync_points_is_cut_into_moving_windows():
    moving = make_body(seconds=8.4, swing=(0.0, 1.5), syncs={"start": 0.0, "end": 8.4})
    windows = list(cut_clips(moving))
    assert [round(float(window.times[0]), 1) for window in windows] == [0.0, 2.7, 5.4]
    assert len({window.name for window in windows}) == 3
    assert list(cut_clips(make_body(syncs={"start": 0.0, "end": 2.5}))) == []
