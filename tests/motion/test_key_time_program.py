"""Tests of constraints and costs of the key-time linear program."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import key_time_lp
from kinesic.motion.key_time_lp import (
    CuttingPlane,
    KeyTimeProblem,
    build_program,
    extend_gaps,
    shift_cost,
    solve_exactly,
    solve_key_times,
)
from kinesic.motion.keys import KeyPosture, Keys

from ..reference.motion.spline_programs import sparse

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def keys_of(*rows: tuple[float, str], bonds=None) -> Keys:
    postures = tuple(KeyPosture(time, sealed([0.0]), (True,), (("b", sync),)) for time, sync in rows)
    return replace(Keys.of(postures, JOINT_LIMITS), bonds=bonds or {})


# keys of one stroke, at times [s] and sync points
STROKE_KEYS = keys_of((3.0, "start"), (3.5, "ready"), (4.0, "stroke"), (6.0, "end"))
# two planes, with slopes for the four keys and a bound
CUTTING_PLANES = [CuttingPlane(sealed([0.0, 2.0, -2.0, 0.0]), -1.0), CuttingPlane(sealed([1.0, 0.0, 0.0, -3.0]), 5.0)]


def test_rows_of_the_key_time_program_are_gaps_precedence_constraints_cutting_planes_and_shifts():
    keys = replace(STROKE_KEYS, bonds={(0, 2): 1.5, (3, 1): -2.0})
    program = build_program(KeyTimeProblem(keys, {(0, 1): 0.1, (1, 2): 0.2}, 0.6, CUTTING_PLANES))
    times, late, early, broken = np.eye(14)[:4], np.eye(14)[4:8], np.eye(14)[8:12], np.eye(14)[12:]
    expected = [
        times[0] - times[1],
        times[1] - times[2],
        times[0] - times[2] - broken[0],
        times[3] - times[1] - broken[1],
        2 * times[1] - 2 * times[2],
        times[0] - 3 * times[3],
        *(times - late + early),
    ]
    np.testing.assert_array_equal(sparse(program.matrix).toarray(), expected)
    np.testing.assert_array_equal(program.upper, [-0.1, -0.2, -1.5, 2.0, -1.0, 5.0, 3.0, 3.5, 4.0, 6.0])
    np.testing.assert_array_equal(program.lower, [-np.inf] * 6 + [3.0, 3.5, 4.0, 6.0])
    np.testing.assert_allclose(program.lower_bounds, [2.4] * 4 + [0.0] * 10)
    np.testing.assert_allclose(program.costs, [0] * 4 + [0.15, 0.9, 15.0, 0.15] + [0.05, 0.3, 5.0, 0.05] + [50.0, 50.0])


def test_key_time_program_without_precedence_constraints_and_cutting_planes_has_only_gaps_and_shifts():
    program = build_program(KeyTimeProblem(STROKE_KEYS, {(0, 3): 0.1}, 0.0))
    assert program.matrix.shape == (5, 12)
    assert program.upper.tolist() == [-0.1, 3.0, 3.5, 4.0, 6.0]
    assert program.lower_bounds[:4].tolist() == [3.0] * 4


@pytest.mark.parametrize(
    ("change", "is_satisfied"),
    [
        ({"gaps": {(0, 1): 0.5, (1, 3): 2.5}}, True),
        ({"gaps": {(0, 1): 0.5, (1, 3): 2.5 + 1e-9}}, False),
        ({"bonds": {(0, 1): 0.5}}, True),
        ({"bonds": {(0, 1): 0.5, (3, 2): -1.9}}, False),
        ({"planes": [CuttingPlane(sealed([0.0, 1.0, 0.0, 0.0]), 3.5)]}, True),
        ({"planes": [CUTTING_PLANES[0], CuttingPlane(sealed([0.0, 1.0, 0.0, 0.0]), 3.4)]}, False),
    ],
)
def test_requested_key_times_need_no_program_if_they_keep_every_constraint_exactly(change, is_satisfied):
    keys = replace(STROKE_KEYS, bonds=change.get("bonds", {}))
    problem = KeyTimeProblem(keys, change.get("gaps", {}), 0.6, change.get("planes", ()))
    assert problem.is_satisfied_as_requested is is_satisfied


def test_total_deficit_of_a_key_time_problem_is_the_sum_of_the_missing_gaps():
    assert KeyTimeProblem(STROKE_KEYS, {(0, 1): 0.7, (1, 2): 0.4, (2, 3): 2.3}, 0.6).total_deficit == pytest.approx(0.5)
    assert KeyTimeProblem(STROKE_KEYS, {}, 0.6).total_deficit == 0.0


@pytest.mark.parametrize(("most", "is_crowded"), [(8.0, False), (7.9, True)])
def test_key_time_problem_is_simplified_if_key_count_times_violated_gaps_exceeds_a_limit(monkeypatch, most, is_crowded):
    monkeypatch.setattr(key_time_lp, "MAX_PROGRAM_SIZE", most)
    gaps = {(0, 1): 0.7, (1, 2): 0.5, (2, 3): 2.3, (0, 3): 3.0}
    assert KeyTimeProblem(STROKE_KEYS, gaps, 0.6).is_crowded is is_crowded


@pytest.mark.parametrize(("count", "is_crowded"), [(2000, False), (2001, True)])
def test_key_time_problem_is_simplified_if_key_count_times_violated_gaps_exceeds_8_million(count, is_crowded):
    many = replace(STROKE_KEYS, requested_times=np.arange(float(count)))
    violated = dict.fromkeys(((i, j) for i in range(4) for j in range(4, 1004)), 1e9)
    assert KeyTimeProblem(many, violated, 0.6).is_crowded is is_crowded


@pytest.mark.parametrize(("entries", "is_small"), [(4 * (3 + 2 + 4), True), (4 * (3 + 2 + 4) - 1, False)])
def test_compiled_simplex_solves_key_time_problems_up_to_a_number_of_matrix_entries(monkeypatch, entries, is_small):
    problem = KeyTimeProblem(STROKE_KEYS, {(0, 1): 0.6, (1, 2): 0.6, (2, 3): 2.1}, 0.6, CUTTING_PLANES)
    monkeypatch.setattr(key_time_lp, "MAX_DENSE_ENTRIES", entries)
    assert (key_time_lp._solve_small(problem) is not None) is is_small
    np.testing.assert_allclose(solve_exactly(problem), key_time_lp._solve_large(problem), atol=1e-6)


@pytest.mark.parametrize(("count", "is_small"), [(99, True), (101, False)])
def test_compiled_simplex_solves_problems_of_99_but_not_of_101_keys(count, is_small):
    keys = keys_of(*((0.1 * k, "relax") for k in range(count)))
    problem = KeyTimeProblem(keys, keys.gaps | {(0, 1): 0.2}, 0.6)
    assert (key_time_lp._solve_small(problem) is not None) is is_small


def test_simplex_result_that_violates_a_constraint_beyond_rounding_is_rejected(monkeypatch):
    problem = KeyTimeProblem(STROKE_KEYS, {(0, 1): 0.5, (1, 2): 0.6}, 0.6)
    exact = key_time_lp._solve_small(problem) - STROKE_KEYS.requested_times
    for error, is_used in ((0.5e-7, True), (1.6e-7, False), (1e-3, False)):
        moved = exact + np.array([0.0, error, 0.0, 0.0])
        monkeypatch.setattr(key_time_lp.kernel, "move_keys", lambda *given, moved=moved: moved)
        assert (key_time_lp._solve_small(problem) is not None) is is_used


def test_violation_of_a_precedence_constraint_costs_50_per_second_and_is_allowed():
    for bonds, expected in (({(1, 2): 0.8}, 3.2), ({(1, 2): -5.0}, 3.5)):
        keys = replace(STROKE_KEYS, bonds=bonds)
        problem = KeyTimeProblem(keys, {(0, 1): 0.0, (2, 3): 1.0}, 0.0)
        for solve in (key_time_lp._solve_small, key_time_lp._solve_large):
            assert solve(problem)[1] == pytest.approx(expected)
    late = replace(STROKE_KEYS, bonds={(1, 0): 0.1})
    problem = KeyTimeProblem(late, {(0, 1): 0.2}, 0.0)
    assert shift_cost(late, np.array([3.0, 3.2, 4.0, 6.0])) == pytest.approx(0.3 * 0.3 + 50.0 * 0.3)
    for solve in (key_time_lp._solve_small, key_time_lp._solve_large):
        times = solve(problem)
        assert times[1] - times[0] == pytest.approx(0.2)


def test_key_time_shifts_below_100_ns_are_ignored(monkeypatch):
    problem = KeyTimeProblem(STROKE_KEYS, {(0, 1): 0.6}, 0.6)
    for shift, is_kept in ((0.7e-7, True), (-0.7e-7, True), (1.6e-7, False), (-1.6e-7, False)):
        monkeypatch.setattr(
            key_time_lp, "solve_exactly", lambda given, shift=shift: STROKE_KEYS.requested_times + shift
        )
        assert np.array_equal(solve_key_times(problem), STROKE_KEYS.requested_times) is is_kept


def test_simplified_solution_delays_keys_in_order_until_gaps_and_precedence_constraints_hold(monkeypatch):
    monkeypatch.setattr(key_time_lp, "MAX_PROGRAM_SIZE", 1.0)
    keys = replace(STROKE_KEYS, bonds={(0, 2): 1.4, (2, 3): 2.0})
    delayed = solve_key_times(KeyTimeProblem(keys, {(0, 1): 0.7, (1, 2): 0.5, (2, 3): 0.1}, 0.6))
    assert delayed == pytest.approx([3.0, 3.7, 4.4, 6.4])
    edge = CuttingPlane(sealed([0.0, 0.0, 0.0, 1.0]), float(delayed[3]))
    planned = KeyTimeProblem(keys, {(0, 1): 0.7, (1, 2): 0.5, (2, 3): 0.1}, 0.6, [edge])
    np.testing.assert_array_equal(solve_key_times(planned), delayed)


def test_simplified_solution_ends_after_eight_sweeps_if_precedence_constraints_contradict(monkeypatch):
    monkeypatch.setattr(key_time_lp, "MAX_PROGRAM_SIZE", 1.0)
    keys = replace(STROKE_KEYS, bonds={(1, 2): 1.0, (2, 1): 1.0})
    delayed = solve_key_times(KeyTimeProblem(keys, {(0, 1): 0.7}, 0.6))
    assert delayed == pytest.approx([3.0, 11.7, 12.0, 6.0])


def test_minimum_gaps_are_extended_to_the_longest_duration_of_any_hinge():
    gaps = {(0, 1): 0.5, (1, 2): 0.02}
    durations = {(0, (0, 1)): 0.3, (1, (0, 1)): 0.7, (2, (0, 1)): 0.6, (0, (1, 2)): 0.01}
    assert extend_gaps(gaps, durations) == {(0, 1): 0.7, (1, 2): 0.02}
    assert gaps == {(0, 1): 0.5, (1, 2): 0.02}


def test_late_keys_cost_three_times_as_much_as_early_ones():
    for shifts, cost in (
        ([0.2, 0.0, 0.0, 0.0], 3 * 0.05 * 0.2),
        ([-0.2, 0.0, 0.0, 0.0], 0.05 * 0.2),
        ([0.0, -0.1, 0.1, 0.0], 0.3 * 0.1 + 3 * 5.0 * 0.1),
    ):
        assert shift_cost(STROKE_KEYS, STROKE_KEYS.requested_times + np.array(shifts)) == pytest.approx(cost)
    bound = replace(STROKE_KEYS, bonds={(0, 1): 0.4, (1, 2): 0.6, (2, 3): 2.5})
    assert shift_cost(bound, STROKE_KEYS.requested_times) == pytest.approx(50.0 * 0.6)
