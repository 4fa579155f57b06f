"""Tests of measured segments and stretched intervals in the key-time search."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion import key_times
from kinesic.motion.budget import Budget
from kinesic.motion.infeasibility import Bottleneck, Infeasibility
from kinesic.motion.key_time_lp import CuttingPlane
from kinesic.motion.segments import SplineSegment, segments
from kinesic.motion.trajectory import KNOT_INTERVAL

from .hurried_keys import HURRIED_ROWS, deficit_of, fake_measure, first_segment, keys_of, search_of


def test_most_violated_limit_of_each_key_interval_is_reported():
    search = search_of()
    pair, (low, same, high) = (3, 4), (Bottleneck(h, "jerk", ratio) for h, ratio in ((0, 1.2), (1, 1.2), (2, 1.3)))
    for found, kept in ((low, low), (same, low), (high, high), (low, high)):
        search._record([(pair, found)])
        assert search.bottlenecks[pair] is kept


def test_time_deficit_of_a_segment_with_unchanged_key_times_is_measured_once(monkeypatch):
    search, ample = search_of(budget=Budget(1e4)), {"amount": -0.3}
    asked = fake_measure(monkeypatch, lambda segment: deficit_of(segment, ample["amount"], programs=3))
    segment = first_segment(search)
    bound = search._measure(segment, -0.1)
    assert search._measure(segment, -0.1) is bound
    exact = search._measure(segment)
    assert exact is not bound, "a bound is no exact deficit"
    assert search._measure(segment) is exact
    assert search._measure(segment, -0.1) is exact
    work = segment.grid.pieces * 3
    assert [options["target"] for options in asked] == [-0.1, None]
    assert [options["max_work"] for options in asked] == [1e4, 1e4 - work]
    assert (search._evaluations, search._budget.left) == (2 * work, 1e4 - 2 * work)
    for other in (replace(segment, hinge=1), replace(segment, places=segment.places + 0.1)):
        search._measure(other)
    assert len(asked) == 4


@pytest.mark.parametrize(("amount", "is_exact"), [(0.2, True), (-0.1, False), (-0.2, False)])
def test_time_deficit_measured_above_its_target_is_reused_as_exact(monkeypatch, amount, is_exact):
    search = search_of()
    asked = fake_measure(monkeypatch, lambda segment: deficit_of(segment, amount))
    search._measure(first_segment(search), -0.1)
    search._measure(first_segment(search))
    assert len(asked) == (1 if is_exact else 2)


def test_time_deficit_that_cannot_be_measured_costs_one_spline_program_and_is_cached(monkeypatch):
    search = search_of()
    asked = fake_measure(monkeypatch, lambda segment: None)
    segment = first_segment(search)
    assert search._measure(segment, -0.1) is None
    assert search._measure(segment) is None
    assert (len(asked), search._evaluations) == (1, segment.grid.pieces)
    assert asked[0]["max_work"] == key_times.SEARCH_TUNING.max_evaluations


def test_segment_is_infeasible_if_its_time_deficit_is_too_large_or_unknown(monkeypatch):
    search, limit = search_of(), key_times.SEARCH_TUNING.feasible_deficit
    segment = first_segment(search)
    ways = [replace(segment, places=segment.places + 0.01 * k) for k in range(4)]
    amounts = dict(zip((way.places.tobytes() for way in ways), (limit, limit + 1e-9, None, -0.3), strict=True))

    def answer(way: SplineSegment) -> Infeasibility | None:
        amount = amounts[way.places.tobytes()]
        return None if amount is None else deficit_of(way, amount)

    asked = fake_measure(monkeypatch, answer)
    assert [way for way, _ in search._find_infeasible(ways)] == ways[1:3]
    assert {options["target"] for options in asked} == {limit}


def test_segments_are_no_longer_measured_once_the_budget_is_spent(monkeypatch):
    search = search_of()
    segment = first_segment(search)
    ways = [replace(segment, places=segment.places + 0.01 * k) for k in range(4)]
    search._budget = Budget(1.5 * segment.grid.pieces)
    fake_measure(monkeypatch, deficit_of)
    assert [way for way, _ in search._find_infeasible(ways)] == ways[:2]


def test_segments_are_affected_by_active_cutting_planes_and_by_stretched_intervals():
    search, rows = search_of(), [0.0, 0.0, 2.0, -2.0, 0.0]
    at = float(np.array(rows) @ search.times)
    assert [*search._find_affected_segments()] == []
    for slack, hinges in ((0.0, {0}), (0.019, {0}), (0.021, set())):
        search._planes = {0: [CuttingPlane(sealed(rows), at + slack)]}
        assert {item.hinge for item in search._find_affected_segments()} == hinges
    search._planes, search._stretched = {}, {(1, (1, 2)): 0.0}
    affected = [*search._find_affected_segments()]
    assert affected
    assert {item.hinge for item in affected} == {1}
    assert all((1, (1, 2)) in item.key_intervals for item in affected)


def test_segments_whose_limit_ratio_exceeds_a_threshold_are_returned_as_fast(monkeypatch):
    search = search_of()
    found = [*segments(search.times, keys_of(), KNOT_INTERVAL)]
    monkeypatch.setattr(key_times, "estimate_limit_ratio", lambda segment, limits: 1.0 + segment.hinge)
    assert {item.hinge for item in search._find_fast(found, 1.0)} == {1}
    assert {item.hinge for item in search._find_fast(found, 0.99)} == {0, 1}
    assert search._find_fast(found, 2.0) == []


def stretched(monkeypatch, result, intervals, *, durations, **state):
    """Stretch intervals to given key times, and record the calls."""
    search, asked = search_of(DISTANT_ROWS), []

    def stretch(problem, begin, limits, measure, budget):
        asked.append((problem, begin, {way.hinge for way, _ in measure(search.times)}, budget))
        return result

    fake_measure(monkeypatch, lambda segment: deficit_of(segment, 0.7))
    monkeypatch.setattr(key_times, "stretch_until_enough", stretch)
    search._stretched = dict(durations)
    for name, value in state.items():
        setattr(search, name, value)
    return search, search._stretch(intervals), asked


# hurried keys, followed by later keys with enough time
DISTANT_ROWS = (
    *((t, *rest) for t, *rest in HURRIED_ROWS[:-1]),
    (4.0, 0.0, 0, "end"),
    (6.5, 0.4, 1, "stroke"),
    (9.0, 0.0, 0, "rest"),
)
NEAR_INTERVAL = (0, (1, 2))  # hinge and key pair of an interval of the hurried keys
FAR_INTERVAL = (0, (5, 6))  # hinge and key pair of a later interval


def test_key_intervals_less_than_two_seconds_apart_are_stretched_together(monkeypatch):
    result = np.arange(7.0)
    for interval, is_free in (((0, (2, 3)), True), ((0, (0, 1)), True), ((1, (2, 3)), True), (FAR_INTERVAL, False)):
        known = {NEAR_INTERVAL: 0.0, interval: 0.5}
        search, has_changed, ((problem, begin, hinges, _),) = stretched(
            monkeypatch, result, {NEAR_INTERVAL}, durations=known
        )
        assert has_changed
        assert search.times is result
        assert search._stretched == {NEAR_INTERVAL: 1.0, interval: 1.0 if is_free else 0.5}
        assert hinges == {0, interval[0]}
        assert begin is not result
        assert problem.lead_in == 0.6
        fixed = 0.5 if not is_free else search._gaps[interval[1]]
        assert problem.gaps[interval[1]] == max(fixed, search._gaps[interval[1]])
        assert search.bottlenecks[1, 2].ratio == pytest.approx(np.exp(0.7))


@pytest.mark.parametrize(("margin", "is_free"), [(1.0, True), (0.999, False)])
@pytest.mark.parametrize("is_later", [True, False])
def test_key_intervals_exactly_the_margin_apart_are_stretched_together(monkeypatch, margin, is_free, is_later):
    monkeypatch.setattr(key_times, "SEARCH_TUNING", replace(key_times.SEARCH_TUNING, stretch_margin=margin))
    asked, other = ((0, (1, 2)), (0, (3, 4))) if is_later else ((0, (3, 4)), (0, (1, 2)))
    times = np.array([0.0, 1.0 if is_later else 2.0, 2.0 if is_later else 2.5, 3.0, 4.0, 9.0, 10.0])
    search, _, _ = stretched(monkeypatch, np.arange(7.0), {asked}, durations={asked: 0.0, other: 0.3}, times=times)
    assert search._stretched[other] == (1.0 if is_free else 0.3)


def test_failed_stretch_of_a_key_interval_is_replaced_by_cutting_planes_and_after_many_planes_by_stops(monkeypatch):
    most = key_times.SEARCH_TUNING.max_planes
    for attempts, is_changed in ((most, False), (most + 1, True)):
        counted = Counter({NEAR_INTERVAL: attempts})
        known = {NEAR_INTERVAL: 0.0, FAR_INTERVAL: 0.5}
        search, changed, _ = stretched(monkeypatch, None, {NEAR_INTERVAL}, durations=known, _attempts=counted)
        assert changed is is_changed
        assert search._stretched == {FAR_INTERVAL: 0.5}
        assert search._unstretchable == (set() if is_changed else {NEAR_INTERVAL})
        assert set(search._rest_factors) == ({NEAR_INTERVAL} if is_changed else set())
