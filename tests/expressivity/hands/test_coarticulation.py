from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.hands.engaged import Clash, Engaged
from kinesic.expressivity.hands.keys import hand_at
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import REST, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import Stroke, least_stroke_times
from kinesic.expressivity.keyframes import Hand

FREE = {"g1": frozenset({"stroke"}), "g2": frozenset({"stroke"})}


def reach(x, y, z):
    return Hand(Reach(sealed([x, y, z])))


A, B, C = reach(0.25, -0.1, 0.8), reach(0.25, -0.2, 0.75), reach(0.25, -0.3, 0.85)
L, M = reach(0.25, 0.2, 0.8), reach(0.25, 0.3, 0.75)


def right(*hands):
    return Poses({"r": hands}, stroke=len(hands) // 2)


def both():
    return Poses({"l": (L, M), "r": (A, B)}, stroke=1)


@pytest.fixture
def overlapping(phases):
    """Two gestures of one hand, the later's stroke beginning before the earlier's has ended."""
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.9, 2.0, 2.6), (right(A, B, C),))
    second = Stroke("g2", phases(1.0, 1.6, 1.6, 2.6, 2.6, 2.8, 3.4), (right(C, A),))
    return [first, second]


def test_strokes_that_overlap_make_room_when_the_document_lets_them(pace, overlapping):
    found = arrange_hands(overlapping, pace, FREE)
    assert found.outcomes == {}
    moved = found.times
    assert 1.0 < moved["g1"]["strokeEnd"] <= moved["g2"]["strokeStart"] < 2.6
    assert moved["g1"].keys() == {"strokeEnd", "relax", "end"}
    assert moved["g2"].keys() == {"strokeStart"}
    keys = found.hands["r"]
    at = {key.time: key.hand for key in keys}
    assert at[1.0] is B
    assert at[2.6] is A
    assert at[moved["g1"]["strokeEnd"]] is C
    assert at[moved["g2"]["strokeStart"]] is C


def test_what_makes_room_keeps_what_servos_need(pace, overlapping):
    moved = arrange_hands(overlapping, pace, FREE).times
    after = least_stroke_times(right(A, B, C), pace)[1]
    before = least_stroke_times(right(C, A), pace)[0]
    assert moved["g1"]["strokeEnd"] - 1.0 >= after - 1e-9
    assert 2.6 - moved["g2"]["strokeStart"] >= before - 1e-9


@pytest.mark.parametrize(
    ("tied", "moving"),
    [({"g1": {"stroke", "strokeEnd"}}, {"g2"}), ({"g2": {"stroke", "strokeStart"}}, {"g1"})],
)
def test_only_what_the_document_leaves_open_moves(pace, overlapping, tied, moving):
    found = arrange_hands(overlapping, pace, FREE | tied)
    assert found.outcomes == {}
    assert {id for id, times in found.times.items() if times.keys() - {"relax", "end"}} == moving


def test_what_is_placed_where_it_overlaps_is_dropped_and_named(pace, overlapping):
    tied = {"g1": {"stroke", "strokeEnd"}, "g2": {"stroke", "strokeStart"}}
    found = arrange_hands(overlapping, pace, tied)
    assert found.outcomes["g2"].kind == "dropped"
    assert "busy with the stroke of g1 until 1.90 s" in found.outcomes["g2"].why


def test_strokes_that_are_nearer_than_servos_can_do_are_dropped(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.9, 2.0, 2.6), (right(A, B, C),))
    second = Stroke("g2", phases(0.2, 0.8, 0.8, 1.02, 1.2, 1.4, 2), (right(C, A),))
    assert arrange_hands([first, second], pace, FREE).outcomes["g2"].kind == "dropped"


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


