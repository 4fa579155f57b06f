"""Tests of stances and poses of trunk, arms and head."""

from math import degrees

import pytest

from kinesic.bml.block import GAZE_SYNCS, SHIFT_SYNCS, Gesture, Posture
from kinesic.body.robot import Robot
from kinesic.expressivity.posture import pose
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import UPRIGHT_TURN

from ..reduced_robots import write_robot


def posture_times(*times):
    return dict(zip(GAZE_SYNCS, times, strict=True))


def test_standing_posture_is_realised_without_moving_any_body_part(perform):
    frames = perform(("p", Posture("STANDING"), posture_times(0, 1, 2, 3)))
    assert frames.outcomes["p"].kind == "realised"
    assert frames.uses["p"] == frozenset()


def test_sitting_puts_the_hands_in_the_lap(perform):
    frames = perform(("p", Posture("SITTING"), posture_times(0, 1, 2, 3)))
    assert frames.outcomes["p"].kind == "realised"
    assert frames.uses["p"] == {"l_hand", "r_hand"}
    assert {frame.hands["l"].touch for frame in frames.frames if 1 <= frame.time <= 2} == {"lap"}


def test_stance_that_needs_legs_is_dropped(perform):
    outcome = perform(("p", Posture("LYING"), posture_times(0, 1, 2, 3))).outcomes["p"]
    assert outcome.kind == "dropped"
    assert "LYING" in outcome.why


def test_posture_that_needs_crossed_legs_is_dropped(perform):
    outcome = perform(("p", Posture(poses=(("LEGS", "LEGS_CROSSED"),)), posture_times(0, 1, 2, 3))).outcomes["p"]
    assert outcome.kind == "dropped"
    assert "LEGS_CROSSED" in outcome.why
    assert "stance" not in outcome.why


def test_leaning_forward_tilts_the_trunk(perform):
    action = Posture("STANDING", (("WHOLEBODY", "LEANING_FORWARD"),))
    frames = perform(("p", action, posture_times(0, 1, 2, 3)))
    assert [round(degrees(frame.torso.tilt), 6) for frame in frames.frames] == [0, 12, 12, 0]


def test_crossed_arms_posture_crosses_the_arms_and_releases_them_at_its_end(perform):
    frames = perform(("p", Posture(poses=(("ARMS", "ARMS_CROSSED"),)), posture_times(0, 1, 2, 3)))
    hands = {frame.time: frame.hands["l"].reach for frame in frames.frames}
    assert hands[0] is None
    assert hands[1] is not None
    assert hands[2] is hands[1]
    assert hands[3] is None
    assert frames.uses["p"] == {"l_hand", "r_hand"}


def test_posture_of_zero_duration_after_a_gesture_leaves_no_arm_crossed(perform, phases):
    crossed = Posture(poses=(("ARMS", "ARMS_CROSSED"),))
    frames = perform(
        ("g", Gesture("object_handle", "left"), phases(*7 * [1.5])), ("p", crossed, posture_times(*4 * [2.0]))
    )
    assert frames.frames[-1].hands["l"].reach is None


def test_gestures_return_to_permanently_crossed_arms(perform, phases):
    frames = perform(
        ("p", Posture(poses=(("ARMS", "ARMS_CROSSED"),), shift=True), dict(zip(SHIFT_SYNCS, (0, 1), strict=True))),
        ("g", Gesture("beat", "right"), phases(2, 2.5, 2.5, 3, 3, 3.2, 4)),
    )
    crossed = next(frame for frame in frames.frames if frame.time == 1).hands["r"]
    assert frames.frames[-1].hands["r"] is crossed


def test_neutral_arm_pose_name_is_accepted_for_its_arm(robot, lexicon):
    assert pose(Posture(poses=(("LEFT_ARM", "ARMS_NEUTRAL"),)), lexicon, robot).arms == ("left",)


def test_arm_pose_name_is_matched_as_a_whole_or_rejected(robot, lexicon):
    assert pose(Posture(poses=(("ARMS", "ARMS_AKIMBO"),)), lexicon, robot).arms[0].id == "akimbo"
    assert pose(Posture(poses=(("ARMS", "ARMS_WIGGLY"),)), lexicon, robot) is None


def test_posture_with_open_arms_holds_both_hands_out_to_the_side(robot, lexicon):
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
def test_pose_of_the_whole_body_may_name_an_arm_pose(robot, lexicon, lexeme, arms):
    posed = pose(Posture(poses=(("WHOLEBODY", lexeme),)), lexicon, robot)
    assert [getattr(arm, "id", arm) for arm in posed.arms] == [arms]


def test_head_pose_of_a_posture_tilts_the_head(perform):
    frames = perform(("p", Posture(poses=(("HEAD", "LEANING_FORWARD"),)), posture_times(0, 1, 2, 3)))
    assert [round(degrees(frame.head.tilt), 6) for frame in frames.frames] == [0, 15, 15, 0]
    assert frames.uses["p"] == {"head"}


def test_crouching_bends_the_trunk_forward(perform):
    frames = perform(("p", Posture("CROUCHING"), posture_times(0, 1, 2, 3)))
    assert [round(degrees(frame.torso.tilt), 6) for frame in frames.frames] == [0, 12, 12, 0]


