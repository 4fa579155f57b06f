"""Tests of the key-time search: measurement, cutting planes, stretching and stops."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion import key_times
from kinesic.motion.budget import Budget
from kinesic.motion.double_s import compute_rest_durations, compute_velocity_durations
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.key_time_lp import CuttingPlane, shift_cost
from kinesic.motion.key_times import KeyTimeSearch
from kinesic.motion.plane_memory import PlaneMemory

from .hurried_keys import HURRIED_ROWS, JOINT_LIMITS, deficit_of, first_segment, keys_of, search_of


def tune(monkeypatch: pytest.MonkeyPatch, **changes: float) -> None:
    monkeypatch.setattr(key_times, "SEARCH_TUNING", replace(key_times.SEARCH_TUNING, **changes))


@pytest.mark.parametrize(("missing", "is_kept"), [(0.0, True), (0.7e-6, True), (1.6e-6, False), (0.05, False)])
def test_requested_key_times_are_kept_if_the_velocity_limit_allows_them_up_to_rounding(missing, is_kept):
    least = compute_velocity_durations(keys_of(), JOINT_LIMITS)[0, (1, 2)]
    assert least == pytest.approx(0.3)
    rows = [(t + 0.3 - 0.2 - missing if k >= 2 else t, *rest) for k, (t, *rest) in enumerate(HURRIED_ROWS)]
    rows = [(t + 0.2 if k >= 3 else t, *rest) for k, (t, *rest) in enumerate(rows)]
    search = search_of(rows)
    assert np.array_equal(search.times, keys_of(rows).requested_times) is is_kept


def test_first_key_starts_earlier_by_at_most_the_lead_in():
    rows = ((0, 0, 0, "start"), (0.1, 1.9, 0, "stroke"), (2, 0, 0, "end"))
    for lead_in, first in ((0.0, 0.0), (0.2, -0.2), (0.6, 0.1 - 1.9 / 4)):
        assert KeyTimeSearch(keys_of(rows), JOINT_LIMITS, lead_in).times[0] == pytest.approx(first)


def test_infeasible_segment_is_first_constrained_by_cutting_planes(monkeypatch):
    search = search_of()
    segment = first_segment(search)
    search._request_more_time(segment, deficit_of(segment))
    (plane,) = search._planes[0]
    assert plane.slopes @ search.times > plane.bound
    assert not search._stretched
    assert not search._rest_factors
    assert set(search._attempts.values()) == {1}
    assert set(search._attempts) == set(segment.key_intervals)


def requested(monkeypatch, attempts: int, *, evaluations: int = 0, binds=lambda k: k == 0, **state) -> KeyTimeSearch:
    """Request more time for a segment's first interval after some failed attempts."""
    tune(monkeypatch, max_planes=3, max_stretches=2)
    search = search_of()
    segment = first_segment(search)
    first = segment.key_intervals[0]
    search._attempts[first] = attempts
    search._evaluations = evaluations
    for name, value in state.items():
        setattr(search, name, value)
    search._request_more_time(segment, deficit_of(segment, binds=binds))
    return search


@pytest.mark.parametrize(
    ("attempts", "planes", "stretched", "stops"),
    [(0, 1, 0, 0), (2, 1, 0, 0), (3, 0, 1, 0), (4, 0, 1, 0), (5, 0, 0, 4), (6, 0, 0, 4)],
)
def test_key_time_search_tries_cutting_planes_then_stretching_then_rest_at_keys(
    monkeypatch, attempts, planes, stretched, stops
):
    search = requested(monkeypatch, attempts)
    assert len(first_segment(search).key_intervals) == 4
    assert (len(search._all_planes), len(search._stretched), len(search._rest_factors)) == (planes, stretched, stops)


def test_exhausted_key_time_search_stops_the_motion_at_all_keys_of_a_segment(monkeypatch):
    search = search_of()
    for evaluations, stops in ((search._max_evaluations, 0), (search._max_evaluations + 1, 4)):
        assert len(requested(monkeypatch, 0, evaluations=evaluations)._rest_factors) == stops
    for budget, stops in ((Budget(0.0), 0), (Budget(-1.0), 4)):
        assert len(requested(monkeypatch, 0, _budget=budget)._rest_factors) == stops


def test_key_interval_with_stops_at_its_ends_is_lengthened_by_a_tenth(monkeypatch):
    search = requested(monkeypatch, 0, _rest_factors={(0, (0, 1)): 1.0})
    assert search._rest_factors == {(0, (0, 1)): 1.1}
    others = requested(monkeypatch, 0, _rest_factors={(0, (3, 4)): 1.0})
    assert others._rest_factors == {(0, (3, 4)): 1.0}
    assert len(others._all_planes) == 1


