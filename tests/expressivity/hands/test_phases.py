from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.hands.busy_hands import Clash
from kinesic.expressivity.hands.keys import HandKey, hand_at
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import REST_HAND, Poses, pointing_poses, poses, resting_hands, shoulder
from kinesic.expressivity.hands.strokes import Stroke, stroke_key_times
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.form import StrokeKey
from kinesic.expressivity.style.style import Expressivity


def reach(x, y, z):
    return Hand(Reach(sealed([x, y, z])))


A, B, C = reach(0.25, 0.1, 0.8), reach(0.25, 0.2, 0.7), reach(0.25, 0.3, 0.9)


def work(*hands, side="r"):
    return Poses({side: hands}, stroke=len(hands) // 2)


def times_of(keys):
    return [round(key.time, 6) for key in keys]


def test_hand_moves_from_rest_through_the_stroke_keys_of_a_gesture_and_back_to_rest(pace, phases):
    stroke = Stroke("g", phases(0, 0.6, 0.7, 1.0, 1.3, 1.5, 2.0), (work(A, B, C),))
    keys = arrange_hands([stroke], pace).hands["r"]
    assert times_of(keys) == [0, 0.6, 0.7, 1.0, 1.3, 1.5, 2.0]
    assert [key.hand for key in keys] == [REST_HAND, A, A, B, C, C, REST_HAND]
    assert arrange_hands([stroke], pace).hands["l"] == ()


def test_stroke_key_of_every_gesture_is_exactly_at_the_stroke_sync_point(robot, pace, lexicon, phases):
    for form in lexicon.forms:
        if form.keys:
            keys = poses(form, robot, Expressivity())
            key_times = stroke_key_times(keys, phases(0, 0.5, 0.6, 1.0, 1.7, 1.8, 2.5), pace)
            assert key_times[keys.stroke] == 1.0
            assert key_times[0] == 0.6 or keys.stroke == 0
            assert all(a < b for a, b in pairwise(key_times))


def test_last_stroke_key_is_at_the_stroke_sync_point_if_the_stroke_phase_ends_there(pace, phases):
    key_times = stroke_key_times(work(A, B, C, A), phases(0, 0.5, 0.6, 1.0, 1.0, 1.8, 2.5), pace)
    assert key_times[-1] == 1.0


def test_stroke_of_zero_duration_keeps_only_the_stroke_key(pace, phases):
    stroke = Stroke("g", phases(0, 0.5, 1.0, 1.0, 1.0, 1.4, 2.0), (work(A, B, C),))
    keys = arrange_hands([stroke], pace).hands["r"]
    assert times_of(keys) == [0, 0.5, 1.0, 1.4, 2.0]
    assert keys[2].hand is C


def test_one_pose_gesture_of_the_lexicon_starts_15_percent_nearer_to_rest(robot, lexicon):
    rest = resting_hands(robot)["r"].position
    form = lexicon.find("arms_crossed", "right").form
    near, there = (hand.reach.position for hand in poses(form, robot, Expressivity()).hands["r"])
    np.testing.assert_allclose(near - there, 0.15 * (rest - there), atol=1e-12)


def test_hand_does_not_return_to_rest_between_gestures_close_in_time(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 1.8), (work(A, B),))
    second = Stroke("g2", phases(2.2, 2.8, 2.8, 3.2, 3.2, 3.4, 4.0), (work(C, A),))
    keys = arrange_hands([first, second], pace).hands["r"]
    assert [key.time for key in keys if key.hand is REST_HAND] == [0, 4.0]


def test_hand_leaves_a_hold_early_enough_for_the_next_gesture(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 2.0, 2.5), (work(A, B),))
    second = Stroke("g2", phases(1.2, 1.8, 1.8, 2.2, 2.2, 2.4, 3.0), (work(C, A),))
    keys = arrange_hands([first, second], pace).hands["r"]
    leaving = max(key.time for key in keys if key.hand is B)
    assert 1.0 <= leaving <= 1.55
    assert next(key for key in keys if key.time == 1.8).hand is C


