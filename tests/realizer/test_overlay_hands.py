"""Sequence of a hand's behaviours in a block and in the running motion."""

import numpy as np
import pytest

from kinesic.motion.trajectory import KNOT_INTERVAL, KNOT_TOLERANCE
from kinesic.motion.transition import SAME_ANGLE
from kinesic.realizer import overlay as module
from kinesic.realizer.occupancy import MergeFailure, Occupancy, Overlay
from kinesic.realizer.overlay import (
    _cross_over_to,
    _has_finishing_between,
    _return_to_rest,
    _stops,
    join_hinge_motions,
)

ROW_COUNT = 100  # control points of the test motions
ARM_HINGE = 2  # index of the arm hinge whose motions are joined
CHANGE_KNOT = 10  # first spline knot at which the motion may change
NO_HINGES = np.zeros(4, dtype=np.bool_)
LIMITS = object()  # placeholder; only passed on to a replaced function
HALF_TOLERANCE = 0.5 * KNOT_TOLERANCE * KNOT_INTERVAL  # [s] half of the tolerance for times that should be at a knot


def use(id: str, ready: float, relax: float = 9.0, *, begin: float = 0.0, end: float = 9.5, role="r_hand") -> Occupancy:
    return Occupancy(id, frozenset({role, "sign"}), NO_HINGES, begin, ready, relax, end)


def work(performed=(), holding=(), finishing=()) -> Overlay:
    """Return a running motion at 0 rad and a block's motion at 1 rad."""
    base, coming = np.zeros((ROW_COUNT, 4)), np.zeros((ROW_COUNT, 4))
    coming[:, ARM_HINGE] = 1.0
    return Overlay(base, coming, np.zeros(4), CHANGE_KNOT, holding, performed, finishing)


@pytest.fixture
def transitions(monkeypatch):
    """Record transitions as (angles before and after [rad], time [s], next behaviour)."""
    calls = []

    def cross(current, after, left, stop, limits, hinge):
        assert (limits, hinge) == (LIMITS, ARM_HINGE)
        calls.append((current[0], after[0], left, stop.behaviour))
        return after + 10.0

    monkeypatch.setattr(module, "_cross_over_to", cross)
    monkeypatch.setattr(module, "_return_to_rest", lambda column, done, *_: ("return", column[0], done.behaviour))
    return calls


def joined(task: Overlay):
    result = join_hinge_motions(task, "r_hand", ARM_HINGE, LIMITS)
    return result if isinstance(result, tuple | MergeFailure) else result[0]


def test_hand_without_behaviour_in_the_new_block_keeps_the_running_motion(transitions):
    other = use("left", 0.3, role="l_hand")
    assert joined(work([other], [use("a", 0.3)])) == 0.0
    assert transitions == []


def test_hand_passes_from_the_running_motion_to_the_block_and_returns(transitions):
    assert joined(work([use("g", 0.6)])) == ("return", 11.0, "g")
    assert transitions == [(0.0, 1.0, CHANGE_KNOT * KNOT_INTERVAL, "g")]


def test_hand_transition_to_the_block_starts_after_all_earlier_behaviours_have_relaxed(transitions):
    assert joined(work([use("g", 0.6)], [use("a", 0.3, 0.5), use("b", 0.4, 0.45)])) == ("return", 11.0, "g")
    assert transitions == [(0.0, 1.0, 0.5, "g")]


def test_hand_returns_to_the_running_motion_for_its_later_behaviour(transitions):
    assert joined(work([use("g", 0.3, 0.4)], [use("a", 0.6)])) == 10.0
    assert transitions == [(0.0, 1.0, 0.1, "g"), (11.0, 0.0, 0.4, "a")]


@pytest.mark.parametrize(
    ("ready", "is_there"),
    [
        (0.05, True),
        (CHANGE_KNOT * KNOT_INTERVAL - KNOT_TOLERANCE, False),
        (CHANGE_KNOT * KNOT_INTERVAL, False),
        (CHANGE_KNOT * KNOT_INTERVAL - 2 * KNOT_TOLERANCE, True),
    ],
)
def test_hand_ready_before_the_change_time_needs_no_transition(transitions, ready, is_there):
    assert joined(work([use("g", ready)])) == ("return", 1.0 if is_there else 11.0, "g")
    assert len(transitions) == (not is_there)


@pytest.mark.parametrize(
    ("performed", "holding", "finishing", "expected"),
    [
        ([("g", 0.3), ("h", 0.6)], [], [], ["g"]),
        ([("g", 0.3), ("h", 0.6)], [], [0.4], ["g", "h"]),
        ([("g", 0.3), ("h", 0.6)], [], [0.2], ["g"]),
        ([("g", 0.7)], [("a", 0.3), ("b", 0.5)], [0.4], ["g"]),
        ([("g", 0.05), ("h", 0.6)], [], [0.4], ["h"]),
        ([("g", 0.05)], [], [0.04], []),
    ],
)
def test_hand_needs_a_transition_between_two_block_behaviours_only_for_a_finishing_one_between(
    transitions, performed, holding, finishing, expected
):
    joined(
        work(*([use(*entry) for entry in group] for group in (performed, holding)), [use("f", t) for t in finishing])
    )
    assert [name for *_, name in transitions] == expected