def test_stretched_key_interval_is_stretched_again_if_it_stays_infeasible(monkeypatch):
    search = requested(monkeypatch, 0, _stretched={(0, (0, 1)): 0.7, (0, (3, 4)): 0.9})
    assert search._stretched == {(0, (0, 1)): 0.0, (0, (3, 4)): 0.9}
    assert not search._all_planes


def test_cutting_planes_that_involve_a_stretched_key_interval_are_dropped(monkeypatch):
    near, far, other = (
        CuttingPlane(sealed(row), 0.0) for row in ([0, 2, -2, 0, 0], [0, 0, 0, 2, -2], [2, -2, 0, 0, 0])
    )
    search = requested(monkeypatch, 3, _planes={0: [near, far, other], 1: [near]})
    assert (search._planes[0], search._planes[1]) == ([far], [near])


NOD_ROWS = (  # key time [s], angles of both hinges [rad] and sync point of two nods
    (0.0, 0.0, 0, "start"),
    (0.3, 0.4, 0, "ready"),
    (0.5, -0.4, 0, "stroke:1"),
    (0.7, 0.4, 0, "relax:1"),
    (0.9, -0.4, 0, "stroke:2"),
    (1.1, 0.4, 0, "relax:2"),
    (2.0, 0.0, 0, "end"),
)


@pytest.mark.parametrize(
    ("pairs", "is_repeated"),
    [
        ([(1, 2)], False),
        ([(1, 2), (2, 3)], False),
        ([(1, 2), (3, 4)], True),
        ([(2, 3), (3, 4), (4, 5)], True),
        ([(0, 1), (5, 6)], False),
    ],
)
def test_segment_limited_in_two_repeated_strokes_is_stretched_without_cutting_planes(monkeypatch, pairs, is_repeated):
    search = search_of(NOD_ROWS)
    segment = first_segment(search)
    assert segment.reversals == 5
    intervals = {(0, pair) for pair in pairs}
    assert search._is_repeated_stroke(segment, intervals) is is_repeated
    monkeypatch.setattr(key_times, "find_limiting_intervals", lambda *given: [*intervals])
    search._request_more_time(segment, deficit_of(segment))
    assert set(search._stretched) == (intervals if is_repeated else set())
    again = search_of(NOD_ROWS)
    again._unstretchable = set(intervals)
    again._request_more_time(segment, deficit_of(segment))
    assert not again._stretched, "what cannot be stretched gets planes"


def test_strokes_with_fewer_than_two_reversals_each_are_not_repeated_strokes():
    search = search_of(NOD_ROWS)
    segment = first_segment(search)
    intervals = {(0, (1, 2)), (0, (3, 4))}
    for kept, is_repeated in ((4, True), (3, False)):
        way = replace(segment, places=segment.places[:kept], angles=segment.angles[:kept])
        assert way.reversals == kept
        assert search._is_repeated_stroke(way, intervals) is is_repeated


def test_key_interval_with_stops_starts_at_the_rest_to_rest_duration_and_grows_by_a_tenth():
    search, interval = search_of(), (0, (1, 2))
    rest = compute_rest_durations(keys_of(), JOINT_LIMITS)[interval]
    search._stretched = {interval: 0.4, (0, (0, 1)): 0.5}
    for factor in (1.0, 1.1, 1.21):
        search._stop_at_keys([interval])
        assert search._gaps[1, 2] == pytest.approx(factor * rest)
    assert search._stretched == {(0, (0, 1)): 0.5}
    search._gaps[1, 2] = 100.0
    search._stop_at_keys([interval])
    assert search._gaps[1, 2] == 100.0


def test_key_interval_with_stops_grows_to_at_most_a_hundred_times_its_first_duration():
    search, interval = search_of(), (1, (1, 2))
    search._rest_factors[interval] = 100.0 / 1.1 * (1 - 1e-9)
    search._stop_at_keys([interval])
    with pytest.raises(ArithmeticError, match="hinge 1 cannot move"):
        search._stop_at_keys([interval])


def test_rest_durations_are_listed_by_hinge_in_the_order_of_its_keys():
    search = search_of()
    expected = compute_rest_durations(keys_of(), JOINT_LIMITS)
    for hinge, durations in enumerate(search._rest_durations_by_hinge):
        assert durations.tolist() == [expected[hinge, (k, k + 1)] for k in range(4)]


