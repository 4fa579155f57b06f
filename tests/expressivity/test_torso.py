from math import degrees

import pytest

from kinesic.bml.block import GAZE_SYNCS, SHIFT_SYNCS, Gesture, Posture, Torso
from kinesic.expressivity.torso import lean, pose


def posture_times(*times):
    return dict(zip(GAZE_SYNCS, times, strict=True))


@pytest.mark.parametrize(
    ("lexeme", "torsion", "tilt", "roll"),
    [
        ("BodyLean", 0, 12, 0),
        ("BodyRecline", 0, -12, 0),
        ("LeanLeftAndBack", 0, -12, -12),
        ("LeftSide", 0, 0, -12),
        ("BodyTurnRight", -12, 0, 0),
        ("subtleBodyLean", 0, 6, 0),
        ("Neutral", 0, 0, 0),
    ],
)
def test_words_of_a_lexeme_name_leans(robot, lexeme, torsion, tilt, roll):
    turn = lean(Torso(lexeme), robot, 0.0).turn
    assert [degrees(angle) for angle in (turn.torsion, turn.tilt, turn.roll)] == pytest.approx([torsion, tilt, roll])


def test_a_lean_goes_and_returns(perform, phases):
    frames = perform(("t", Torso("BodyLean"), phases(0, 1, 1, 1, 1, 2, 3)))
    tilts = {frame.time: degrees(frame.torso.tilt) for frame in frames.frames}
    assert tilts == pytest.approx({0: 0, 1: 12, 2: 12, 3: 0})
    assert frames.uses["t"] == {"torso"}
    assert all(frame.given == {"torso"} for frame in frames.frames)


def test_a_lean_beyond_the_range_is_clipped_and_warned(perform, phases, robot):
    frames = perform(("t", Torso("BodyRecline", amount=1.0), phases(0, 1, 1, 1, 1, 2, 3)))
    assert degrees(frames.frames[1].torso.tilt) == pytest.approx(-15)
    assert any("9.0 deg" in notice.text for notice in frames.notices)


def test_an_unknown_movement_is_dropped(perform, phases):
    frames = perform(("t", Torso("jingtry"), phases(0, 1, 1, 1, 1, 2, 3)))
    assert frames.outcomes["t"].kind == "dropped"
    assert "jingtry" in frames.outcomes["t"].why
    assert frames.frames == ()


def test_standing_is_what_the_robot_does(perform):
    frames = perform(("p", Posture("STANDING"), posture_times(0, 1, 2, 3)))
    assert frames.outcomes["p"].kind == "realised"
    assert frames.uses["p"] == frozenset()


def test_sitting_is_substituted(perform):
    outcome = perform(("p", Posture("SITTING"), posture_times(0, 1, 2, 3))).outcomes["p"]
    assert outcome.kind == "substituted"
    assert "SITTING" in outcome.why


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
    assert pose(Posture(poses=(("ARMS", "ARMS_OPEN"),)), lexicon, robot) is None