def test_hand_returns_to_rest_between_gestures_distant_in_time(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 1.8), (work(A, B),))
    second = Stroke("g2", phases(2.5, 3, 3, 3.2, 3.2, 3.4, 4.0), (work(C, A),))
    keys = arrange_hands([first, second], pace).hands["r"]
    assert [key.time for key in keys if key.hand is REST_HAND] == [0, 1.8, 2.5, 4.0]


def test_stroke_that_overlaps_another_of_one_hand_is_dropped_with_a_reason(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 1.8), (work(A, B),))
    second = Stroke("g2", phases(0.5, 1.2, 1.2, 1.6, 1.6, 1.9, 2.4), (work(C, A),))
    arrangement = arrange_hands([first, second], pace)
    assert arrangement.outcomes["g2"].kind == "dropped"
    assert "g1" in arrangement.outcomes["g2"].why
    assert "1.40" in arrangement.outcomes["g2"].why
    assert "g2" not in arrangement.sides


def test_stroke_that_overlaps_another_moves_to_the_free_hand(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 1.8), (work(A, B),))
    second = Stroke("g2", phases(0.5, 1.2, 1.2, 1.6, 1.6, 1.9, 2.4), (work(C, A), work(C, A, side="l")))
    arrangement = arrange_hands([first, second], pace)
    assert arrangement.outcomes["g2"].kind == "substituted"
    assert "left hand" in arrangement.outcomes["g2"].why
    assert arrangement.sides["g2"] == {"l"}


def test_hand_returns_to_the_last_rest_pose_after_a_gesture(pace, phases):
    folded = Stroke("r", phases(0, 0.6, 0.6, 1.0, 1.0, 1.0, 1.5), (work(A),), rest=True)
    gesture = Stroke("g", phases(4, 4.6, 4.6, 5.0, 5.0, 5.2, 6.0), (work(C, B),))
    keys = arrange_hands([folded, gesture], pace).hands["r"]
    assert keys[0].hand is REST_HAND
    assert keys[-1].hand is A
    assert next(key for key in keys if key.time == 4.0).hand is A


def test_rest_pose_during_a_stroke_is_deferred_to_the_retraction(pace, phases):
    gesture = Stroke("g", phases(0, 0.6, 0.6, 1.0, 2.0, 2.2, 3.0), (work(C, B),))
    folded = Stroke("r", phases(0.5, 1.2, 1.2, 1.5, 1.5, 1.5, 1.5), (work(A),), rest=True)
    keys = arrange_hands([gesture, folded], pace).hands["r"]
    assert [key.hand for key in keys].count(A) == 1
    assert keys[-1].time == 3.0
    assert keys[-1].hand is A


def test_gesture_with_all_sync_points_at_one_time_takes_its_natural_durations(pace, phases):
    keys = arrange_hands([Stroke("g", phases(1, 1, 1, 1, 1, 1, 1), (work(A, B),))], pace).hands["r"]
    assert keys[0].time < 0.8
    assert keys[-1].time > 1.2
    assert [key.hand for key in keys] == [REST_HAND, B, REST_HAND]


def test_pointing_puts_the_wrist_on_the_line_to_the_target(robot):
    target = sealed([1.0, -1.5, 1.0])
    hand = pointing_poses(target, "r", robot).hands["r"][-1]
    centre = shoulder(robot, "r")
    line = (target - centre) / np.linalg.norm(target - centre)
    np.testing.assert_allclose(hand.reach.position, centre + 0.98 * robot.arm_length * line, atol=1e-12)
    np.testing.assert_allclose(hand.reach.pointing, line, atol=1e-12)
    np.testing.assert_array_equal(hand.aim, target)


