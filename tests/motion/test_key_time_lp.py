from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import key_time_lp
from kinesic.motion.key_time_lp import CuttingPlane, KeyTimeProblem, shift_cost, solve_key_times
from kinesic.motion.keys import Bond, KeyPosture, Keys

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def keys_of(*rows: tuple[float, float, str]) -> tuple[KeyPosture, ...]:
    return tuple(KeyPosture(time, sealed([angle]), (True,), (("b", sync),)) for time, angle, sync in rows)


def test_too_short_gap_between_keys_shifts_the_key_that_is_cheapest_to_shift():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), JOINT_LIMITS)
    times = solve_key_times(KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.5}, 0.6))
    assert times == pytest.approx([0.0, 0.7, 1.2, 2.0])


def test_feasible_requested_key_times_are_returned_without_a_linear_program(monkeypatch):
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), JOINT_LIMITS)
    kept = [CuttingPlane(sealed([0.0, 1.0, -1.0, 0.0]), -0.15)]
    met = KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.15}, 0.6, kept)
    for solve in ("_solve_small", "_solve_large"):
        monkeypatch.setattr(key_time_lp, solve, lambda problem: pytest.fail("there is nothing to solve"))
    np.testing.assert_array_equal(solve_key_times(met), keys.requested_times)


def test_start_key_moves_earlier_by_at_most_the_lead_in():
    keys = Keys.of(keys_of((0, 0, "start"), (0.5, 1, "stroke"), (2, 0, "end")), JOINT_LIMITS)
    assert solve_key_times(KeyTimeProblem(keys, keys.gaps | {(0, 1): 0.9}, 0.6)) == pytest.approx([-0.4, 0.5, 2.0])
    assert solve_key_times(KeyTimeProblem(keys, keys.gaps | {(0, 1): 1.5}, 0.6)) == pytest.approx([-0.6, 0.9, 2.0])


def test_cutting_plane_between_two_keys_is_equivalent_to_a_minimum_gap():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), JOINT_LIMITS)
    slopes = sealed([0.0, 2.0, -2.0, 0.0])
    times = solve_key_times(KeyTimeProblem(keys, keys.gaps, 0.6, [CuttingPlane(slopes, -1.0)]))
    assert times == pytest.approx(solve_key_times(KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.5}, 0.6)))


def test_infeasible_cutting_planes_raise_an_error():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "stroke")), JOINT_LIMITS)
    planes = [CuttingPlane(sealed([0.0, 1.0]), 0.5), CuttingPlane(sealed([0.0, -1.0]), -0.7)]
    with pytest.raises(ArithmeticError, match="no key times"):
        solve_key_times(KeyTimeProblem(keys, keys.gaps, 0.6, planes))


def random_problem(seed: int) -> KeyTimeProblem:
    """Return a random problem of close keys, cutting planes and precedence constraints."""
    chance = np.random.default_rng(seed)
    count = int(chance.integers(3, 13))
    syncs = chance.choice(["start", "ready", "stroke", "strokeEnd", "relax", "end"], count)
    asked = np.cumsum(chance.uniform(0.05, 0.6, count))
    postures = tuple(
        KeyPosture(float(time), sealed([angle]), (True,), ((f"b{k}", str(sync)),))
        for k, (time, angle, sync) in enumerate(zip(asked, chance.uniform(-1, 1, count), syncs, strict=True))
    )
    tied = [(int(k), int(k) + 1) for k in chance.choice(count - 1, 2)]
    bonds = tuple(Bond(postures[i].syncs[0], postures[j].syncs[0], float(chance.uniform(-0.2, 0.4))) for i, j in tied)
    keys = Keys.of(postures, JOINT_LIMITS, bonds)
    gaps = {pair: max(gap, float(chance.uniform(0.0, 0.7))) for pair, gap in keys.gaps.items()}
    planes = []
    for _ in range(int(chance.integers(0, 5))):
        first = int(chance.integers(0, count - 1))
        slopes = np.zeros(count)
        slopes[first : first + 2] = [2.0, -2.0]
        slopes[first : first + 3] += chance.normal(0.0, 0.5, len(slopes[first : first + 3]))
        planes.append(CuttingPlane(sealed(slopes - slopes.mean()), float(-chance.uniform(0.1, 1.0))))
    return KeyTimeProblem(keys, gaps, 0.6, planes)


