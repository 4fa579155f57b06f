import numpy as np
import pytest

from kinesic.bml.block import Gesture
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.action_units import MAX_EYE_CONVERGENCE, MAX_EYE_DEPRESSION, MAX_EYE_ELEVATION, MAX_EYE_YAW
from kinesic.expressivity.face.eyes import (
    GAZE_LEAD_TIME,
    SACCADE_SPREAD,
    GazeDirection,
    Habits,
    block_gazes,
    direction_angles,
    eye_angles,
    gaze_units,
    gesture_gazes,
    saccade_offsets,
    vergence_units,
)
from kinesic.expressivity.keyframes import BodyMove, Turn

SAMPLE_TIMES = np.arange(0.0, 10.0, 0.005)
HEAD_AHEAD = np.zeros((len(SAMPLE_TIMES), 2))
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def test_eyes_reach_the_gaze_target_before_the_head_and_stay_on_it():
    look = GazeDirection(2.0, 0.5, 0.1, 6.0)
    head = np.stack([np.interp(SAMPLE_TIMES, [2.1, 2.8, 6.0, 6.7], [0.0, 0.5, 0.5, 0.0]), 0.0 * SAMPLE_TIMES], axis=1)
    eyes = eye_angles([look], SAMPLE_TIMES, head)
    gaze = eyes + head
    fixed = (SAMPLE_TIMES > 2.15) & (SAMPLE_TIMES < 5.99)
    np.testing.assert_allclose(gaze[fixed], np.tile([0.5, 0.1], (fixed.sum(), 1)), atol=1e-12)
    np.testing.assert_array_equal(eyes[SAMPLE_TIMES <= 2.0], 0.0)
    np.testing.assert_array_equal(eyes[SAMPLE_TIMES > 6.2], 0.0)


def test_eyes_return_from_a_later_gaze_to_the_permanent_gaze():
    eyes = eye_angles([GazeDirection(1.0, 0.2, 0.0), GazeDirection(3.0, -0.3, 0.0, 5.0)], SAMPLE_TIMES, HEAD_AHEAD)
    for time, left in ((2.0, 0.2), (4.0, -0.3), (8.0, 0.2)):
        assert eyes[np.searchsorted(SAMPLE_TIMES, time), 0] == pytest.approx(left)


def test_saccades_are_small_and_reproducible_by_seed():
    strayed = saccade_offsets((0.0, 10.0), SAMPLE_TIMES, 4)
    assert 0.0 < np.abs(strayed).max() <= 2 * SACCADE_SPREAD + 1e-12
    np.testing.assert_array_equal(strayed, saccade_offsets((0.0, 10.0), SAMPLE_TIMES, 4))
    assert np.any(strayed != saccade_offsets((0.0, 10.0), SAMPLE_TIMES, 5))
    assert np.mean(np.abs(np.diff(strayed[:, 0])) > 0.0) < 0.2  # Eyes rest for most of the time


def test_eye_angles_become_clipped_action_units():
    units = gaze_units(
        np.array([[MAX_EYE_YAW, MAX_EYE_ELEVATION / 2], [-MAX_EYE_YAW / 2, -MAX_EYE_DEPRESSION], [9.0, -9.0]])
    )
    np.testing.assert_allclose(units["61"], [1.0, 0.0, 1.0])
    np.testing.assert_allclose(units["62"], [0.0, 0.5, 0.0])
    np.testing.assert_allclose(units["63"], [0.5, 0.0, 0.0])
    np.testing.assert_allclose(units["64"], [0.0, 1.0, 1.0])


def test_eyes_return_after_a_gaze_but_not_after_a_gaze_shift(context):
    inside = (
        '<gaze id="g" target="thing" start="1" ready="1.4" relax="3" end="3.5"/>'
        '<gazeShift id="h" target="other" start="4" end="4.5"/><gaze id="i" target="nowhere" start="6"/>'
    )
    timeline = schedule(parse(BML_TEMPLATE.format(inside)), {}, {})
    targets = {"thing": np.array([1.0, 1.0, 1.2]), "other": np.array([2.0, -1.0, 0.6])}
    here = context(timeline.block, targets=targets)
    early_gazes = [look for look in block_gazes(timeline, here) if look.start < 5.0]
    assert [look.start for look in early_gazes] == [1.0, 4.0]
    assert early_gazes[0].left > 0.3
    assert early_gazes[0].end == 3.0
    assert early_gazes[1].left < -0.2
    assert early_gazes[1].up < 0.0
    assert early_gazes[1].end == np.inf