def test_openness_of_the_style_becomes_that_of_the_hand_poses(robot, lexicon):
    form = lexicon.find("beat", "right").form
    form = replace(form, keys=tuple(StrokeKey({"r": replace(key.hands["r"], openness=0.0)}) for key in form.keys))
    opened = [poses(form, robot, Expressivity(openness=o)).hands["r"][-1].openness for o in (0.0, 0.3, 1.0)]
    assert opened == [0.0, 0.3, 1.0]


@pytest.mark.parametrize(("power", "effort"), [(-1.0, 0.0), (0.0, 0.0), (0.7, 0.7)])
def test_positive_power_makes_the_shoulder_follow_the_arm(robot, lexicon, power, effort):
    work = poses(lexicon.find("beat", "right").form, robot, Expressivity(power=power))
    assert work.hands["r"][-1].effort == effort


def test_repetition_parameter_performs_the_stroke_of_a_beat_up_to_three_times(robot, lexicon):
    form = lexicon.find("beat", "right").form
    assert [poses(form, robot, Expressivity(repetition=r)).count for r in (-1.0, 0.0, 0.5, 1.0)] == [2, 2, 4, 6]


@pytest.mark.parametrize("gesture", ["listen", "think", "sleep", "phone_call", "hush"])
def test_gesture_held_at_the_head_is_not_repeated(robot, lexicon, gesture):
    result = poses(lexicon.forms_by_id[gesture], robot, Expressivity(repetition=1.0))
    assert result.stroke_count == 1


def test_repetition_repeats_gestures_that_touch_the_body_repeatedly(robot, lexicon):
    repeated = [
        poses(lexicon.forms_by_id[name], robot, Expressivity(repetition=1.0)) for name in ("heart", "eat", "crazy")
    ]
    assert all(item.stroke_count > 1 for item in repeated)


def test_hand_directions_between_keys_rotate_and_stay_unit_vectors(robot):
    rest = resting_hands(robot)["r"]
    a = Hand(Reach(sealed([0, 0, 0]), pointing=sealed([1, 0, 0]), palm=sealed([0, 0, 1])))
    b = Hand(Reach(sealed([1, 0, 0]), pointing=sealed([0, 1, 0])), openness=0.6, effort=0.2)
    way = hand_at((HandKey(0.0, a), HandKey(1.0, b)), 0.5, rest)
    assert (way.openness, way.effort) == pytest.approx((0.3, 0.1))
    middle = way.reach
    np.testing.assert_allclose(middle.position, [0.5, 0, 0])
    np.testing.assert_allclose(middle.pointing, [np.sqrt(0.5), np.sqrt(0.5), 0])
    assert middle.palm is None
    assert hand_at((HandKey(0.0, a), HandKey(1.0, b)), 0.25, rest).reach.palm is a.reach.palm


def test_hand_leaving_rest_starts_at_the_hanging_position(robot):
    rest = resting_hands(robot)["r"]
    keys = (HandKey(0.0, REST_HAND), HandKey(1.0, A))
    assert hand_at(keys, 0.0, rest) is REST_HAND
    np.testing.assert_allclose(hand_at(keys, 0.01, rest).reach.position, rest.position, atol=0.01)
    assert hand_at(keys, 2.0, rest) is A


def test_rest_poses_of_left_and_right_hand_are_mirrored(robot):
    rest = resting_hands(robot)
    assert rest["l"].position == pytest.approx(rest["r"].position * [1, -1, 1])
    assert np.linalg.norm(rest["l"].palm) == pytest.approx(1.0)