def test_compiled_simplex_matches_highs():
    moved = 0
    for seed in range(80):
        problem = random_problem(seed)
        try:
            many = key_time_lp._solve_large(problem)
        except ArithmeticError:
            assert key_time_lp._solve_small(problem) is None
            continue
        few = key_time_lp._solve_small(problem)
        assert few is not None
        assert shift_cost(problem.keys, few) == pytest.approx(shift_cost(problem.keys, many), abs=1e-6)
        assert all(few[j] - few[i] >= gap - 1e-7 for (i, j), gap in problem.gaps.items())
        assert all(float(plane.slopes @ few) <= plane.bound + 1e-7 for plane in problem.planes)
        assert few.min() >= problem.keys.requested_times[0] - problem.lead_in - 1e-7
        moved += not np.allclose(few, problem.keys.requested_times)
    assert moved >= 40


def test_shift_cost_is_the_weighted_sum_of_key_time_shifts():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), JOINT_LIMITS)
    assert shift_cost(keys, keys.requested_times) == 0.0
    assert shift_cost(keys, np.add(keys.requested_times, [0.0, -0.3, 0.1, 0.0])) == pytest.approx(
        0.3 * 0.3 + 3.0 * 5.0 * 0.1
    )


@pytest.mark.parametrize("seed", range(12))
def test_key_times_shift_relative_to_each_other_by_at_most_the_total_deficit(seed):
    chance = np.random.default_rng(seed)
    syncs = chance.choice(["start", "ready", "stroke", "strokeEnd", "relax", "end"], 9)
    asked = np.cumsum(chance.uniform(0.05, 0.6, len(syncs)))
    keys = Keys.of(keys_of(*zip(asked, chance.uniform(-1.0, 1.0, len(syncs)), syncs, strict=True)), JOINT_LIMITS)
    pairs = [(i, j) for i, j in chance.integers(0, len(syncs), (12, 2)).tolist() if i < j]
    gaps = keys.gaps | {(i, j): float((asked[j] - asked[i]) * chance.uniform(0.6, 1.5)) for i, j in pairs}
    problem = KeyTimeProblem(keys, gaps, lead_in=0.0)
    moved = solve_key_times(problem) - keys.requested_times
    assert np.ptp(moved) <= problem.total_deficit + 1e-6
    assert (np.ptp(moved) > 0.0) == (problem.total_deficit > 0.0)


def crowded(monkeypatch) -> tuple[Keys, KeyTimeProblem]:
    """Return keys and a problem too large to solve exactly."""
    rows = keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (1.3, 0.5, "relax"), (2, 0, "end"))
    keys = Keys.of(rows, JOINT_LIMITS)
    monkeypatch.setattr(key_time_lp, "MAX_PROGRAM_SIZE", 1.0)
    monkeypatch.setattr(key_time_lp, "_solve_large", lambda problem: pytest.fail("that takes too long"))
    monkeypatch.setattr(key_time_lp, "_solve_small", lambda problem: pytest.fail("that takes too long"))
    return keys, KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.5, (2, 3): 0.6}, 0.6)


def test_solution_for_very_many_keys_only_delays_keys(monkeypatch):
    keys, problem = crowded(monkeypatch)
    assert problem.is_crowded
    assert solve_key_times(problem) == pytest.approx([0.0, 1.0, 1.5, 2.1, 2.1 + keys.gaps[3, 4]])


def test_very_many_keys_keep_their_precedence_constraints(monkeypatch):
    keys, problem = crowded(monkeypatch)
    bound = replace(problem, keys=replace(keys, bonds={(0, 4): 3.0, (4, 1): -2.0}))
    times = solve_key_times(bound)
    assert times[4] - times[0] >= 3.0 - 1e-9
    assert times[1] - times[4] >= -2.0 - 1e-9
    assert all(times[j] - times[i] >= gap - 1e-9 for (i, j), gap in bound.gaps.items())


def test_very_many_keys_that_violate_a_cutting_plane_raise_an_error(monkeypatch):
    _, problem = crowded(monkeypatch)
    excluded = replace(problem, planes=[CuttingPlane(sealed([0.0, 0.0, 0.0, 1.0, -1.0]), -1.0)])
    with pytest.raises(ArithmeticError, match="too many keys"):
        solve_key_times(excluded)


def test_key_time_problem_with_few_delayed_keys_is_not_simplified():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), JOINT_LIMITS)
    assert not KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.5}, 0.6).is_crowded