@pytest.mark.parametrize(
    ("performed", "holding", "failing", "named"),
    [
        ([("g", 0.3)], [], "g", "g"),
        ([("g", 0.3)], [("a", 0.6)], "a", "g"),
        ([("g", 0.3), ("h", 0.8)], [("a", 0.6)], "h", "h"),
        ([("g", 0.8)], [("a", 0.6)], "g", "g"),
    ],
)
def test_failed_hand_transition_names_a_behaviour_of_the_new_block(monkeypatch, performed, holding, failing, named):
    monkeypatch.setattr(
        module, "_cross_over_to", lambda _current, after, _left, stop, *_: None if stop.behaviour == failing else after
    )
    task = work([use(*entry) for entry in performed], [use(*entry) for entry in holding])
    why = "its hand has no time for the transition between two behaviours"
    assert joined(task) == MergeFailure(named, why)


def test_behaviours_of_a_hand_are_sorted_by_their_ready_time():
    performed = [use("g", 0.6), use("left", 0.1, role="l_hand"), use("h", 0.2)]
    holding = [use("a", 0.4), use("other", 0.3, role="l_hand"), use("b", 0.8)]
    stops = [(entry.behaviour, source) for entry, source in _stops(work(performed, holding), "r_hand")]
    assert stops == [("h", "coming"), ("a", "base"), ("g", "coming"), ("b", "base")]
    assert _stops(work([performed[1]], holding), "r_hand") == []


@pytest.mark.parametrize(
    ("ready", "role", "is_between"),
    [
        (0.2, "r_hand", True),
        (0.5, "r_hand", True),
        (0.19, "r_hand", False),
        (0.51, "r_hand", False),
        (0.3, "l_hand", False),
    ],
)
def test_finishing_behaviour_lies_between_two_others_of_its_hand_if_its_ready_time_does(ready, role, is_between):
    finishing = [use("past", 0.0), use("f", ready, role=role)]
    assert _has_finishing_between(finishing, "r_hand", use("g", 0.2), use("h", 0.5)) is is_between


@pytest.fixture
def crossings(monkeypatch):
    """Record attempted transitions, of which the first ones fail."""
    calls, failures = [], [0]

    def cross_over(current, after, knots, limits, hinge):
        assert (limits, hinge) == (LIMITS, ARM_HINGE)
        calls.append((*knots, current, after))
        return after + 5.0 if len(calls) > failures[0] else None

    monkeypatch.setattr(module, "cross_over", cross_over)
    return calls, failures


@pytest.mark.parametrize(
    ("equal", "leave"),
    [
        (slice(20, 30), 27),
        (slice(10, 13), 10),
        (slice(9, 12), 20),
        (slice(60, 63), 60),
        (slice(61, 64), 20),
        (slice(30, 32), 20),
    ],
)
def test_hand_transition_starts_where_motions_last_coincide_or_when_the_next_behaviour_begins(crossings, equal, leave):
    """Three equal control points make two motions coincide at a knot."""
    current, after = np.zeros(ROW_COUNT), np.ones(ROW_COUNT)
    after[equal] = SAME_ANGLE
    result = _cross_over_to(current, after, 0.1, use("g", 0.6, begin=0.2), LIMITS, ARM_HINGE)
    np.testing.assert_array_equal(result, after + 5.0)
    ((first, last, before, following),) = crossings[0]
    assert (first, last) == (leave, 60)
    assert before is current
    assert following is after


def test_hand_transition_starts_where_motions_coincide_at_a_nonzero_angle(crossings):
    current, after = np.full(ROW_COUNT, 0.4), np.zeros(ROW_COUNT)
    after[20:30] = 0.4
    _cross_over_to(current, after, 0.1, use("g", 0.6, begin=0.2), LIMITS, ARM_HINGE)
    assert crossings[0][0][:2] == (27, 60)


@pytest.mark.parametrize(
    ("left", "begin", "ready", "knots"),
    [
        (0.1, 0.2, 0.6, [(20, 60), (10, 60)]),
        (0.105, 0.206, 0.604, [(20, 60), (11, 60)]),
        (0.1 + HALF_TOLERANCE, 0.2 - HALF_TOLERANCE, 0.6 - HALF_TOLERANCE, [(20, 60), (10, 60)]),
        (0.3, 0.2, 0.6, [(30, 60), (30, 60)]),
    ],
)
def test_hand_transition_is_tried_from_the_start_of_the_next_behaviour_and_then_from_earlier_times(
    crossings, left, begin, ready, knots
):
    crossings[1][0] = 2
    current, after = np.zeros(ROW_COUNT), np.ones(ROW_COUNT)
    assert _cross_over_to(current, after, left, use("g", ready, begin=begin), LIMITS, ARM_HINGE) is None
    assert [call[:2] for call in crossings[0]] == knots