def test_rest_pose_with_a_timing_conflict_is_deferred_to_the_retraction(pace, phases):
    gesture = Stroke("g", phases(0, 0.6, 0.6, 1.0, 1.0, 1.5, 2.0), (work(A, B),))
    pose = Stroke("p", phases(1.1, 1.4, 1.4, 1.5, 1.5, 1.5, 1.5), (work(C),), rest=True)
    at_once = arrange_hands([gesture, pose], pace)
    assert {key.time for key in at_once.hands["r"] if key.hand is C} == {1.5}
    assert at_once.remarks == {}
    arrangement = arrange_hands([gesture, pose], pace, clashes={frozenset(("g", "p")): Clash(0.4)})
    assert [key.hand for key in arrangement.hands["r"]] == [REST_HAND, A, B, B, C]
    assert times_of(arrangement.hands["r"])[-1] == 2.0
    assert arrangement.remarks == {"p": ("is taken as the hands go back from g: 0.40 s are missing between the two",)}


@pytest.mark.parametrize(("touch", "relax", "home"), [("hand", 4.2, 4.2), (None, 4.2, 3.0), ("hand", 6.0, 3.0)])
def test_hands_that_rest_on_each_other_retract_together_unless_one_gesture_ends_much_later(
    pace, phases, touch, relax, home
):
    """Wait for the other hand to finish its gesture, unless it takes long."""
    folded = replace(A, touch=touch)
    rest = Stroke(
        "p", phases(0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0), (Poses({"l": (folded,), "r": (folded,)}, 0),), rest=True
    )
    both = Stroke("b", phases(2.0, 2.5, 2.5, 2.8, 2.8, 3.0, 4.0), (Poses({"l": (B, C), "r": (B, C)}, 1),))
    one = Stroke("o", phases(3.0, 3.6, 3.6, 4.0, 4.0, relax, relax + 1.0), (work(A, B),))
    keys = arrange_hands([rest, both, one], pace).hands["l"]
    assert max(key.time for key in keys if key.hand is C) == pytest.approx(home)
    assert keys[-1].hand is folded
    assert keys[-1].time == pytest.approx(5.2 if home == relax else 4.0)


def test_hand_with_low_tension_stops_during_holds(pace, phases):
    """Prevent a swing when the trunk moves the arm slightly during a hold."""
    loose = Expressivity(tension=-1.0, fluidity=0.5)
    stroke = Stroke("g", phases(0, 0.6, 0.6, 1.0, 1.0, 2.4, 3.2), (work(A, B),), manner=loose)
    waiting = [key for key in arrange_hands([stroke], pace).hands["r"] if key.hand is B]
    assert [key.time for key in waiting] == [1.0, 2.4]
    assert all(key.passage.flow == 0.0 for key in waiting)


@pytest.mark.parametrize(("start", "sinks"), [(1.5, False), (2.29, True)])
def test_hand_waiting_between_gestures_is_lowered_if_time_allows(pace, phases, start, sinks):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.1, 1.8), (work(A, B),))
    second = Stroke("g2", phases(start, *(start + np.array([0.6, 0.6, 1.0, 1.0, 1.2, 1.8]))), (work(C, A),))
    keys = arrange_hands([first, second], pace).hands["r"]
    low = [key for key in keys if 1.1 < key.time <= start and key.hand not in (A, B, C)]
    assert bool(low) == sinks
    for key in low:
        hanging = resting_hands(pace.robot)["r"].position
        np.testing.assert_allclose(key.hand.reach.position, (B.reach.position + hanging) / 2)
        assert key.hand.openness > 0.0


def test_hand_lowered_between_two_gestures_stops_only_in_a_long_pause(pace, phases):
    """Prevent stops of a few hundredths of a second between two gestures."""
    for end, start, stops in [(1.8, 2.29, False), (2.8, 3.2, True)]:
        first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.1, end), (work(A, B),))
        second = Stroke("g2", phases(start, *(start + np.array([0.6, 0.6, 1.0, 1.0, 1.2, 1.8]))), (work(C, A),))
        keys = arrange_hands([first, second], pace).hands["r"]
        low = [key.time for key in keys if 1.1 < key.time <= start and key.hand not in (A, B, C)]
        assert len(low) == 1 + stops
        assert low[-1] - low[0] >= 0.35 * stops
