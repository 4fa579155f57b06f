import numpy as np
import pytest

from kinesic.bml.block import Gesture
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.action_units import ASIDE, DOWNWARD, INWARD, UPWARD
from kinesic.expressivity.face.eyes import (
    CLOSING,
    EARLY,
    FLITTING,
    LEAST_GAP,
    OPENING,
    SHUT,
    GazeDirection,
    Habits,
    blink_times,
    blinking,
    flitting,
    gaze_units,
    gesture_looks,
    headings,
    looking,
    looks,
    meeting,
)
from kinesic.expressivity.keyframes import BodyMove, Turn

TIMES = np.arange(0.0, 10.0, 0.005)
AHEAD = np.zeros((len(TIMES), 2))
BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def test_blinks_come_by_chance_about_every_four_seconds():
    begins = np.array(blink_times((0.0, 4000.0), (), 3))
    gaps = np.diff(begins)
    assert gaps.min() >= LEAST_GAP - 1e-9
    assert 3.0 < gaps.mean() < 5.0
    assert blink_times((0.0, 4000.0), (), 3) == tuple(begins)
    assert blink_times((0.0, 4000.0), (), 4) != tuple(begins)


def test_a_longer_performance_has_the_same_blinks_and_more():
    short, long = (blink_times((0.0, end), (), 5) for end in (30.0, 60.0))
    assert long[: len(short)] == short


def test_wide_turns_of_the_gaze_bring_a_blink_small_ones_do_not():
    wide, narrow = GazeDirection(3.0, 0.6, 0.0, 6.0), GazeDirection(3.0, 0.1, 0.0, 6.0)
    assert {3.0, 6.0} <= set(blink_times((0.0, 10.0), [wide], 1))
    assert not {3.0, 6.0} & set(blink_times((0.0, 10.0), [narrow], 1))


def test_a_blink_comes_when_it_is_asked_for_unless_one_has_just_been():
    assert {2.0, 4.0} <= set(blink_times((0.0, 10.0), (), 1, also=[2.0, 2.5, 4.0]))
    assert 2.5 not in blink_times((0.0, 10.0), (), 1, also=[2.0, 2.5, 4.0])


def test_a_blink_closes_both_eyes_fully_and_is_soon_over():
    found = blinking([2.0], TIMES)
    assert found.keys() == {"L45", "R45"}
    closed = found["L45"]
    assert closed.max() == 1.0
    whole = CLOSING + SHUT + OPENING
    np.testing.assert_array_equal(closed[np.abs(TIMES - 2.0 - whole / 2) > whole / 2 + 1e-9], 0.0)
    assert 0.14 < whole < 0.22


def test_eyes_look_before_the_head_and_stay_on_it_while_the_head_follows():
    look = GazeDirection(2.0, 0.5, 0.1, 6.0)
    head = np.stack([np.interp(TIMES, [2.1, 2.8, 6.0, 6.7], [0.0, 0.5, 0.5, 0.0]), 0.0 * TIMES], axis=1)
    eyes = looking([look], TIMES, head)
    gaze = eyes + head
    fixed = (TIMES > 2.15) & (TIMES < 5.99)
    np.testing.assert_allclose(gaze[fixed], np.tile([0.5, 0.1], (fixed.sum(), 1)), atol=1e-12)
    np.testing.assert_array_equal(eyes[TIMES <= 2.0], 0.0)
    np.testing.assert_array_equal(eyes[TIMES > 6.2], 0.0)


def test_a_later_look_takes_over_and_what_stays_is_returned_to():
    eyes = looking([GazeDirection(1.0, 0.2, 0.0), GazeDirection(3.0, -0.3, 0.0, 5.0)], TIMES, AHEAD)
    for time, left in ((2.0, 0.2), (4.0, -0.3), (8.0, 0.2)):
        assert eyes[np.searchsorted(TIMES, time), 0] == pytest.approx(left)


def test_eyes_flit_a_little_and_the_same_way_with_the_same_seed():
    strayed = flitting((0.0, 10.0), TIMES, 4)
    assert 0.0 < np.abs(strayed).max() <= 2 * FLITTING + 1e-12
    np.testing.assert_array_equal(strayed, flitting((0.0, 10.0), TIMES, 4))
    assert np.any(strayed != flitting((0.0, 10.0), TIMES, 5))
    assert np.mean(np.abs(np.diff(strayed[:, 0])) > 0.0) < 0.2  # most of the time they rest


def test_angles_become_units_one_of_each_pair_and_are_cut_at_the_range():
    found = gaze_units(np.array([[ASIDE, UPWARD / 2], [-ASIDE / 2, -DOWNWARD], [9.0, -9.0]]))
    np.testing.assert_allclose(found["61"], [1.0, 0.0, 1.0])
    np.testing.assert_allclose(found["62"], [0.0, 0.5, 0.0])
    np.testing.assert_allclose(found["63"], [0.5, 0.0, 0.0])
    np.testing.assert_allclose(found["64"], [0.0, 1.0, 1.0])


