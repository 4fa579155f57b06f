from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.expressivity.hands.busy_hands import Clash
from kinesic.expressivity.hands.keys import hand_at
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import REST_HAND, Poses, resting_hands
from kinesic.expressivity.hands.strokes import Stroke, least_stroke_times

from .reached_hands import FREE_STROKES, A, B, C, L, M, both, reach, right


def test_overlapping_gesture_strokes_with_free_times_are_moved_apart(pace, overlapping):
    arrangement = arrange_hands(overlapping, pace, FREE_STROKES)
    assert arrangement.outcomes == {}
    moved = arrangement.times
    assert 1.0 < moved["g1"]["strokeEnd"] <= moved["g2"]["strokeStart"] < 2.6
    assert moved["g1"].keys() == {"strokeEnd", "relax", "end"}
    assert moved["g2"].keys() == {"strokeStart"}
    keys = arrangement.hands["r"]
    at = {key.time: key.hand for key in keys}
    assert at[1.0] is B
    assert at[2.6] is A
    assert at[moved["g1"]["strokeEnd"]] is C
    assert at[moved["g2"]["strokeStart"]] is C


def test_shortened_gesture_strokes_take_at_least_the_minimum_servo_time(pace, overlapping):
    moved = arrange_hands(overlapping, pace, FREE_STROKES).times
    after = least_stroke_times(right(A, B, C), pace)[1]
    before = least_stroke_times(right(C, A), pace)[0]
    assert moved["g1"]["strokeEnd"] - 1.0 >= after - 1e-9
    assert 2.6 - moved["g2"]["strokeStart"] >= before - 1e-9


@pytest.mark.parametrize(
    ("fixed_syncs", "moving"),
    [({"g1": {"stroke", "strokeEnd"}}, {"g2"}), ({"g2": {"stroke", "strokeStart"}}, {"g1"})],
)
def test_overlapping_strokes_are_resolved_by_moving_only_free_sync_points(pace, overlapping, fixed_syncs, moving):
    arrangement = arrange_hands(overlapping, pace, FREE_STROKES | fixed_syncs)
    assert arrangement.outcomes == {}
    assert {id for id, times in arrangement.times.items() if times.keys() - {"relax", "end"}} == moving


def test_overlapping_stroke_with_fixed_times_is_dropped_with_a_reason(pace, overlapping):
    fixed_syncs = {"g1": {"stroke", "strokeEnd"}, "g2": {"stroke", "strokeStart"}}
    arrangement = arrange_hands(overlapping, pace, fixed_syncs)
    assert arrangement.outcomes["g2"].kind == "dropped"
    assert "busy with the stroke of g1 until 1.90 s" in arrangement.outcomes["g2"].why


def test_gesture_stroke_too_soon_for_the_servos_after_another_stroke_is_dropped(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.9, 2.0, 2.6), (right(A, B, C),))
    second = Stroke("g2", phases(0.2, 0.8, 0.8, 1.02, 1.2, 1.4, 2), (right(C, A),))
    assert arrange_hands([first, second], pace, FREE_STROKES).outcomes["g2"].kind == "dropped"


def test_stroke_repetition_ends_before_a_rest_pose_unless_its_end_time_is_fixed(pace, phases):
    twice = Poses({"r": (A, B, A, B)}, stroke=1, again=(3,))
    beating = Stroke("g", phases(0, 1, 1, 1.5, 4.0, 4.2, 5.0), (twice,))
    folded = Stroke("p", phases(2.0, 2.8, 2.8, 3.0, 3.0, 3.0, 3.5), (right(C),), rest=True)
    arrangement = arrange_hands([beating, folded], pace, fixed_syncs := {id: frozenset({"stroke"}) for id in "gp"})
    assert next(work for work in arrangement.works if work.id == "g").at("strokeEnd") < 2.8
    assert hand_at(arrangement.hands["r"], 3.0, resting_hands(pace.robot)["r"]).reach is C.reach
    asked = arrange_hands([beating, folded], pace, {**fixed_syncs, "g": frozenset({"stroke", "strokeEnd"})}).works
    assert next(work for work in asked if work.id == "g").poses.stroke_count == 2, (
        "where the document says when it ends"
    )


def test_retraction_becomes_preparation_of_the_next_stroke(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 2.0), (right(A, B),))
    second = Stroke("g2", phases(1.5, 2.1, 2.1, 2.5, 2.5, 2.7, 3.3), (right(C, A),))
    keys = arrange_hands([first, second], pace).hands["r"]
    inner = [key.hand for key in keys[1:-1]]
    assert REST_HAND not in inner
    hold = max(key.time for key in keys if key.hand is B)
    assert 1.2 <= hold < 2.1


def test_hand_has_no_key_at_a_ready_sync_point_that_it_cannot_reach_in_time(pace, phases):
    """Skip a `ready` that the hand cannot reach after the preceding stroke."""
    far = reach(0.3, -0.5, 1.0)
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 2.0), (right(A, B),))
    second = Stroke("g2", phases(0.5, 1.05, 1.6, 2.0, 2.0, 2.2, 2.8), (right(far, A),))
    keys = arrange_hands([first, second], pace).hands["r"]
    assert [key.time for key in keys if key.hand is far] == [1.6]