def test_a_stroke_is_not_repeated_over_the_word_of_a_rest_pose(pace, phases):
    twice = Poses({"r": (A, B, A, B)}, stroke=1, again=(3,))
    beating = Stroke("g", phases(0, 1, 1, 1.5, 4.0, 4.2, 5.0), (twice,))
    folded = Stroke("p", phases(2.0, 2.8, 2.8, 3.0, 3.0, 3.0, 3.5), (right(C),), rest=True)
    found = arrange_hands([beating, folded], pace, tied := {id: frozenset({"stroke"}) for id in "gp"})
    assert next(work for work in found.works if work.id == "g").at("strokeEnd") < 2.8
    assert hand_at(found.hands["r"], 3.0, resting_hands(pace.robot)["r"]).reach is C.reach
    asked = arrange_hands([beating, folded], pace, {**tied, "g": frozenset({"stroke", "strokeEnd"})}).works
    assert next(work for work in asked if work.id == "g").poses.times == 2, "where the document says when it ends"


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


def test_a_retraction_becomes_the_preparation_of_the_next(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 2.0), (right(A, B),))
    second = Stroke("g2", phases(1.5, 2.1, 2.1, 2.5, 2.5, 2.7, 3.3), (right(C, A),))
    keys = arrange_hands([first, second], pace).hands["r"]
    inner = [key.hand for key in keys[1:-1]]
    assert REST not in inner
    hold = max(key.time for key in keys if key.hand is B)
    assert 1.2 <= hold < 2.1


def test_no_time_to_wait_means_going_straight_to_the_stroke(pace, phases):
    """A `ready` that the hand cannot reach from the stroke before is passed over, not jumped to."""
    far = reach(0.3, -0.5, 1.0)
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 2.0), (right(A, B),))
    second = Stroke("g2", phases(0.5, 1.05, 1.6, 2.0, 2.0, 2.2, 2.8), (right(far, A),))
    keys = arrange_hands([first, second], pace).hands["r"]
    assert [key.time for key in keys if key.hand is far] == [1.6]


def test_hands_never_jump_and_every_stroke_is_met(pace, phases):
    """However gestures fall, a hand has one place at a time and is at each stroke that is not dropped."""
    rng, rest = np.random.default_rng(7), resting_hands(pace.robot)
    for _ in range(40):
        strokes = []
        for k in range(5):
            start = rng.uniform(0, 5)
            times = start + np.cumsum([0, *rng.uniform(0, 0.7, 6)])
            hands = [reach(0.25, *rng.uniform((-0.3, 0.7), (-0.1, 0.9))) for _ in range(rng.integers(2, 4))]
            options = (right(*hands),) if rng.random() < 0.7 else (both(),)
            strokes.append(Stroke(f"g{k}", phases(*times), options))
        found = arrange_hands(strokes, pace, {stroke.id: {"stroke"} for stroke in strokes})
        for side, keys in found.hands.items():
            assert all(b.time - a.time > 1e-6 for a, b in pairwise(keys))
            for stroke in strokes:
                dropped = found.outcomes.get(stroke.id)
                if side in found.sides.get(stroke.id, ()):
                    hand = hand_at(keys, stroke.times["stroke"], rest[side])
                    assert any(hand is row[k] for row in stroke.options[0].hands.values() for k in range(len(row)))
                elif side in stroke.options[0].hands:
                    assert dropped is not None
                    assert dropped.why


@pytest.fixture
def crossing(phases):
    """Two gestures of the same hand whose strokes the document places upon one another."""
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    return [first, second]


@pytest.mark.parametrize(("ranks", "left"), [((1, 1), "g1"), ((0, 1), "g2"), ((1, 0), "g1"), ((1, 2), "g2")])
def test_what_counts_for_less_gives_way_or_else_the_later(pace, crossing, ranks, left):
    found = arrange_hands([replace(s, importance=rank) for s, rank in zip(crossing, ranks, strict=True)], pace)
    assert found.sides.keys() == {left}
    (dropped,) = found.outcomes
    assert found.outcomes[dropped].kind == "dropped"
    assert left in found.outcomes[dropped].why
    assert ("counts for more" in found.outcomes[dropped].why) == (left == "g2")