def test_arm_pose_of_a_posture_overrides_the_arms_of_its_stance(perform):
    frames = perform(("p", Posture("SITTING", (("ARMS", "ARMS_CROSSED"),)), posture_times(0, 1, 2, 3)))
    assert {frame.hands["r"].touch for frame in frames.frames if 1 <= frame.time <= 2} == {"upper_arm"}


def test_permanent_standing_posture_after_a_seated_one_makes_the_hands_hang_again(perform):
    frames = perform(
        ("p", Posture("SITTING", shift=True), dict(zip(SHIFT_SYNCS, (0, 1), strict=True))),
        ("q", Posture("STANDING", shift=True), dict(zip(SHIFT_SYNCS, (2, 3), strict=True))),
    )
    reached = {frame.time: frame.hands["l"].reach for frame in frames.frames}
    assert reached[1] is not None
    assert reached[3] is None


def test_second_pose_of_the_same_arm_is_reported_as_omitted(robot, lexicon):
    twice = pose(Posture(poses=(("ARMS", "ARMS_AKIMBO"), ("ARMS", "ARMS_CROSSED"))), lexicon, robot)
    assert [arm.id for arm in twice.arms] == ["akimbo"]
    assert "ARMS_CROSSED" in twice.left_out
    result = pose(Posture(poses=(("LEFT_ARM", "ARMS_AKIMBO"), ("RIGHT_ARM", "ARMS_NEUTRAL"))), lexicon, robot)
    assert (len(result.arms), result.left_out) == (2, "")


@pytest.mark.parametrize("part", ["BODY", "TORSO", "SPINE", "TRUNK", "WHOLEBODY"])
def test_every_name_of_the_trunk_in_a_pose_leans_the_trunk(robot, lexicon, part):
    posed = pose(Posture(poses=((part, "LEANING_BACK"),)), lexicon, robot)
    assert degrees(posed.lean.turn.tilt) == pytest.approx(-12)
    assert posed.arms == ()


def test_posture_of_an_unsupported_body_part_has_no_pose(robot, lexicon):
    assert pose(Posture(poses=(("LEGS", "LEANING_BACK"),)), lexicon, robot) is None


def test_leans_of_several_poses_add_up_within_the_range(robot, lexicon):
    both = pose(Posture(poses=(("BODY", "LEANING_FORWARD"), ("SPINE", "LEANING_LEFT"))), lexicon, robot)
    assert [degrees(angle) for angle in (both.lean.turn.tilt, both.lean.turn.roll)] == pytest.approx([12, -12])
    crouched = pose(Posture("CROUCHING", (("HEAD", "DOWN"), ("HEAD", "LEFT"))), lexicon, robot)
    assert degrees(crouched.lean.turn.tilt) == pytest.approx(12)
    assert [degrees(angle) for angle in (crouched.head.tilt, crouched.head.torsion)] == pytest.approx([15, 15])


def test_posture_is_dropped_if_the_trunk_cannot_lean(tmp_path, timeline, context, limits):
    robot = Robot.load(write_robot(tmp_path, "torso"))
    built = timeline(("p", Posture(poses=(("BODY", "LEANING_FORWARD"),)), posture_times(0, 1, 2, 3)))
    outcome = make_keyframes(built, context(built.block, pace=Pace(robot, limits(robot)))).outcomes["p"]
    assert outcome.kind == "dropped"
    assert "the trunk cannot: 12.0 deg" in outcome.why
    crossed = timeline(
        ("p", Posture(poses=(("BODY", "LEANING_FORWARD"), ("ARMS", "CROSSED"))), posture_times(0, 1, 2, 3))
    )
    frames = make_keyframes(crossed, context(crossed.block, pace=Pace(robot, limits(robot))))
    assert frames.outcomes["p"].kind == "realised"
    assert any("12.0 deg" in notice.text for notice in frames.notices)


def test_head_pose_is_left_out_without_a_neck(tmp_path, lexicon):
    posed = pose(
        Posture(poses=(("HEAD", "DOWN"), ("BODY", "LEANING_FORWARD"))),
        lexicon,
        Robot.load(write_robot(tmp_path, "neck")),
    )
    assert posed.left_out == "no neck for the pose DOWN of HEAD"
    assert posed.head == UPRIGHT_TURN
    assert degrees(posed.lean.turn.tilt) == pytest.approx(12)


def test_later_posture_overrides_an_earlier_one_from_its_start_time(perform):
    lean = Posture(poses=(("BODY", "LEANING_FORWARD"),))
    back = Posture(poses=(("BODY", "LEANING_BACK"),))
    frames = perform(("later", back, posture_times(2, 3, 4, 5)), ("first", lean, posture_times(0, 1, 9, 10)))
    tilts = {frame.time: degrees(frame.torso.tilt) for frame in frames.frames}
    assert [tilts[time] for time in (0, 1, 2, 3, 4, 5)] == pytest.approx([0, 12, 12, -12, -12, 0])


def test_permanent_arm_crossing_takes_the_time_until_its_end(perform):
    frames = perform(
        ("p", Posture(poses=(("ARMS", "ARMS_CROSSED"),), shift=True), dict(zip(SHIFT_SYNCS, (1, 3), strict=True)))
    )
    reached = {frame.time: frame.hands["l"].reach is not None for frame in frames.frames}
    assert (reached[1], reached[3]) == (False, True)
    assert frames.frames[-1].hands["l"].reach is not None