def test_hand_keys_of_random_overlapping_gestures_reach_every_kept_stroke(pace, phases):
    """Draw the timing of overlapping gestures at random."""
    rng, rest = np.random.default_rng(7), resting_hands(pace.robot)
    for _ in range(40):
        strokes = []
        for k in range(5):
            start = rng.uniform(0, 5)
            times = start + np.cumsum([0, *rng.uniform(0, 0.7, 6)])
            hands = [reach(0.25, *rng.uniform((-0.3, 0.7), (-0.1, 0.9))) for _ in range(rng.integers(2, 4))]
            options = (right(*hands),) if rng.random() < 0.7 else (both(),)
            strokes.append(Stroke(f"g{k}", phases(*times), options))
        arrangement = arrange_hands(strokes, pace, {stroke.id: {"stroke"} for stroke in strokes})
        for side, keys in arrangement.hands.items():
            assert all(b.time - a.time > 1e-6 for a, b in pairwise(keys))
            for stroke in strokes:
                dropped = arrangement.outcomes.get(stroke.id)
                if side in arrangement.sides.get(stroke.id, ()):
                    hand = hand_at(keys, stroke.times["stroke"], rest[side])
                    assert any(hand is row[k] for row in stroke.options[0].hands.values() for k in range(len(row)))
                elif side in stroke.options[0].hands:
                    assert dropped is not None
                    assert dropped.why


@pytest.fixture
def crossing(phases):
    """Return two gestures of one hand with fixed overlapping strokes."""
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.4, 1.5, 2.2), (right(A, B),))
    second = Stroke("g2", phases(0.4, 1.0, 1.0, 1.2, 1.2, 1.4, 2.0), (right(C, A),))
    return [first, second]


@pytest.mark.parametrize(("ranks", "left"), [((1, 1), "g1"), ((0, 1), "g2"), ((1, 0), "g1"), ((1, 2), "g2")])
def test_less_important_or_later_of_two_overlapping_gesture_strokes_is_dropped(pace, crossing, ranks, left):
    arrangement = arrange_hands([replace(s, importance=rank) for s, rank in zip(crossing, ranks, strict=True)], pace)
    assert arrangement.sides.keys() == {left}
    (dropped,) = arrangement.outcomes
    assert arrangement.outcomes[dropped].kind == "dropped"
    assert left in arrangement.outcomes[dropped].why
    assert ("is more important" in arrangement.outcomes[dropped].why) == (left == "g2")


def test_moved_stroke_times_are_restored_after_the_conflicting_stroke_is_dropped(pace, overlapping, phases):
    first, second = overlapping
    third = Stroke("g3", phases(2.2, 2.5, 2.5, 2.8, 2.8, 3.0, 3.4), (right(B, A),))
    assert "g1" in arrange_hands(overlapping, pace, FREE_STROKES).times
    arrangement = arrange_hands([first, replace(second, importance=0), third], pace, FREE_STROKES)
    alone = arrange_hands([first, third], pace, FREE_STROKES)
    assert arrangement.outcomes.keys() == {"g2"}
    assert arrangement.times == alone.times
    assert [key.time for key in arrangement.hands["r"]] == [key.time for key in alone.hands["r"]]


def test_message_about_a_dropped_stroke_suggests_a_feasible_time(pace, crossing):
    first, second = crossing
    for clashes, apart in (({}, 0.0), ({frozenset(("g1", "g2")): Clash(0.5)}, 1.0)):
        late = replace(second, times={sync: time + apart for sync, time in second.times.items()})
        why = arrange_hands([first, late], pace, clashes=clashes).outcomes["g2"].why
        at = float(why.split("with its stroke at ")[1].split(" s")[0])
        assert at > late.times["stroke"]
        good = {sync: time + at + 0.005 - late.times["stroke"] for sync, time in late.times.items()}
        assert arrange_hands([first, replace(late, times=good)], pace).outcomes == {}


def test_gesture_strokes_with_a_reported_timing_conflict_count_as_overlapping(pace, phases):
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 2.0), (right(A, B),))
    second = Stroke("g2", phases(1.2, 1.5, 1.5, 1.8, 1.8, 2.0, 2.6), (right(C, A),))
    clashes = {frozenset(("g1", "g2")): Clash(0.31)}
    assert arrange_hands([first, second], pace).outcomes == {}
    arrangement = arrange_hands([first, second], pace, clashes=clashes)
    why = "its stroke is at 1.80 s; after the stroke of g1 at 1.00 s, the right hand is 0.31 s late"
    assert arrangement.outcomes["g2"].why == f"{why}; with its stroke at 2.11 s there would be time"
    either = replace(second, options=(*second.options, Poses({"l": (L, M)}, 1)))
    arrangement = arrange_hands([first, either], pace, clashes=clashes)
    assert arrangement.sides == {"g1": {"r"}, "g2": {"l"}}


@pytest.fixture
def counting(phases):
    """Return two overlapping strokes of a counting series."""
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.6, 1.7, 2.4), (right(A, B, C),), series="count")
    second = Stroke("g2", phases(0.8, 1.2, 1.2, 1.3, 1.9, 2.0, 2.6), (right(C, A, B),), series="count")
    return [first, second]


def test_overlapping_finger_counting_strokes_are_kept_at_their_stroke_times(pace, counting):
    arrangement = arrange_hands(counting, pace, FREE_STROKES)
    assert not any(outcome.kind == "dropped" for outcome in arrangement.outcomes.values())
    for stroke in counting:
        (work,) = [work for work in arrangement.works if work.id == stroke.id]
        assert work.at("stroke") == pytest.approx(stroke.times["stroke"])


def test_finger_counting_stroke_that_overlaps_another_at_fixed_times_is_dropped(pace, counting):
    fixed_syncs = {id: frozenset({"strokeStart", "stroke", "strokeEnd"}) for id in ("g1", "g2")}
    arrangement = arrange_hands(counting, pace, fixed_syncs)
    assert arrangement.outcomes["g2"].kind == "dropped"
    assert arrangement.outcomes.keys() == {"g2"}
