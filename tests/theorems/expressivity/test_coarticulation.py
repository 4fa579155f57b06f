"""Gestures with a choice of hand avoid busy hands."""

from dataclasses import replace
from itertools import accumulate

from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import GESTURE_SYNCS
from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.expressivity.hands.phases import HandArrangement, arrange_hands
from kinesic.expressivity.hands.poses import REST_HAND, Poses, pose_distance, resting_hands
from kinesic.expressivity.hands.strokes import Stroke
from kinesic.expressivity.keyframes import Hand
from kinesic.expressivity.style.pace import Pace

from ...performances import LIMITS, ROBOT

HAND_PACE = Pace(ROBOT, LIMITS)
POSE_OPTIONS = {
    side: Poses({side: tuple(Hand(Reach(sealed([0.25, sign * y, 0.8]))) for y in (0.1, 0.25))}, 1)
    for side, sign in zip(SIDES, (1, -1), strict=True)
}
LEAST_TIME = HAND_PACE.least_hand_time(
    pose_distance(REST_HAND, POSE_OPTIONS["r"].hands["r"][0], resting_hands(ROBOT)["r"])
)  # [s]
LATE_SHIFT = 100.0  # [s] delay that puts busy hands after all gestures

usual = st.sampled_from(SIDES)
gaps = st.lists(st.floats(0.0, 1.0), min_size=6, max_size=6)
windows = st.lists(
    st.builds(
        lambda side, begin, length: BusyHand(side, begin, begin + length, "other:g"),
        st.sampled_from(SIDES),
        st.floats(-2.0, 6.0),
        st.floats(0.01, 3.0),
    ),
    max_size=4,
)


def stroke(id: str, start: float, phases: list[float], side: str, *, either: bool) -> Stroke:
    times = dict(zip(GESTURE_SYNCS, accumulate(phases, initial=start), strict=True))
    options = [POSE_OPTIONS[side], *(option for other, option in POSE_OPTIONS.items() if either and other != side)]
    return Stroke(id, times, tuple(options))


rows = st.lists(st.tuples(st.floats(0.0, 5.0), gaps, usual, st.booleans()), min_size=1, max_size=4)


def made(row: list[tuple[float, list[float], str, bool]], *, either: bool) -> list[Stroke]:
    return [
        stroke(f"g{k}", start, phases, side, either=either and opens)
        for k, (start, phases, side, opens) in enumerate(row)
    ]


def same(found: HandArrangement, other: HandArrangement) -> bool:
    keys = [
        [(key.time, *key.hand.reach.position) if key.hand.reach else key.time for key in row]
        for one in (found, other)
        for row in one.hands.values()
    ]
    return keys[:2] == keys[2:] and found.outcomes == other.outcomes and found.times == other.times


@given(st.floats(0.0, 5.0), gaps, usual, windows)
def test_gesture_alone_in_a_block_uses_a_free_hand_if_one_exists(start, phases, side, busy_hands):
    one = stroke("g", start, phases, side, either=True)
    arrangement = arrange_hands([one], HAND_PACE, busy_hands=busy_hands)
    busy = {busy_hand.side for busy_hand in busy_hands if busy_hand.meets(one.times, LEAST_TIME)}
    free = [option for option in (side, *(set(SIDES) - {side})) if option not in busy]
    assert arrangement.sides == {"g": {free[0] if free else side}}
    assert (arrangement.outcomes != {}) == (bool(free) and free[0] != side)


@given(st.floats(0.0, 5.0), gaps, windows)
def test_two_handed_gesture_uses_one_hand_if_only_that_hand_is_free(start, phases, busy_hands):
    both = Poses({side: POSE_OPTIONS[side].hands[side] for side in SIDES}, 1)
    one = replace(stroke("g", start, phases, "r", either=False), options=(both,), may_split=True)
    arrangement = arrange_hands([one], HAND_PACE, busy_hands=busy_hands)
    free = set(SIDES) - {busy_hand.side for busy_hand in busy_hands if busy_hand.meets(one.times, LEAST_TIME)}
    assert arrangement.sides == {"g": free or set(SIDES)}
    assert (arrangement.outcomes != {}) == (len(free) == 1)


@given(rows, windows)
def test_busy_hands_do_not_affect_gestures_with_a_prescribed_hand(row, busy_hands):
    fixed = made(row, either=False)
    assert same(arrange_hands(fixed, HAND_PACE, busy_hands=busy_hands), arrange_hands(fixed, HAND_PACE))


@given(rows, windows)
def test_busy_hands_after_all_gestures_have_no_effect(row, busy_hands):
    strokes = made(row, either=True)
    later = [
        BusyHand(busy_hand.side, busy_hand.begin + LATE_SHIFT, busy_hand.end + LATE_SHIFT, busy_hand.by)
        for busy_hand in busy_hands
    ]
    assert same(arrange_hands(strokes, HAND_PACE, busy_hands=later), arrange_hands(strokes, HAND_PACE))


@given(rows, windows)
def test_every_gesture_uses_allowed_hands_or_is_reported_dropped(row, busy_hands):
    strokes = made(row, either=True)
    arrangement = arrange_hands(strokes, HAND_PACE, busy_hands=busy_hands)
    for one in strokes:
        dropped = one.id in arrangement.outcomes and arrangement.outcomes[one.id].kind == "dropped"
        assert dropped != (one.id in arrangement.sides)
        if not dropped:
            assert any(arrangement.sides[one.id] == set(option.hands) for option in one.options)


@given(rows, st.integers(0, 3))
def test_most_important_gesture_is_kept_and_dropped_gestures_leave_hand_keys_unchanged(row, place):
    strokes = made(row, either=False)
    first = place % len(strokes)
    strokes = [replace(one, importance=int(k == first)) for k, one in enumerate(strokes)]
    arrangement = arrange_hands(strokes, HAND_PACE)
    assert arrangement.sides[f"g{first}"] == set(strokes[first].options[0].hands)
    dropped = {id for id, outcome in arrangement.outcomes.items() if outcome.kind == "dropped"}
    assert same_but_for_outcomes(
        arrangement, arrange_hands([one for one in strokes if one.id not in dropped], HAND_PACE)
    )


def same_but_for_outcomes(found: HandArrangement, other: HandArrangement) -> bool:
    keys = [[[key.time for key in row] for row in one.hands.values()] for one in (found, other)]
    return keys[0] == keys[1] and found.times == other.times
