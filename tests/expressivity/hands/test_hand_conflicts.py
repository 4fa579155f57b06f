"""Tests of the hand assignment when another gesture needs the hand."""

import pytest

from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.expressivity.hands.keys import hand_at
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import REST_HAND, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import Stroke

from .reached_hands import FREE_STROKES, A, B, C, L, M, both, right


def test_two_handed_gesture_is_performed_with_one_hand_if_the_other_is_busy(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B, C),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (both(),))
    arrangement = arrange_hands([first, second], pace)
    assert arrangement.sides == {"g1": {"r"}, "g2": {"l"}}
    assert arrangement.outcomes["g2"].kind == "substituted"
    assert "left hand alone" in arrangement.outcomes["g2"].why


def test_two_handed_gesture_gives_one_hand_to_a_later_gesture(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    arrangement = arrange_hands([first, second], pace)
    assert arrangement.sides == {"g1": {"l"}, "g2": {"r"}}
    assert arrangement.outcomes.keys() == {"g1"}
    assert "the right hand does g2" in arrangement.outcomes["g1"].why
    assert {key.time for key in arrangement.hands["r"] if key.hand is not REST_HAND} == {1.0, 1.2, 1.4}


def test_two_handed_gesture_gives_away_only_one_hand(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    third = Stroke("g3", phases(0.4, 1.0, 1.0, 1.3, 1.3, 1.4, 2.0), (Poses({"l": (M, L)}, 1),))
    arrangement = arrange_hands([first, second, third], pace)
    assert arrangement.outcomes["g3"].kind == "dropped"
    assert arrangement.sides == {"g1": {"l"}, "g2": {"r"}}


@pytest.fixture
def either(phases):
    """Return a gesture of the right or, if necessary, the left hand."""
    return Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B), Poses({"l": (L, M)}, 1)))


BUSY_RIGHT, BUSY_LEFT = BusyHand("r", 0.2, 1.1, "a:g"), BusyHand("l", 1.0, 1.3, "a:h")


def test_gesture_avoids_busy_hand_of_another_block_and_reports_it(pace, either):
    arrangement = arrange_hands([either], pace, busy_hands=[BUSY_RIGHT])
    assert arrangement.sides == {"g1": {"l"}}
    assert arrangement.outcomes["g1"].kind == "substituted"
    why = (
        "moved to the left hand: its stroke begins at 0.60 s, the right hand is busy with a:g until 1.10 s, and needs "
    )
    assert arrangement.outcomes["g1"].why.startswith(why)


@pytest.mark.parametrize("sooner", [0.0, 0.01])
def test_busy_hand_is_available_only_after_the_travel_time_to_the_new_pose(pace, either, sooner):
    way = pace.least_hand_time(pose_distance(REST_HAND, A, resting_hands(pace.robot)["r"]))
    before, after = BusyHand("r", -5.0, 0.6 - way + sooner, "a:g"), BusyHand("r", 1.5 + way - sooner, 9.0, "a:g")
    for other in (before, after):
        arrangement = arrange_hands([either], pace, busy_hands=[other])
        assert arrangement.sides == {"g1": {"l"} if sooner else {"r"}}
        assert (arrangement.outcomes != {}) == (sooner > 0.0)


def test_gesture_uses_its_preferred_hand_if_other_blocks_use_both_hands(pace, either):
    arrangement = arrange_hands([either], pace, busy_hands=[BUSY_RIGHT, BUSY_LEFT])
    assert arrangement.sides == {"g1": {"r"}}
    assert arrangement.outcomes == {}


def test_gesture_restricted_to_one_hand_uses_it_even_if_busy_in_another_block(pace, phases):
    fixed = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B),))
    arrangement = arrange_hands([fixed], pace, busy_hands=[BUSY_RIGHT])
    assert arrangement.sides == {"g1": {"r"}}
    assert arrangement.outcomes == {}


@pytest.mark.parametrize(("other", "left"), [(BUSY_RIGHT, "l"), (BUSY_LEFT, "r")])
def test_splittable_gesture_gives_one_hand_to_another_block(pace, phases, other, left):
    stroke = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),), may_split=True)
    arrangement = arrange_hands([stroke], pace, busy_hands=[other])
    assert arrangement.sides == {"g1": {left}}
    hand = {"l": "left", "r": "right"}[left]
    assert arrangement.outcomes["g1"].why.startswith(
        f"done by the {hand} hand alone: its stroke begins at 0.60 s, the "
    )
    assert f"busy with {other.by}" in arrangement.outcomes["g1"].why


def test_unsplittable_gesture_keeps_both_hands(pace, phases):
    stroke = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    arrangement = arrange_hands([stroke], pace, busy_hands=[BUSY_RIGHT])
    assert arrangement.sides == {"g1": {"l", "r"}}
    assert arrangement.outcomes == {}


def test_rest_pose_uses_its_hand_even_if_busy_in_another_block(pace, either):
    folded = Stroke("p", either.times, either.options, rest=True)
    assert arrange_hands([folded], pace, busy_hands=[BUSY_RIGHT]).sides == {"p": {"r"}}


def test_overlapping_gestures_are_moved_apart_on_the_hand_unused_by_other_blocks(pace, overlapping):
    mirrored = [Poses({"l": tuple(reversed(row))}, 1) for row in ((M, L, M), (L, M))]
    open_ = [
        Stroke(stroke.id, stroke.times, (*stroke.options, other))
        for stroke, other in zip(overlapping, mirrored, strict=True)
    ]
    arrangement = arrange_hands(open_, pace, FREE_STROKES, busy_hands=[BusyHand("r", 0.0, 9.0, "a:g")])
    assert arrangement.sides == {"g1": {"l"}, "g2": {"l"}}
    assert {outcome.kind for outcome in arrangement.outcomes.values()} == {"substituted"}
    assert "the right hand is busy with a:g" in arrangement.outcomes["g2"].why


def test_strokes_are_moved_apart_rather_than_using_a_busy_hand(pace, overlapping):
    first, second = overlapping
    second = Stroke(second.id, second.times, (*second.options, Poses({"l": (L, M)}, 1)))
    assert arrange_hands([first, second], pace, FREE_STROKES).sides["g2"] == {"l"}
    arrangement = arrange_hands([first, second], pace, FREE_STROKES, busy_hands=[BusyHand("l", 0.0, 9.0, "a:g")])
    assert arrangement.sides["g2"] == {"r"}
    assert arrangement.outcomes == {}


def test_gestures_of_different_hands_overlap_freely(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B),))
    second = Stroke("g2", phases(0.1, 0.6, 0.6, 1.1, 1.4, 1.5, 2.2), (Poses({"l": (L, M)}, 1),))
    arrangement = arrange_hands([first, second], pace)
    assert arrangement.outcomes == {}
    assert arrangement.sides == {"g1": {"r"}, "g2": {"l"}}


def test_reason_for_a_gesture_reduced_to_one_hand_names_the_conflicting_stroke(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B, C),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (both(),))
    assert "busy with the stroke of g1 until 1.40 s" in arrange_hands([first, second], pace).outcomes["g2"].why


def test_released_hand_keeps_no_key_of_the_two_handed_gesture(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    arrangement = arrange_hands([first, second], pace)
    (work,) = [work for work in arrangement.works if work.id == "g1"]
    assert work.poses.hands.keys() == {"l"}
    assert hand_at(arrangement.hands["l"], 1.0, resting_hands(pace.robot)["l"]) is M