def test_gazes_are_directions_in_time_and_shifts_stay(context):
    inside = (
        '<gaze id="g" target="thing" start="1" ready="1.4" relax="3" end="3.5"/>'
        '<gazeShift id="h" target="other" start="4" end="4.5"/><gaze id="i" target="nowhere" start="6"/>'
    )
    timeline = schedule(parse(BML.format(inside)), {}, {})
    targets = {"thing": np.array([1.0, 1.0, 1.2]), "other": np.array([2.0, -1.0, 0.6])}
    here = context(timeline.block, targets=targets)
    found = [look for look in looks(timeline, here) if look.start < 5.0]
    assert [look.start for look in found] == [1.0, 4.0]
    assert found[0].left > 0.3
    assert found[0].end == 3.0
    assert found[1].left < -0.2
    assert found[1].up < 0.0
    assert found[1].end == np.inf


def test_headings_are_left_and_up():
    found = headings(np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]]))
    np.testing.assert_allclose(found, [[0.0, 0.0], [np.pi / 4, 0.0], [0.0, np.pi / 4]])
    assert found.shape == (3, 2)
    assert found[1, 0] == pytest.approx(np.pi / 4)


def test_eyes_meet_at_what_is_near_and_part_again():
    near, far = GazeDirection(1.0, 0.0, 0.0, 3.0, 0.25), GazeDirection(5.0, 0.2, 0.0, away=2.0)
    inward = meeting([near, far], TIMES)["66"] * INWARD
    assert inward[TIMES < 1.0].max() == 0.0
    np.testing.assert_allclose(inward[(TIMES > 1.2) & (TIMES < 3.0)], np.arctan(0.03 / 0.25))
    np.testing.assert_allclose(inward[TIMES > 5.3], np.arctan(0.03 / 2.0))
    assert np.abs(inward[(TIMES > 3.3) & (TIMES < 5.0)]).max() < 1e-12
    assert GazeDirection(0.0, 0.0, 0.0).inward == 0.0


def test_eyes_leave_for_what_a_gesture_shows_no_later_than_the_head(timeline, phases):
    asked = timeline(("g", Gesture("large"), phases(1.0, 2.0, 2.0, 2.5, 3.0, 3.5, 4.5)))
    seen = Turn(torsion=0.3, tilt=0.2)
    (with_head,), (alone,) = (
        gesture_looks(asked, {"g": BodyMove(head=head, eyes=seen)}) for head in (Turn(torsion=0.1), Turn())
    )
    assert (with_head.start, with_head.left, with_head.end) == (1.0, 0.3, 3.5)
    assert alone.start == pytest.approx(2.0 - EARLY)


def test_small_saccades_go_to_all_sides_and_half_as_far_up_and_down():
    rests = flitting((0.0, 400.0), np.arange(0.0, 400.0, 0.2), 4)
    left, up = rests.std(axis=0)
    assert np.abs(rests.mean(axis=0)).max() < 0.25 * FLITTING
    assert 0.3 < up / left < 0.7
    assert 0.4 * FLITTING < left < FLITTING
    assert len(np.unique(rests.round(9), axis=0)) > 50


def test_blinks_that_turns_or_words_bring_are_as_far_apart_as_any():
    begins = np.array(blink_times((0.0, 60.0), (), 3, also=np.arange(0.1, 60.0, 0.3).tolist()))
    assert begins[0] == pytest.approx(0.1)
    assert np.diff(begins).min() >= LEAST_GAP - 1e-9
    assert np.diff(begins).max() < LEAST_GAP + 0.6
    assert blink_times((5.0, 6.0), (), 3, also=[4.9, 6.0, 6.1]) == blink_times((5.0, 6.0), (), 3)


def test_eyes_rest_between_small_saccades_as_long_as_people_do():
    times = np.arange(0.0, 800.0, 0.02)
    moving = np.abs(np.diff(flitting((0.0, 800.0), times, 4), axis=0)).max(axis=1) > 1e-12
    begins = times[:-1][moving & ~np.append(False, moving[:-1])]
    assert np.diff(begins).min() > 0.4
    assert 1.4 < np.diff(begins).mean() < 2.6  # two of five saccades go nowhere from where none was


def test_eyes_that_are_told_nothing_blink_and_flit():
    habits = Habits(seed=3)
    assert habits.blinks
    assert habits.saccades


def test_eyes_look_down_with_a_gesture_that_looks_down(context):
    block = parse(
        BML.format('<gesture id="g" lexeme="beat" start="1" strokeStart="2" stroke="2.5" relax="3.5" end="4"/>')
    )
    (look,) = gesture_looks(schedule(block, {}, {}), {"g": BodyMove(eyes=Turn(torsion=0.3, tilt=0.2))})
    assert (look.left, look.up) == (0.3, -0.2)