def test_cost_of_stops_at_all_keys_is_that_of_rest_to_rest_durations_plus_a_tenth():
    search = search_of()
    rests = compute_rest_durations(keys_of(), JOINT_LIMITS)
    needed = {pair: max(rests[hinge, pair] for hinge in (0, 1)) * 1.1 for _, pair in rests}
    for pair, duration in needed.items():
        search._gaps[pair] = max(keys_of().gaps[pair], duration)
    search._planes = {}
    search._solve(set())
    assert search._rest_cost == pytest.approx(shift_cost(keys_of(), search.times), abs=1e-6)


def test_contradicting_cutting_planes_are_replaced_by_stops_at_the_keys():
    search = search_of()
    search._planes = {
        0: [CuttingPlane(sealed([0, 0, 1.0, -1.0, 0]), -0.5), CuttingPlane(sealed([0, 0, -1.0, 1.0, 0]), 0.4)]
    }
    search._solve({(0, (0, 1))})
    rests = compute_rest_durations(keys_of(), JOINT_LIMITS)
    assert not search._all_planes
    assert set(search._rest_factors) >= {(0, (k, k + 1)) for k in range(4)}
    assert not any(hinge for hinge, _ in search._rest_factors)
    for k in range(4):
        assert search.times[k + 1] - search.times[k] >= rests[0, (k, k + 1)] - 1e-9


def test_work_of_each_linear_program_is_proportional_to_the_squared_number_of_keys(monkeypatch):
    search = search_of(budget=Budget(100.0))
    search._solve(set())
    assert search._budget.left == pytest.approx(100.0 - 25 / 400)


def test_stored_cutting_planes_that_cost_more_than_stops_are_not_reused():
    keys = keys_of()
    for bound, is_used in ((-0.35, True), (-9.0, False), (-0.1, False)):
        memory, plane = PlaneMemory(), CuttingPlane(sealed([0, 0, 1.0, -1.0, 0]), bound)
        memory.store(keys, JOINT_LIMITS, {0: [plane]}, {(2, 3): Bottleneck(0, "jerk", 9.0)}, keys.requested_times)
        search = KeyTimeSearch(keys, JOINT_LIMITS, 0.6, memory=memory)
        assert bool(search._planes) is is_used
        assert ((2, 3) in search.bottlenecks and search.bottlenecks[2, 3].ratio == 9.0) is is_used
        if is_used:
            assert search.times[3] - search.times[2] >= 0.35 - 1e-6


def test_spent_budget_gives_all_fast_segments_stops_at_their_keys():
    search = search_of(budget=Budget(-1.0))
    segment = first_segment(search)
    search.resolve(segment)
    assert set(search._rest_factors) >= set(segment.key_intervals)
    assert set(search._rest_factors.values()) == {1.0}
    before = dict(search._rest_factors)
    search.resolve(segment)
    assert {search._rest_factors[interval] for interval in segment.key_intervals} == {1.1}
    assert all(search._rest_factors[k] == before[k] for k in before if k not in segment.key_intervals)


def test_stored_cutting_planes_of_a_search_apply_to_the_next_search():
    memory = PlaneMemory()
    search = search_of(memory=memory)
    search.resolve(first_segment(search))
    assert search._all_planes
    search.store_planes()
    again = search_of(memory=memory)
    np.testing.assert_allclose(again.times, search.times, atol=1e-6)
    assert len(again._all_planes) == len(search._all_planes)


@pytest.mark.parametrize(("ratio", "hinges"), [(0.5, {0}), (1.0, {0}), (1.001, {0, 1})])
def test_spent_budget_gives_other_segments_stops_only_if_they_exceed_a_limit(monkeypatch, ratio, hinges):
    monkeypatch.setattr(key_times, "estimate_limit_ratio", lambda segment, limits: ratio if segment.hinge else 2.0)
    search = search_of(budget=Budget(-1.0))
    assert {item.hinge for item in search._find_segments(search.times)} == {0, 1}
    search.resolve(first_segment(search))
    assert {hinge for hinge, _ in search._rest_factors} == hinges


@pytest.mark.parametrize(("ratio", "hinges"), [(1.3, set()), (1.31, {1})])
def test_first_search_round_also_measures_other_segments_far_beyond_their_limits(monkeypatch, ratio, hinges):
    monkeypatch.setattr(key_times, "estimate_limit_ratio", lambda segment, limits: ratio)
    search, asked = search_of(), []
    find = search._find_infeasible
    monkeypatch.setattr(
        search, "_find_infeasible", lambda ways: asked.append({way.hinge for way in ways}) or find(ways)
    )
    segment = first_segment(search)
    search.resolve(segment)
    assert asked[:2] == [{0}, hinges]
    asked.clear()
    search.resolve(segment)
    assert asked[1] == set(), "later rounds leave them to their own turn"
