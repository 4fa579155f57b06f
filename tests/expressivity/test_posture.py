"""Postures: what trunk, arms and head do of stances and poses."""

from math import degrees

import pytest

from kinesic.bml.block import GAZE_SYNCS, SHIFT_SYNCS, Gesture, Posture
from kinesic.expressivity.posture import pose


def posture_times(*times):
    return dict(zip(GAZE_SYNCS, times, strict=True))


def test_standing_is_what_the_robot_does(perform):
    frames = perform(("p", Posture("STANDING"), posture_times(0, 1, 2, 3)))
    assert frames.outcomes["p"].kind == "realised"
    assert frames.uses["p"] == frozenset()


def test_who_sits_has_the_hands_in_the_lap(perform):
    frames = perform(("p", Posture("SITTING"), posture_times(0, 1, 2, 3)))
    assert frames.outcomes["p"].kind == "realised"
    assert frames.uses["p"] == {"l_hand", "r_hand"}
    assert {frame.hands["l"].touch for frame in frames.frames if 1 <= frame.time <= 2} == {"lap"}


def test_a_stance_without_a_part_for_the_upper_body_is_dropped(perform):
    outcome = perform(("p", Posture("LYING"), posture_times(0, 1, 2, 3))).outcomes["p"]
    assert outcome.kind == "dropped"
    assert "LYING" in outcome.why


def test_a_posture_without_anything_that_can_be_done_is_dropped(perform):
    outcome = perform(("p", Posture(poses=(("LEGS", "LEGS_CROSSED"),)), posture_times(0, 1, 2, 3))).outcomes["p"]
    assert outcome.kind == "dropped"
    assert "LEGS_CROSSED" in outcome.why


def test_leaning_forward_is_a_pose_of_the_trunk(perform):
    action = Posture("STANDING", (("WHOLEBODY", "LEANING_FORWARD"),))
    frames = perform(("p", action, posture_times(0, 1, 2, 3)))
    assert [round(degrees(frame.torso.tilt), 6) for frame in frames.frames] == [0, 12, 12, 0]


def test_crossed_arms_are_taken_and_left(perform):
    frames = perform(("p", Posture(poses=(("ARMS", "ARMS_CROSSED"),)), posture_times(0, 1, 2, 3)))
    hands = {frame.time: frame.hands["l"].reach for frame in frames.frames}
    assert hands[0] is None
    assert hands[1] is not None
    assert hands[2] is hands[1]
    assert hands[3] is None
    assert frames.uses["p"] == {"l_hand", "r_hand"}


def test_a_posture_that_is_over_at_once_after_a_gesture_leaves_no_arm_crossed(perform, phases):
    crossed = Posture(poses=(("ARMS", "ARMS_CROSSED"),))
    frames = perform(
        ("g", Gesture("object_handle", "left"), phases(*7 * [1.5])), ("p", crossed, posture_times(*4 * [2.0]))
    )
    assert frames.frames[-1].hands["l"].reach is None


def test_crossed_arms_that_stay_are_where_gestures_return_to(perform, phases):
    frames = perform(
        ("p", Posture(poses=(("ARMS", "ARMS_CROSSED"),), shift=True), dict(zip(SHIFT_SYNCS, (0, 1), strict=True))),
        ("g", Gesture("beat", "right"), phases(2, 2.5, 2.5, 3, 3, 3.2, 4)),
    )
    crossed = next(frame for frame in frames.frames if frame.time == 1).hands["r"]
    assert frames.frames[-1].hands["r"] is crossed


def test_arms_that_hang(robot, lexicon):
    assert pose(Posture(poses=(("LEFT_ARM", "ARMS_NEUTRAL"),)), lexicon, robot).arms == ("left",)


def test_a_pose_is_not_mistaken_for_another(robot, lexicon):
    assert pose(Posture(poses=(("ARMS", "ARMS_AKIMBO"),)), lexicon, robot).arms[0].id == "akimbo"
    assert pose(Posture(poses=(("ARMS", "ARMS_WIGGLY"),)), lexicon, robot) is None


def test_open_arms_are_held_open(robot, lexicon):
    (form,) = pose(Posture(poses=(("ARMS", "ARMS_OPEN"),)), lexicon, robot).arms
    assert form.rest
    assert all(hand.position[1] > 0.3 for key in form.keys for hand in key.hands.values())  # out to the side


@pytest.mark.parametrize(
    ("lexeme", "arms"),
    [
        ("ARMS_CROSSED", "arms_crossed"),
        ("ARMS_AKIMBO", "akimbo"),
        ("ARMS_NEUTRAL", "both"),
        ("Idle01", "both"),
        ("HandsAtSide", "both"),
        ("LHandOnHip", "hand_on_hip"),
        ("CROSSED", "arms_crossed"),
        ("akimbo", "akimbo"),
    ],
)
def test_a_pose_of_the_whole_body_may_be_one_of_the_arms(robot, lexicon, lexeme, arms):
    posed = pose(Posture(poses=(("WHOLEBODY", lexeme),)), lexicon, robot)
    assert [getattr(each, "id", each) for each in posed.arms] == [arms]


def test_the_head_takes_part_in_a_posture(perform):
    frames = perform(("p", Posture(poses=(("HEAD", "LEANING_FORWARD"),)), posture_times(0, 1, 2, 3)))
    assert [round(degrees(frame.head.tilt), 6) for frame in frames.frames] == [0, 15, 15, 0]
    assert frames.uses["p"] == {"head"}


def test_who_crouches_bends_forward(perform):
    frames = perform(("p", Posture("CROUCHING"), posture_times(0, 1, 2, 3)))
    assert [round(degrees(frame.torso.tilt), 6) for frame in frames.frames] == [0, 12, 12, 0]


def test_a_pose_of_the_arms_goes_before_the_stance(perform):
    frames = perform(("p", Posture("SITTING", (("ARMS", "ARMS_CROSSED"),)), posture_times(0, 1, 2, 3)))
    assert {frame.hands["r"].touch for frame in frames.frames if 1 <= frame.time <= 2} == {"upper_arm"}


def test_standing_up_lets_the_arms_hang_again(perform):
    frames = perform(
        ("p", Posture("SITTING", shift=True), dict(zip(SHIFT_SYNCS, (0, 1), strict=True))),
        ("q", Posture("STANDING", shift=True), dict(zip(SHIFT_SYNCS, (2, 3), strict=True))),
    )
    reached = {frame.time: frame.hands["l"].reach for frame in frames.frames}
    assert reached[1] is not None
    assert reached[3] is None


def test_of_two_poses_for_one_arm_the_first_counts_and_the_other_is_said(robot, lexicon):
    twice = pose(Posture(poses=(("ARMS", "ARMS_AKIMBO"), ("ARMS", "ARMS_CROSSED"))), lexicon, robot)
    assert [each.id for each in twice.arms] == ["akimbo"]
    assert "ARMS_CROSSED" in twice.left_out
    each = pose(Posture(poses=(("LEFT_ARM", "ARMS_AKIMBO"), ("RIGHT_ARM", "ARMS_NEUTRAL"))), lexicon, robot)
    assert (len(each.arms), each.left_out) == (2, "")
