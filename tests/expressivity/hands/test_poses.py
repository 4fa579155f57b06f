"""Hands in the world: stroke keys of forms, pointing, and distances."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.poses import (
    REST,
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
from kinesic.expressivity.lexicon.paths import shape_path
from kinesic.expressivity.lexicon.space import EASY_REACH, to_world
from kinesic.expressivity.style.style import NEUTRAL, Expressivity

A, B, C = (0.4, 0.3, 0.1), (0.4, 0.5, 0.3), (0.5, 0.2, 0.5)


def form(*keys, category="iconic", **fields) -> GestureForm:
    """A form from keys {side: position}."""
    poses_ = [StrokeKey({side: HandPose(sealed(place)) for side, place in key.items()}) for key in keys]
    return GestureForm("x", category, tuple(poses_), **fields)


def places(work: Poses, side: str) -> list:
    return [None if hand.reach is None else hand.reach.position for hand in work.hands[side]]


def test_keys_of_a_form_are_where_it_puts_them(robot):
    work = poses(form({"l": A, "r": A}, {"l": B, "r": C}), robot, NEUTRAL)
    for side, last in (("l", B), ("r", C)):
        np.testing.assert_allclose(places(work, side), [to_world(robot, side, place) for place in (A, last)])
    assert (work.count, work.stroke, work.times) == (2, 1, 1)


def test_a_form_of_one_key_begins_nearer_to_rest(robot):
    work = poses(form({"r": A}), robot, NEUTRAL)
    there, rest = to_world(robot, "r", sealed(A)), resting_hands(robot)["r"].position
    np.testing.assert_allclose(places(work, "r"), [there + 0.15 * (rest - there), there])
    assert (work.count, work.stroke) == (2, 1)


def test_a_hand_that_a_key_leaves_out_stays(robot):
    work = poses(form({"r": A}, {"r": B, "l": C}, {"r": C}), robot, NEUTRAL)
    first, second, third = work.hands["l"]
    assert first is REST
    assert second is third
    np.testing.assert_allclose(second.reach.position, to_world(robot, "l", sealed(C)))


@pytest.mark.parametrize(("repetition", "times"), [(-1.0, 1), (0.0, 1), (0.2, 1), (0.5, 2), (1.0, 3)])
def test_repetition_does_the_stroke_up_to_twice_more(robot, repetition, times):
    work = poses(form({"r": A}, {"r": B}), robot, Expressivity(repetition=repetition))
    assert work.times == times
    assert (work.count, work.stroke, work.again) == (2 * times, 1, tuple(range(3, 2 * times, 2)))
    once = poses(form({"r": A}, {"r": B}), robot, NEUTRAL).hands["r"]
    assert [hand.reach.position.tolist() for hand in work.hands["r"]] == times * [
        hand.reach.position.tolist() for hand in once
    ]


@pytest.mark.parametrize(("repetition", "times"), [(-1.0, 2), (-0.4, 3), (0.0, 3), (1.0, 5)])
def test_a_form_that_is_written_three_times_is_done_once_less_without_repetition(robot, repetition, times):
    work = poses(form(*3 * [{"r": A}, {"r": B}]), robot, Expressivity(repetition=repetition))
    assert work.times == times


def test_a_stroke_that_ends_where_it_begins_shares_that_key_with_the_next(robot):
    work = poses(form({"r": A}, {"r": B}, {"r": A}), robot, Expressivity(repetition=1.0))
    assert (work.count, work.stroke, work.again) == (7, 1, (3, 5))
    assert all(not np.allclose(a, b) for a, b in pairwise(places(work, "r")))
    one_hand = poses(form({"r": A}, {"r": B, "l": B}, {"r": A}), robot, Expressivity(repetition=1.0))
    assert one_hand.count == 9, "the left hand does not end where it begins"


@pytest.mark.parametrize("fields", [{"rest": True}, {"category": "rest", "rest": True}])
def test_a_rest_pose_is_taken_once(robot, fields):
    work = poses(form({"r": A}, {"r": B}, **fields), robot, Expressivity(repetition=1.0))
    assert (work.times, work.count) == (1, 2)


def test_the_last_repetition_can_be_left_out(robot):
    work = poses(form({"r": A, "l": A}, {"r": B, "l": C}, {"r": A, "l": A}), robot, Expressivity(repetition=1.0))
    fewer = work.fewer()
    assert (fewer.times, fewer.again, fewer.count) == (2, (3,), 5)
    assert fewer.hands["r"] == work.hands["r"][:5]
    assert len(fewer.paths["l"]) == 5


def test_shoulders_rise_by_half_before_the_stroke_and_wholly_from_it(robot):
    work = poses(form({"r": A}, {"r": B}, {"r": C}, body=BodyForm(shoulders=0.4)), robot, NEUTRAL)
    assert [hand.lift for hand in work.hands["r"]] == [0.2, 0.4, 0.4]


@pytest.mark.parametrize(("spread", "travels"), [(0.2, False), (0.3, True)])
def test_a_gesture_is_dynamic_from_a_quarter_of_an_arm_on(robot, spread, travels):
    work = poses(form({"r": A}, {"r": (A[0], A[1] + spread, A[2])}), robot, NEUTRAL)
    assert work.nature.dynamic is travels


def with_path(amplitude: float, last=A) -> GestureForm:
    path = shape_path("circle", amplitude=(amplitude, 0.0, amplitude))
    key = StrokeKey({"r": HandPose(sealed(last), path=path)})
    return GestureForm("x", "iconic", (StrokeKey({"r": HandPose(sealed(A))}), key))


def test_a_path_grows_with_spatial_extent_as_far_as_the_arm_reaches_easily(robot):
    centre, easy = shoulder(robot, "r"), EASY_REACH * robot.arm_length
    widths = []
    for spatial in (-1.0, 0.0, 1.0):
        work = poses(with_path(0.2), robot, Expressivity(spatial=spatial))
        path, (start, end) = work.path("r", 1), places(work, "r")
        way = path.at(start, end, np.linspace(0.0, 1.0, 50))
        widths.append(np.ptp(way, axis=0).max())
        assert np.linalg.norm(way - centre, axis=1).max() <= max(easy, widths[0] + 1.0)
    assert widths == sorted(widths)
    assert widths[0] < widths[1]
    assert work.path("r", 0) is None
    assert work.path("l", 0) is None


def test_only_one_hand_can_be_kept(robot):
    work = poses(form({"r": A, "l": A}, {"r": B, "l": C}), robot, NEUTRAL)
    left = work.only("l")
    assert (left.hands.keys(), left.paths.keys()) == ({"l"}, {"l"})
    assert left.hands["l"] is work.hands["l"]


@pytest.mark.parametrize("side", SIDES)
def test_a_hand_that_points_lies_on_the_line_from_its_shoulder(robot, side):
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
        assert (work.stroke, hand.shape, work.nature.dynamic) == (1, "index", False)


def test_pointing_at_the_own_shoulder_is_pointing_forward(robot):
    hand = pointing_poses(shoulder(robot, "r"), "r", robot).hands["r"][-1]
    np.testing.assert_allclose(hand.reach.pointing, [1.0, 0.0, 0.0])
    np.testing.assert_allclose(hand.reach.position, shoulder(robot, "r"))


def test_a_withdrawn_hand_touches_nothing(robot):
    touching = Hand(Reach(sealed([0.3, 0.0, 0.8])), touch="lap", tip="index", shape="fist")
    away = withdrawn(touching, robot, "l")
    assert (away.touch, away.tip, away.shape) == (None, None, "fist")
    assert withdrawn(REST, robot, "l") is REST


def test_the_way_between_poses_is_that_of_the_wrist_or_of_turning_the_hand(robot):
    rest = resting_hands(robot)["r"]
    here = Hand(Reach(rest.position, pointing=sealed([1.0, 0.0, 0.0]), palm=sealed([0.0, 0.0, -1.0])))
    there = replace(here, reach=Reach(rest.position + 0.1, pointing=here.reach.pointing, palm=here.reach.palm))
    over = replace(here, reach=Reach(rest.position, pointing=here.reach.pointing, palm=sealed([0.0, 0.0, 1.0])))
    aside = replace(here, reach=Reach(rest.position, pointing=sealed([0.0, 1.0, 0.0]), palm=here.reach.palm))
    assert pose_distance(here, here, rest) == 0.0
    assert pose_distance(here, there, rest) == pytest.approx(0.1 * np.sqrt(3))
    assert pose_distance(here, over, rest) == pose_distance(over, here, rest) == pytest.approx(0.15 * np.pi)
    assert pose_distance(here, aside, rest) == pytest.approx(0.15 * np.pi / 2)
    assert pose_distance(REST, REST, rest) == pytest.approx(0.0, abs=1e-7)  # an arc cosine near 1


def test_hands_hang_where_the_robot_rests(robot):
    rest = resting_hands(robot)
    for side in SIDES:
        palm = robot.arm(side).palm
        np.testing.assert_allclose(
            rest[side].position, robot.skeleton.resting.origins[robot.skeleton.segment(palm.segment)]
        )
        assert rest[side].pointing[2] < -0.8
        assert [np.linalg.norm(way) for way in (rest[side].pointing, rest[side].palm)] == pytest.approx([1.0, 1.0])
    np.testing.assert_allclose(rest["l"].palm, rest["r"].palm * [1, -1, 1], atol=1e-9)