def test_second_hand_transition_is_used_if_the_first_one_fails(crossings):
    crossings[1][0] = 1
    current, after = np.zeros(ROW_COUNT), np.ones(ROW_COUNT)
    result = _cross_over_to(current, after, 0.1, use("g", 0.6, begin=0.2), LIMITS, ARM_HINGE)
    np.testing.assert_array_equal(result, after + 5.0)
    assert len(crossings[0]) == 2


def resting(*, block_end=0.0, running_end=0.5, finishing=(), count=ROW_COUNT) -> Overlay:
    """Return a hinge that starts at 0 rad, with its last angles [rad] in both motions."""
    base, coming = np.zeros((count, 4)), np.zeros((count, 4))
    base[-1, ARM_HINGE], coming[-1, ARM_HINGE] = running_end, block_end
    return Overlay(base, coming, np.zeros(4), CHANGE_KNOT, (), (), finishing)


@pytest.mark.parametrize(
    ("block_end", "running_end", "finishing", "returns"),
    [
        (0.0, 0.0, (), False),
        (0.0, SAME_ANGLE, (), False),
        (0.0, 2 * SAME_ANGLE, (), True),
        (0.0, -0.5, (), True),
        (SAME_ANGLE, 0.5, (), True),
        (2 * SAME_ANGLE, 0.5, (), False),
        (-0.5, 0.5, (), False),
        (0.0, 0.0, (use("f", 0.1),), True),
        (0.5, 0.5, (use("f", 0.1),), True),
        (0.0, 0.0, (use("f", 0.09),), False),
        (0.0, 0.0, (use("f", 0.3, role="l_hand"),), False),
    ],
)
def test_hand_returns_if_only_the_running_motion_ends_away_from_rest_or_a_behaviour_finishes(
    crossings, block_end, running_end, finishing, returns
):
    column = np.full(ROW_COUNT, 0.7)
    task = resting(block_end=block_end, running_end=running_end, finishing=finishing)
    result = _return_to_rest(column, use("g", 0.1, 0.2, end=0.4), task, "r_hand", LIMITS, ARM_HINGE)
    assert (result is column) is not returns
    if returns:
        ((first, last, before, after),) = crossings[0]
        assert (first, last) == (20, 50)
        np.testing.assert_array_equal(before, column)
        np.testing.assert_array_equal(after, running_end)
        np.testing.assert_array_equal(result, running_end + 5.0)


def test_hand_does_not_return_if_both_motions_end_in_the_start_posture_or_the_block_ends_elsewhere():
    task = resting(block_end=0.3, running_end=0.3)
    task.start[ARM_HINGE] = 0.3
    column = np.full(ROW_COUNT, 0.7)
    assert _return_to_rest(column, use("g", 0.1, 0.2), task, "r_hand", LIMITS, ARM_HINGE) is column
    task.coming[-1, ARM_HINGE], task.base[-1, ARM_HINGE] = -0.3, 0.9
    assert _return_to_rest(column, use("g", 0.1, 0.2), task, "r_hand", LIMITS, ARM_HINGE) is column


def test_hand_returns_from_the_first_knot_at_which_it_is_relaxed(crossings):
    for relax in (0.195, 0.2 + HALF_TOLERANCE):
        _return_to_rest(np.ones(ROW_COUNT), use("g", 0.1, relax, end=0.4), resting(), "r_hand", LIMITS, ARM_HINGE)
    assert [call[:2] for call in crossings[0]] == [(20, 50), (20, 50)]


@pytest.mark.parametrize(
    ("end", "pieces"),
    [
        (0.4, [30, 45, 68, 102, 153, 230, 345]),
        (0.705, [51, 77, 116, 174, 261, 392]),
        (4.199, [400]),
        (4.201, []),
    ],
)
def test_failed_hand_return_is_retried_1_5_times_longer_up_to_4_seconds(crossings, end, pieces):
    crossings[1][0] = 99
    failure = _return_to_rest(np.ones(60), use("g", 0.1, 0.2, end=end), resting(count=60), "r_hand", LIMITS, ARM_HINGE)
    assert failure == MergeFailure("g", "its hand cannot return to rest within its limits")
    assert [last - first for first, last, *_ in crossings[0]] == pieces
    for first, last, before, after in crossings[0]:
        assert len(before) == len(after) == max(60, last + 3)
        np.testing.assert_array_equal(before, 1.0)
        np.testing.assert_array_equal(after, 0.5)
        assert first == 20
