"""Which hand does a gesture where another one needs it."""

import pytest

from kinesic.expressivity.hands.engaged import Engaged
from kinesic.expressivity.hands.keys import hand_at
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import REST, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import Stroke

from .reached_hands import FREE, A, B, C, L, M, both, right


def test_a_two_handed_gesture_beside_an_earlier_one_is_done_by_the_free_hand(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B, C),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (both(),))
    found = arrange_hands([first, second], pace)
    assert found.sides == {"g1": {"r"}, "g2": {"l"}}
    assert found.outcomes["g2"].kind == "substituted"
    assert "left hand alone" in found.outcomes["g2"].why


def test_a_two_handed_gesture_leaves_a_hand_to_a_later_one(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    found = arrange_hands([first, second], pace)
    assert found.sides == {"g1": {"l"}, "g2": {"r"}}
    assert found.outcomes.keys() == {"g1"}
    assert "the right hand does g2" in found.outcomes["g1"].why
    assert {key.time for key in found.hands["r"] if key.hand is not REST} == {1.0, 1.2, 1.4}


def test_one_hand_is_left_away_only_once(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    third = Stroke("g3", phases(0.4, 1.0, 1.0, 1.3, 1.3, 1.4, 2.0), (Poses({"l": (M, L)}, 1),))
    found = arrange_hands([first, second, third], pace)
    assert found.outcomes["g3"].kind == "dropped"
    assert found.sides == {"g1": {"l"}, "g2": {"r"}}


@pytest.fixture
def either(phases):
    """A gesture of the right hand or, if need be, of the left."""
    return Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B), Poses({"l": (L, M)}, 1)))


RIGHT, LEFT = Engaged("r", 0.2, 1.1, "a:g"), Engaged("l", 1.0, 1.3, "a:h")


def test_a_gesture_leaves_a_hand_to_another_block_and_says_so(pace, either):
    found = arrange_hands([either], pace, engaged=[RIGHT])
    assert found.sides == {"g1": {"l"}}
    assert found.outcomes["g1"].kind == "substituted"
    why = (
        "moved to the left hand: its stroke begins at 0.60 s, the right hand is busy with a:g until 1.10 s, and needs "
    )
    assert found.outcomes["g1"].why.startswith(why)


@pytest.mark.parametrize("sooner", [0.0, 0.01])
def test_a_hand_is_free_as_soon_as_it_has_the_time_to_come(pace, either, sooner):
    way = pace.least_hand_time(pose_distance(REST, A, resting_hands(pace.robot)["r"]))
    before, after = Engaged("r", -5.0, 0.6 - way + sooner, "a:g"), Engaged("r", 1.5 + way - sooner, 9.0, "a:g")
    for other in (before, after):
        found = arrange_hands([either], pace, engaged=[other])
        assert found.sides == {"g1": {"l"} if sooner else {"r"}}
        assert (found.outcomes != {}) == (sooner > 0.0)


def test_a_gesture_whose_hands_are_all_needed_elsewhere_is_as_without(pace, either):
    found = arrange_hands([either], pace, engaged=[RIGHT, LEFT])
    assert found.sides == {"g1": {"r"}}
    assert found.outcomes == {}


def test_a_gesture_of_one_hand_never_goes_to_the_other(pace, phases):
    fixed = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B),))
    found = arrange_hands([fixed], pace, engaged=[RIGHT])
    assert found.sides == {"g1": {"r"}}
    assert found.outcomes == {}


@pytest.mark.parametrize(("other", "left"), [(RIGHT, "l"), (LEFT, "r")])
def test_a_gesture_of_two_hands_leaves_one_to_another_block(pace, phases, other, left):
    stroke = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),), halves=True)
    found = arrange_hands([stroke], pace, engaged=[other])
    assert found.sides == {"g1": {left}}
    hand = {"l": "left", "r": "right"}[left]
    assert found.outcomes["g1"].why.startswith(f"done by the {hand} hand alone: its stroke begins at 0.60 s, the ")
    assert f"busy with {other.by}" in found.outcomes["g1"].why


def test_a_gesture_that_must_have_two_hands_keeps_them(pace, phases):
    stroke = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    found = arrange_hands([stroke], pace, engaged=[RIGHT])
    assert found.sides == {"g1": {"l", "r"}}
    assert found.outcomes == {}


def test_a_rest_pose_does_not_mind_what_other_blocks_need(pace, either):
    folded = Stroke("p", either.times, either.options, rest=True)
    assert arrange_hands([folded], pace, engaged=[RIGHT]).sides == {"p": {"r"}}


def test_of_two_gestures_beside_another_block_one_makes_room_on_the_free_hand(pace, overlapping):
    mirrored = [Poses({"l": tuple(reversed(row))}, 1) for row in ((M, L, M), (L, M))]
    open_ = [
        Stroke(stroke.id, stroke.times, (*stroke.options, other))
        for stroke, other in zip(overlapping, mirrored, strict=True)
    ]
    found = arrange_hands(open_, pace, FREE, engaged=[Engaged("r", 0.0, 9.0, "a:g")])
    assert found.sides == {"g1": {"l"}, "g2": {"l"}}
    assert {outcome.kind for outcome in found.outcomes.values()} == {"substituted"}
    assert "the right hand is busy with a:g" in found.outcomes["g2"].why


def test_a_gesture_makes_room_rather_than_take_a_hand_that_another_block_needs(pace, overlapping):
    first, second = overlapping
    second = Stroke(second.id, second.times, (*second.options, Poses({"l": (L, M)}, 1)))
    assert arrange_hands([first, second], pace, FREE).sides["g2"] == {"l"}
    found = arrange_hands([first, second], pace, FREE, engaged=[Engaged("l", 0.0, 9.0, "a:g")])
    assert found.sides["g2"] == {"r"}
    assert found.outcomes == {}


def test_gestures_of_different_hands_are_done_together(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B),))
    second = Stroke("g2", phases(0.1, 0.6, 0.6, 1.1, 1.4, 1.5, 2.2), (Poses({"l": (L, M)}, 1),))
    found = arrange_hands([first, second], pace)
    assert found.outcomes == {}
    assert found.sides == {"g1": {"r"}, "g2": {"l"}}


def test_one_hand_alone_is_said_to_be_kept_from_the_other_by_another_stroke(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B, C),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (both(),))
    assert "busy with the stroke of g1 until 1.40 s" in arrange_hands([first, second], pace).outcomes["g2"].why


def test_a_hand_that_leaves_a_two_handed_gesture_keeps_no_key_of_it(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    found = arrange_hands([first, second], pace)
    (work,) = [work for work in found.works if work.id == "g1"]
    assert work.poses.hands.keys() == {"l"}
    assert hand_at(found.hands["l"], 1.0, resting_hands(pace.robot)["l"]) is M
