"""Whatever hands other blocks need: a gesture that may take either keeps clear of them, one that may not is as ever."""

from dataclasses import replace
from itertools import accumulate

from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import GESTURE_SYNCS
from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.engaged import Engaged
from kinesic.expressivity.hands.phases import Arranged, arrange_hands
from kinesic.expressivity.hands.poses import REST, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import Stroke
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.style.pace import Pace

from ...performances import LIMITS, ROBOT

PACE = Pace(ROBOT, LIMITS)
OPTIONS = {
    side: Poses({side: tuple(Hand(Reach(sealed([0.25, sign * y, 0.8]))) for y in (0.1, 0.25))}, 1)
    for side, sign in zip(SIDES, (1, -1), strict=True)
}
WAY = PACE.least_hand_time(pose_distance(REST, OPTIONS["r"].hands["r"][0], resting_hands(ROBOT)["r"]))  # [s]
NEVER = 100.0  # [s] later than all gestures

usual = st.sampled_from(SIDES)
gaps = st.lists(st.floats(0.0, 1.0), min_size=6, max_size=6)
windows = st.lists(
    st.builds(
        lambda side, begin, length: Engaged(side, begin, begin + length, "other:g"),
        st.sampled_from(SIDES),
        st.floats(-2.0, 6.0),
        st.floats(0.01, 3.0),
    ),
    max_size=4,
)


def stroke(id: str, start: float, phases: list[float], side: str, *, either: bool) -> Stroke:
    times = dict(zip(GESTURE_SYNCS, accumulate(phases, initial=start), strict=True))
    options = [OPTIONS[side], *(option for other, option in OPTIONS.items() if either and other != side)]
    return Stroke(id, times, tuple(options))


rows = st.lists(st.tuples(st.floats(0.0, 5.0), gaps, usual, st.booleans()), min_size=1, max_size=4)


def made(row: list[tuple[float, list[float], str, bool]], *, either: bool) -> list[Stroke]:
    return [
        stroke(f"g{k}", start, phases, side, either=either and opens)
        for k, (start, phases, side, opens) in enumerate(row)
    ]


def same(found: Arranged, other: Arranged) -> bool:
    keys = [
        [(key.time, *key.hand.reach.position) if key.hand.reach else key.time for key in row]
        for one in (found, other)
        for row in one.hands.values()
    ]
    return keys[:2] == keys[2:] and found.outcomes == other.outcomes and found.times == other.times


@given(st.floats(0.0, 5.0), gaps, usual, windows)
def test_a_gesture_alone_takes_a_free_hand_if_there_is_one(start, phases, side, engaged):
    one = stroke("g", start, phases, side, either=True)
    found = arrange_hands([one], PACE, engaged=engaged)
    busy = {each.side for each in engaged if each.meets(one.times, WAY)}
    free = [option for option in (side, *(set(SIDES) - {side})) if option not in busy]
    assert found.sides == {"g": {free[0] if free else side}}
    assert (found.outcomes != {}) == (bool(free) and free[0] != side)


@given(st.floats(0.0, 5.0), gaps, windows)
def test_a_gesture_of_two_hands_is_done_by_the_free_one_if_only_one_is(start, phases, engaged):
    both = Poses({side: OPTIONS[side].hands[side] for side in SIDES}, 1)
    one = replace(stroke("g", start, phases, "r", either=False), options=(both,), halves=True)
    found = arrange_hands([one], PACE, engaged=engaged)
    free = set(SIDES) - {each.side for each in engaged if each.meets(one.times, WAY)}
    assert found.sides == {"g": free or set(SIDES)}
    assert (found.outcomes != {}) == (len(free) == 1)


@given(rows, windows)
def test_gestures_of_a_given_hand_are_the_same(row, engaged):
    fixed = made(row, either=False)
    assert same(arrange_hands(fixed, PACE, engaged=engaged), arrange_hands(fixed, PACE))


@given(rows, windows)
def test_what_meets_no_gesture_changes_nothing(row, engaged):
    strokes = made(row, either=True)
    later = [Engaged(each.side, each.begin + NEVER, each.end + NEVER, each.by) for each in engaged]
    assert same(arrange_hands(strokes, PACE, engaged=later), arrange_hands(strokes, PACE))


@given(rows, windows)
def test_every_gesture_is_done_or_dropped_by_name_with_hands_it_may_take(row, engaged):
    strokes = made(row, either=True)
    found = arrange_hands(strokes, PACE, engaged=engaged)
    for one in strokes:
        dropped = one.id in found.outcomes and found.outcomes[one.id].kind == "dropped"
        assert dropped != (one.id in found.sides)
        if not dropped:
            assert any(found.sides[one.id] == set(option.hands) for option in one.options)


@given(rows, st.integers(0, 3))
def test_what_alone_counts_for_most_is_always_done_and_as_if_nothing_were_there(row, place):
    strokes = made(row, either=False)
    first = place % len(strokes)
    strokes = [replace(one, importance=int(k == first)) for k, one in enumerate(strokes)]
    found = arrange_hands(strokes, PACE)
    assert found.sides[f"g{first}"] == set(strokes[first].options[0].hands)
    dropped = {id for id, outcome in found.outcomes.items() if outcome.kind == "dropped"}
    assert same_but_for_outcomes(found, arrange_hands([one for one in strokes if one.id not in dropped], PACE))


def same_but_for_outcomes(found: Arranged, other: Arranged) -> bool:
    keys = [[[key.time for key in row] for row in one.hands.values()] for one in (found, other)]
    return keys[0] == keys[1] and found.times == other.times