def test_what_made_room_for_a_stroke_that_gave_way_has_its_times_back(pace, overlapping, phases):
    first, second = overlapping
    third = Stroke("g3", phases(2.2, 2.5, 2.5, 2.8, 2.8, 3.0, 3.4), (right(B, A),))
    assert "g1" in arrange_hands(overlapping, pace, FREE).times
    found = arrange_hands([first, replace(second, importance=0), third], pace, FREE)
    alone = arrange_hands([first, third], pace, FREE)
    assert found.outcomes.keys() == {"g2"}
    assert found.times == alone.times
    assert [key.time for key in found.hands["r"]] == [key.time for key in alone.hands["r"]]


def test_a_dropped_stroke_says_when_there_would_be_time(pace, crossing):
    first, second = crossing
    for clashes, apart in (({}, 0.0), ({frozenset(("g1", "g2")): Clash(0.5)}, 1.0)):
        late = replace(second, times={sync: time + apart for sync, time in second.times.items()})
        why = arrange_hands([first, late], pace, clashes=clashes).outcomes["g2"].why
        at = float(why.split("with its stroke at ")[1].split(" s")[0])
        assert at > late.times["stroke"]
        good = {sync: time + at + 0.005 - late.times["stroke"] for sync, time in late.times.items()}
        assert arrange_hands([first, replace(late, times=good)], pace).outcomes == {}


def test_strokes_that_clash_count_as_overlapping(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 2.0), (right(A, B),))
    second = Stroke("g2", phases(1.2, 1.5, 1.5, 1.8, 1.8, 2.0, 2.6), (right(C, A),))
    clashes = {frozenset(("g1", "g2")): Clash(0.31)}
    assert arrange_hands([first, second], pace).outcomes == {}
    found = arrange_hands([first, second], pace, clashes=clashes)
    why = "its stroke is at 1.80 s, from that of g1 at 1.00 s the right hand comes 0.31 s late"
    assert found.outcomes["g2"].why == f"{why}; with its stroke at 2.11 s there would be time"
    either = replace(second, options=(*second.options, Poses({"l": (L, M)}, 1)))
    found = arrange_hands([first, either], pace, clashes=clashes)
    assert found.sides == {"g1": {"r"}, "g2": {"l"}}


def test_one_hand_alone_is_said_to_be_kept_from_the_other_by_another_stroke(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B, C),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (both(),))
    assert "busy with the stroke of g1 until 1.40 s" in arrange_hands([first, second], pace).outcomes["g2"].why


@pytest.fixture
def counting(phases):
    """Two numbers of a series whose strokes overlap, each either on the right or on the left hand."""
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.6, 1.7, 2.4), (right(A, B, C),), series="count")
    second = Stroke("g2", phases(0.8, 1.2, 1.2, 1.3, 1.9, 2.0, 2.6), (right(C, A, B),), series="count")
    return [first, second]


def test_numbers_that_overlap_are_shown_once_at_their_words(pace, counting):
    found = arrange_hands(counting, pace, FREE)
    assert not any(outcome.kind == "dropped" for outcome in found.outcomes.values())
    for stroke in counting:
        (work,) = [work for work in found.works if work.id == stroke.id]
        assert work.at("stroke") == pytest.approx(stroke.times["stroke"])


def test_numbers_whose_strokes_the_document_places_are_not_shortened(pace, counting):
    tied = {id: frozenset({"strokeStart", "stroke", "strokeEnd"}) for id in ("g1", "g2")}
    found = arrange_hands(counting, pace, tied)
    assert found.outcomes["g2"].kind == "dropped"
    assert found.outcomes.keys() == {"g2"}


def test_a_hand_that_leaves_a_two_handed_gesture_keeps_no_key_of_it(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (both(),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    found = arrange_hands([first, second], pace)
    (work,) = [work for work in found.works if work.id == "g1"]
    assert work.poses.hands.keys() == {"l"}
    assert hand_at(found.hands["l"], 1.0, resting_hands(pace.robot)["l"]) is M