def test_gaze_angles_are_positive_to_the_left_and_upward():
    result = direction_angles(np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]]))
    np.testing.assert_allclose(result, [[0.0, 0.0], [np.pi / 4, 0.0], [0.0, np.pi / 4]])
    assert result.shape == (3, 2)
    assert result[1, 0] == pytest.approx(np.pi / 4)


def test_eyes_converge_on_near_targets_and_diverge_again():
    near, far = GazeDirection(1.0, 0.0, 0.0, 3.0, 0.25), GazeDirection(5.0, 0.2, 0.0, away=2.0)
    inward = vergence_units([near, far], SAMPLE_TIMES)["66"] * MAX_EYE_CONVERGENCE
    assert inward[SAMPLE_TIMES < 1.0].max() == 0.0
    np.testing.assert_allclose(inward[(SAMPLE_TIMES > 1.2) & (SAMPLE_TIMES < 3.0)], np.arctan(0.03 / 0.25))
    np.testing.assert_allclose(inward[SAMPLE_TIMES > 5.3], np.arctan(0.03 / 2.0))
    assert np.abs(inward[(SAMPLE_TIMES > 3.3) & (SAMPLE_TIMES < 5.0)]).max() < 1e-12
    assert GazeDirection(0.0, 0.0, 0.0).inward == 0.0


def test_gesture_gaze_starts_with_the_gesture_if_the_head_turns_and_else_before_the_stroke(timeline, phases):
    asked = timeline(("g", Gesture("large"), phases(1.0, 2.0, 2.0, 2.5, 3.0, 3.5, 4.5)))
    seen = Turn(torsion=0.3, tilt=0.2)
    (with_head,), (alone,) = (
        gesture_gazes(asked, {"g": BodyMove(head=head, eyes=seen)}) for head in (Turn(torsion=0.1), Turn())
    )
    assert (with_head.start, with_head.left, with_head.end) == (1.0, 0.3, 3.5)
    assert alone.start == pytest.approx(2.0 - GAZE_LEAD_TIME)


def test_saccades_go_in_all_directions_and_half_as_far_vertically():
    rests = saccade_offsets((0.0, 400.0), np.arange(0.0, 400.0, 0.2), 4)
    left, up = rests.std(axis=0)
    assert np.abs(rests.mean(axis=0)).max() < 0.25 * SACCADE_SPREAD
    assert 0.3 < up / left < 0.7
    assert 0.4 * SACCADE_SPREAD < left < SACCADE_SPREAD
    assert len(np.unique(rests.round(9), axis=0)) > 50
    np.testing.assert_allclose([rests[:, 0].min(), rests[:, 0].max()], [-2 * SACCADE_SPREAD, 2 * SACCADE_SPREAD])


@pytest.mark.soak
def test_saccade_intervals_exceed_0_4_s_and_have_a_mean_of_1_4_to_2_6_s():
    times = np.arange(0.0, 800.0, 0.02)
    moving = np.abs(np.diff(saccade_offsets((0.0, 800.0), times, 4), axis=0)).max(axis=1) > 1e-12
    begins = times[:-1][moving & ~np.append(False, moving[:-1])]
    assert np.diff(begins).min() > 0.4
    assert (
        1.4 < np.diff(begins).mean() < 2.6
    )  # Two of five saccades return to the centre; from the centre they do not move


def test_idle_eye_motion_includes_blinks_and_saccades_by_default():
    habits = Habits(seed=3)
    assert habits.blinks
    assert habits.saccades


def test_downward_gesture_gaze_moves_the_eyes_down(context):
    block = parse(
        BML_TEMPLATE.format(
            '<gesture id="g" lexeme="beat" start="1" strokeStart="2" stroke="2.5" relax="3.5" end="4"/>'
        )
    )
    (look,) = gesture_gazes(schedule(block, {}, {}), {"g": BodyMove(eyes=Turn(torsion=0.3, tilt=0.2))})
    assert (look.left, look.up) == (0.3, -0.2)
