"""Tests of hand poses in the world: stroke keys, pointing, distances."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.poses import (
    REST_HAND,
    Poses,
    pointing_poses,
    pose_distance,
    poses,
    resting_hands,
    shoulder,
    withdrawn,
)
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.lexicon.body_form import BodyForm
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.paths import shape_path
from kinesic.expressivity.lexicon.space import EASY_REACH, to_world
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Expressivity

A, B, C = (0.4, 0.3, 0.1), (0.4, 0.5, 0.3), (0.5, 0.2, 0.5)


def form(*keys, category="iconic", **fields) -> GestureForm:
    """Return a gesture form from keys {side: position}."""
    poses_ = [StrokeKey({side: HandPose(sealed(place)) for side, place in key.items()}) for key in keys]
    return GestureForm("x", category, tuple(poses_), **fields)


def places(work: Poses, side: str) -> list:
    return [None if hand.reach is None else hand.reach.position for hand in work.hands[side]]


def test_hand_positions_of_a_gesture_are_converted_to_world_coordinates(robot):
    work = poses(form({"l": A, "r": A}, {"l": B, "r": C}), robot, NEUTRAL_EXPRESSIVITY)
    for side, last in (("l", B), ("r", C)):
        np.testing.assert_allclose(places(work, side), [to_world(robot, side, place) for place in (A, last)])
    assert (work.count, work.stroke, work.stroke_count) == (2, 1, 1)


def test_one_pose_gesture_begins_nearer_to_the_rest_position(robot):
    work = poses(form({"r": A}), robot, NEUTRAL_EXPRESSIVITY)
    there, rest = to_world(robot, "r", sealed(A)), resting_hands(robot)["r"].position
    np.testing.assert_allclose(places(work, "r"), [there + 0.15 * (rest - there), there])
    assert (work.count, work.stroke) == (2, 1)


def test_hand_without_a_stroke_key_keeps_its_previous_pose(robot):
    work = poses(form({"r": A}, {"r": B, "l": C}, {"r": C}), robot, NEUTRAL_EXPRESSIVITY)
    first, second, third = work.hands["l"]
    assert first is REST_HAND
    assert second is third
    np.testing.assert_allclose(second.reach.position, to_world(robot, "l", sealed(C)))


@pytest.mark.parametrize(("repetition", "times"), [(-1.0, 1), (0.0, 1), (0.2, 1), (0.5, 2), (1.0, 3)])
def test_repetition_parameter_adds_up_to_two_strokes(robot, repetition, times):
    work = poses(form({"r": A}, {"r": B}), robot, Expressivity(repetition=repetition))
    assert work.stroke_count == times
    assert (work.count, work.stroke, work.again) == (2 * times, 1, tuple(range(3, 2 * times, 2)))
    once = poses(form({"r": A}, {"r": B}), robot, NEUTRAL_EXPRESSIVITY).hands["r"]
    assert [hand.reach.position.tolist() for hand in work.hands["r"]] == times * [
        hand.reach.position.tolist() for hand in once
    ]


@pytest.mark.parametrize(("repetition", "times"), [(-1.0, 2), (-0.4, 3), (0.0, 3), (1.0, 5)])
def test_repetition_parameter_adds_two_strokes_or_removes_one(robot, repetition, times):
    work = poses(form(*3 * [{"r": A}, {"r": B}]), robot, Expressivity(repetition=repetition))
    assert work.stroke_count == times


def test_repeated_stroke_that_ends_at_its_start_needs_no_additional_key(robot):
    work = poses(form({"r": A}, {"r": B}, {"r": A}), robot, Expressivity(repetition=1.0))
    assert (work.count, work.stroke, work.again) == (7, 1, (3, 5))
    assert all(not np.allclose(a, b) for a, b in pairwise(places(work, "r")))
    one_hand = poses(form({"r": A}, {"r": B, "l": B}, {"r": A}), robot, Expressivity(repetition=1.0))
    assert one_hand.count == 9, "the left hand does not end where it begins"


@pytest.mark.parametrize("fields", [{"rest": True}, {"category": "rest", "rest": True}])
def test_repetition_parameter_does_not_repeat_a_rest_pose(robot, fields):
    work = poses(form({"r": A}, {"r": B}, **fields), robot, Expressivity(repetition=1.0))
    assert (work.stroke_count, work.count) == (1, 2)


def test_last_stroke_repetition_of_a_gesture_can_be_removed(robot):
    work = poses(form({"r": A, "l": A}, {"r": B, "l": C}, {"r": A, "l": A}), robot, Expressivity(repetition=1.0))
    fewer = work.fewer()
    assert (fewer.stroke_count, fewer.again, fewer.count) == (2, (3,), 5)
    assert fewer.hands["r"] == work.hands["r"][:5]
    assert len(fewer.paths["l"]) == 5


def test_shoulders_rise_by_half_before_the_stroke_and_fully_from_it(robot):
    work = poses(form({"r": A}, {"r": B}, {"r": C}, body=BodyForm(shoulders=0.4)), robot, NEUTRAL_EXPRESSIVITY)
    assert [hand.lift for hand in work.hands["r"]] == [0.2, 0.4, 0.4]


@pytest.mark.parametrize(("spread", "travels"), [(0.2, False), (0.3, True)])
def test_gesture_is_dynamic_if_the_stroke_exceeds_a_quarter_arm_length(robot, spread, travels):
    work = poses(form({"r": A}, {"r": (A[0], A[1] + spread, A[2])}), robot, NEUTRAL_EXPRESSIVITY)
    assert work.traits.dynamic is travels


@pytest.mark.parametrize(("touch", "travels"), [(None, True), ("head", False)])
def test_repetitions_of_a_small_stroke_count_as_travel_unless_the_hand_touches_something(robot, touch, travels):
    near, far = (HandPose(sealed((A[0], A[1] + offset, A[2])), touch=touch) for offset in (0.0, 0.15))
    repeated = GestureForm("x", "emblem", tuple(StrokeKey({"r": pose}) for pose in (near, far, near, far)))
    assert poses(repeated, robot, NEUTRAL_EXPRESSIVITY).traits.dynamic is travels


def with_path(amplitude: float, last=A) -> GestureForm:
    path = shape_path("circle", amplitude=(amplitude, 0.0, amplitude))
    key = StrokeKey({"r": HandPose(sealed(last), path=path)})
    return GestureForm("x", "iconic", (StrokeKey({"r": HandPose(sealed(A))}), key))


def test_hand_path_grows_with_spatial_extent_within_easy_reach(robot):
    centre, easy = shoulder(robot, "r"), EASY_REACH * robot.arm_length
    widths = []
    for spatial in (-1.0, 0.0, 1.0):
        work = poses(with_path(0.2), robot, Expressivity(spatial=spatial))
        path, (start, end) = work.path("r", 1), places(work, "r")
        way = path.at(start, end, np.linspace(0.0, 1.0, 50))
        widths.append(np.ptp(way, axis=0).max())
        assert np.linalg.norm(way - centre, axis=1).max() <= easy + 1e-9
    assert widths == sorted(widths)
    assert widths[0] < widths[1]
    assert work.path("r", 0) is None
    assert work.path("l", 0) is None


def test_path_amplitude_is_kept_if_the_outward_swing_stays_within_easy_reach(robot):
    """Compare with the mirrored path, which leaves the easy reach."""
    wide = Expressivity(spatial=0.5)
    near, far = (poses(with_path(0.25, last=last), robot, wide) for last in (A, (0.6, 0.9, 0.6)))
    path, (start, end) = far.path("r", 1), places(far, "r")
    centre, easy = shoulder(robot, "r"), EASY_REACH * robot.arm_length
    forth, back = (
        np.linalg.norm(path.at(*ends, np.linspace(0.0, 1.0, 101)) - centre, axis=1).max()
        for ends in ((start, end), (end, start))
    )
    assert forth < easy < back
    np.testing.assert_allclose(path.amplitude, near.path("r", 1).amplitude)


def test_one_hand_of_a_two_handed_gesture_can_be_selected(robot):
    work = poses(form({"r": A, "l": A}, {"r": B, "l": C}), robot, NEUTRAL_EXPRESSIVITY)
    left = work.only("l")
    assert (left.hands.keys(), left.paths.keys()) == ({"l"}, {"l"})
    assert left.hands["l"] is work.hands["l"]


@pytest.mark.parametrize("side", SIDES)
def test_pointing_hand_lies_on_the_line_from_its_shoulder(robot, side):
    centre = shoulder(robot, side)
    for away in (0.2, 5.0):
        target = centre + away * np.array([0.6, 0.0, 0.8])
        work = pointing_poses(target, side, robot)
        hand = work.hands[side][-1]
        np.testing.assert_allclose(
            hand.reach.position, centre + min(0.98 * robot.arm_length, 0.8 * away) * np.array([0.6, 0.0, 0.8])
        )
        np.testing.assert_allclose(hand.reach.pointing, [0.6, 0.0, 0.8])
        np.testing.assert_allclose(hand.aim, target)
        assert (work.stroke, hand.shape, work.traits.dynamic) == (1, "index", False)


def test_pointing_at_a_target_in_the_own_shoulder_points_forward(robot):
    hand = pointing_poses(shoulder(robot, "r"), "r", robot).hands["r"][-1]
    np.testing.assert_allclose(hand.reach.pointing, [1.0, 0.0, 0.0])
    np.testing.assert_allclose(hand.reach.position, shoulder(robot, "r"))


def test_hand_withdrawn_from_the_body_loses_its_contacts_and_keeps_its_shape(robot):
    touching = Hand(Reach(sealed([0.3, 0.0, 0.8])), touch="lap", tip="index", shape="fist")
    away = withdrawn(touching, robot, "l")
    assert (away.touch, away.tip, away.shape) == (None, None, "fist")
    assert withdrawn(REST_HAND, robot, "l") is REST_HAND


def test_hand_pose_distance_depends_on_wrist_travel_and_rotation(robot):
    rest = resting_hands(robot)["r"]
    here = Hand(Reach(rest.position, pointing=sealed([1.0, 0.0, 0.0]), palm=sealed([0.0, 0.0, -1.0])))
    there = replace(here, reach=Reach(rest.position + 0.1, pointing=here.reach.pointing, palm=here.reach.palm))
    over = replace(here, reach=Reach(rest.position, pointing=here.reach.pointing, palm=sealed([0.0, 0.0, 1.0])))
    aside = replace(here, reach=Reach(rest.position, pointing=sealed([0.0, 1.0, 0.0]), palm=here.reach.palm))
    assert pose_distance(here, here, rest) == 0.0
    assert pose_distance(here, there, rest) == pytest.approx(0.1 * np.sqrt(3))
    assert pose_distance(here, over, rest) == pose_distance(over, here, rest) == pytest.approx(0.15 * np.pi)
    assert pose_distance(here, aside, rest) == pytest.approx(0.15 * np.pi / 2)
    assert pose_distance(REST_HAND, REST_HAND, rest) == pytest.approx(0.0, abs=1e-7)  # Limited by the arccosine near 1


def test_hands_hang_at_the_rest_posture(robot):
    rest = resting_hands(robot)
    for side in SIDES:
        palm = robot.arm(side).palm
        np.testing.assert_allclose(
            rest[side].position, robot.skeleton.rest_frames.origins[robot.skeleton.segment(palm.segment)]
        )
        assert rest[side].pointing[2] < -0.8
        assert [np.linalg.norm(way) for way in (rest[side].pointing, rest[side].palm)] == pytest.approx([1.0, 1.0])
    np.testing.assert_allclose(rest["l"].palm, rest["r"].palm * [1, -1, 1], atol=1e-9)


@pytest.mark.parametrize(("name", "axis"), [("narrow_low", 1), ("between_fingers", 2)])
def test_spatial_extent_does_not_enlarge_a_gap_that_the_hands_depict(robot, name, axis):
    shown = Lexicon.load().forms_by_id[name]
    gaps = []
    for spatial in (0.0, 0.9):
        work = poses(shown, robot, replace(NEUTRAL_EXPRESSIVITY, spatial=spatial))
        left, right = (places(work, side)[work.stroke] for side in ("l", "r"))
        gaps.append(abs(left[axis] - right[axis]))
    assert gaps[0] == pytest.approx(gaps[1])
    assert gaps[0] < 0.2


@pytest.mark.parametrize(("name", "extent"), [("small_pinch", 0.9), ("tiny_low", 0.9), ("tall", 0.9), ("tall", -0.9)])
def test_spatial_extent_does_not_change_the_height_of_pinch_and_tall_gestures(robot, name, extent):
    neutral, wide = (
        poses(Lexicon.load().forms_by_id[name], robot, replace(NEUTRAL_EXPRESSIVITY, spatial=spatial)).hands["r"][-1]
        for spatial in (0.0, extent)
    )
    assert neutral.reach.position[2] == pytest.approx(wide.reach.position[2])
