"""Tests of the nonlinear key-time program on motions with known derivatives."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import casadi
import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import optimum
from kinesic.motion.condition import Conditioned, condition
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.optimum import (
    _between,
    _find_infeasible,
    _HingeMotion,
    _Program,
    _separate_requested_times,
    best_times,
)

# limits of two hinges, in the order of the fields of `Limits`
LIMIT_ROWS = ([-2, -1.5], [2, 1.7], [4, 3], [40, 30], [1e3, 800], [0.01, 0.012], [0.15, 0.1], [0.7, 0.6])
JOINT_LIMITS = Limits(*map(sealed, LIMIT_ROWS))  # limits of two hinges


def keys_of(*rows: tuple[float, float]) -> Keys:
    postures = (
        KeyPosture(t, sealed([0.0, angle]), (True, True), (("b", f"k{k}"),)) for k, (t, angle) in enumerate(rows)
    )
    return Keys.of(tuple(postures), JOINT_LIMITS)


MOTION_KEYS = keys_of((0.0, 0.0), (0.5, 0.8), (0.8, 0.2), (2.0, 0.9))  # keys at times [s] with angles [rad]


def hinge_motion(counts=(3, 4, 2), angles=(0.0, 0.8, 0.2, 0.9)) -> _HingeMotion:
    return _HingeMotion(1, JOINT_LIMITS, np.arange(len(angles)), np.array(angles), np.array(counts))


def test_optimal_motion_divides_key_intervals_into_20_ms_steps_but_at_least_8_and_at_most_24():
    motion = SimpleNamespace(planned=np.array([0.0, 0.05, 0.241, 0.241 + 0.4, 9.0]))
    five = keys_of((0, 0), (1, 0.3), (2, 0.1), (3, 0.2), (4, 0.6))
    own = _HingeMotion.of(five, 1, motion, JOINT_LIMITS)
    assert own.counts.tolist() == [8, 10, 20, 24]
    assert (own.hinge, own.rows.tolist(), own.limits) == (1, [0, 1, 2, 3, 4], JOINT_LIMITS)
    np.testing.assert_allclose(own.angles, [0.0, 0.3, 0.1, 0.2, 0.6])


def test_angle_range_of_steps_next_to_a_key_covers_both_adjacent_key_intervals():
    lowest, highest = hinge_motion()._corridor()
    expected_low = [-0.08, -0.08, -0.08, -0.08, 0.14, 0.14, 0.13, 0.13, 0.13]
    expected_high = [0.88, 0.88, 0.88, 0.88, 0.86, 0.86, 0.97, 0.97, 0.97]
    np.testing.assert_allclose(lowest, expected_low)
    np.testing.assert_allclose(highest, expected_high)


def test_angle_range_of_small_moves_exceeds_their_keys_by_0_05_rad_within_the_joint_range():
    lowest, highest = hinge_motion((2,), (1.65, 1.69))._corridor()
    np.testing.assert_allclose(lowest, [1.6, 1.6])
    np.testing.assert_allclose(highest, [1.7, 1.7])
    lowest, highest = hinge_motion((2,), (-1.3, -1.49))._corridor()
    np.testing.assert_allclose(lowest, [-1.5, -1.5])
    np.testing.assert_allclose(highest, [-1.25, -1.25])


def test_requested_times_of_successive_keys_are_separated_by_at_least_40_ms():
    keys = replace(MOTION_KEYS, requested_times=sealed([1.0, 1.03, 1.04, 0.5]))
    np.testing.assert_allclose(_separate_requested_times(keys), [1.0, 1.04, 1.08, 0.5])
    np.testing.assert_allclose(_separate_requested_times(MOTION_KEYS), MOTION_KEYS.requested_times)


def test_infeasible_hinges_are_moving_hinges_without_enough_time():
    assert _find_infeasible(MOTION_KEYS.requested_times * 0.3, MOTION_KEYS, JOINT_LIMITS) == {1}
    assert _find_infeasible(MOTION_KEYS.requested_times * 3.0, MOTION_KEYS, JOINT_LIMITS) == set()


@pytest.mark.parametrize(("amount", "expected"), [(None, {1}), (0.9e-4, set()), (1.6e-4, {1}), (-1.0, set())])
def test_hinge_with_a_time_deficit_above_0_0001_or_an_unknown_one_is_infeasible(monkeypatch, amount, expected):
    deficit = None if amount is None else SimpleNamespace(amount=amount)
    monkeypatch.setattr(optimum, "measure_time_deficit", lambda segment, limits: deficit)
    assert _find_infeasible(MOTION_KEYS.requested_times, MOTION_KEYS, JOINT_LIMITS) == expected


def test_parabola_limits_are_required_at_three_points_that_enclose_the_parabola():
    program, u = _Program(), np.linspace(0.0, 1.0, 101)
    begin, slope, bend = np.array([[0.3, -0.9], [2.0, 0.5], [-3.0, 1.0]])
    end = begin + slope + bend / 2
    _between(program, *(casadi.DM(part) for part in (begin, end, slope, bend)))
    first, last, middle = (np.array(row).ravel() for row in program.rows)
    np.testing.assert_allclose(first, begin + slope / 4)
    np.testing.assert_allclose(last, end - (slope + bend) / 4)
    np.testing.assert_allclose(middle, begin + slope / 2 + bend / 8)
    for k in (0, 1):
        curve = begin[k] + slope[k] * u + bend[k] * u**2 / 2
        enclosing = [begin[k], first[k], middle[k], last[k], end[k]]
        assert min(enclosing) <= curve.min() <= curve.max() <= max(enclosing)
    for lower, upper in program.bounds:
        assert (lower.tolist(), upper.tolist()) == ([-1.0, -1.0], [1.0, 1.0])


def integrate(own: _HingeMotion, times, jerks, start: float) -> tuple[np.ndarray, ...]:
    """Integrate given jerks to durations, angles, velocities and accelerations of intervals."""
    h = np.concatenate([np.full(n, gap / n) for gap, n in zip(np.diff(times), own.counts, strict=True)])
    q, v, a = [start], [0.0], [0.0]
    for step, jerk in zip(h, jerks, strict=True):
        q.append(q[-1] + v[-1] * step + a[-1] * step**2 / 2 + jerk * step**3 / 6)
        v.append(v[-1] + a[-1] * step + jerk * step**2 / 2)
        a.append(a[-1] + jerk * step)
    return h, np.array(q), np.array(v), np.array(a)


@pytest.fixture(scope="module")
def planned() -> Conditioned:
    postures = [
        KeyPosture(t, sealed([0.0, angle]), (True, True), (("b", f"k{k}"),))
        for k, (t, angle) in enumerate(((0.0, 0.0), (0.5, 0.8), (0.8, 0.2), (2.0, 0.9)))
    ]
    return condition(tuple(postures), JOINT_LIMITS)


def test_constraint_rows_of_the_optimum_program_match_an_integrated_motion(planned):
    own, times = hinge_motion(), np.array([0.1, 0.5, 0.9, 1.5])
    program = _Program()
    symbol = program.variable(times, -np.inf, np.inf)
    own.join(program, symbol, planned, np.asarray(planned.planned))
    jerks = np.random.default_rng(4).normal(0.0, 20.0, 9)
    h, q, v, a = integrate(own, times, jerks, 0.3)
    values = casadi.vertcat(*map(casadi.DM, (times, q, v / 3.0, a / 30.0, jerks / 800.0)))
    evaluate = casadi.Function("rows", [casadi.vertcat(*program.symbols)], program.rows)
    bends, speeds, angles, hull, duty, *between = (np.array(row).ravel() for row in evaluate(values))
    for row in (bends, speeds, angles):
        assert row.shape == (9,)
        np.testing.assert_allclose(row, 0.0, atol=1e-9)
    np.testing.assert_allclose(hull, [*(q[:-1] + v[:-1] * h / 3), *(q[1:] - v[1:] * h / 3)])
    loads, rises = (0.012 * a + 0.1 * v) / 0.6, (0.012 * jerks + 0.1 * a[:-1]) / 0.6 * h
    np.testing.assert_allclose(duty, loads)
    for rows, ends, slope, bend in (
        (between[:3], v / 3.0, a[:-1] * h / 3.0, jerks * h**2 / 3.0),
        (between[3:], loads, rises, 0.1 * jerks * h**2 / 0.6),
    ):
        np.testing.assert_allclose(rows[0], ends[:-1] + slope / 4)
        np.testing.assert_allclose(rows[1], ends[1:] - (slope + bend) / 4)
        np.testing.assert_allclose(rows[2], ends[:-1] + slope / 2 + bend / 8)
    equal, ranges, ratios = program.bounds[:3], program.bounds[3], program.bounds[4:]
    assert all(not lower.any() and not upper.any() for lower, upper in equal)
    np.testing.assert_array_equal(ranges[0], np.tile(own._corridor()[0], 2))
    np.testing.assert_array_equal(ranges[1], np.tile(own._corridor()[1], 2))
    assert all((lower == -1.0).all() and (upper == 1.0).all() for lower, upper in ratios)


def test_start_values_of_the_optimum_program_are_within_bounds_and_pass_the_keys(planned):
    own, program = hinge_motion(), _Program()
    symbol = program.variable(np.asarray(planned.planned), -np.inf, np.inf)
    own.join(program, symbol, planned, np.asarray(planned.planned))
    _, (q, lower, upper), *derivatives, (jerk, least, most) = program.values
    passed = [0, 3, 7, 9]
    for angles in (q, lower, upper):
        np.testing.assert_array_equal(angles[passed], own.angles)
    np.testing.assert_allclose(lower[[1, 2, 4, 5, 6, 8]], [-0.08, -0.08, -0.08, 0.14, 0.13, 0.13])
    np.testing.assert_allclose(upper[[1, 2, 4, 5, 6, 8]], [0.88, 0.88, 0.88, 0.86, 0.97, 0.97])
    for begin, low, high in derivatives:
        np.testing.assert_array_equal(high, [0, *[1] * 8, 0])
        np.testing.assert_array_equal(low, -high)
        assert np.all(np.abs(begin) <= high)
    assert (len(jerk), set(least.tolist()), set(most.tolist())) == (9, {-1.0}, {1.0})
    assert np.all(np.abs(jerk) <= 1.0)


@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_start_values_of_the_optimum_program_are_the_planned_motion_scaled_in_time(planned, factor):
    own, times = hinge_motion((8, 8, 8)), np.asarray(planned.planned)
    (q, v, a), jerks = own._begin(planned, factor * times)
    at = np.concatenate([*(np.linspace(b, e, 8, endpoint=False) for b, e in pairwise(times)), times[-1:]])
    samples = planned.trajectory.sample(at + planned.trajectory.zero)
    for values, order in zip((q, v, a), range(3), strict=True):
        np.testing.assert_allclose(values, samples[order][:, 1] / factor**order, atol=1e-12)
    h = np.repeat(np.diff(factor * times) / 8, 8)
    np.testing.assert_allclose(jerks, np.diff(a) / h)


def test_start_velocities_are_lower_only_in_the_stretched_key_interval(planned):
    own, times = hinge_motion((8, 8, 8)), np.asarray(planned.planned)
    longer = times + np.array([0.0, 0.0, 0.3, 0.3])
    (_, usual, _), _ = own._begin(planned, times)
    (_, slower, _), _ = own._begin(planned, longer)
    ratio = (times[2] - times[1]) / (longer[2] - longer[1])
    expected = usual * np.repeat([1.0, ratio, 1.0], [8, 8, 9])
    np.testing.assert_allclose(slower, expected, atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("kind", ["angle", "speed", "acceleration", "jerk", "duty"])
def test_limit_excess_is_the_largest_limit_ratio_also_between_step_ends(kind, sign):
    own = hinge_motion((2, 2), (0.0, 0.5, 0.0))
    times = np.array([0.0, 0.4, 0.8])
    q, v, a, j = np.full(5, 0.1), np.zeros(5), np.zeros(5), np.zeros(4)
    loose = {"speed": 1e6, "acceleration": 1e6, "jerk": 1e6, "duty": 1e6, "lower": -1e6, "upper": 1e6}
    j[1], a[1], v[1], q[1] = 2.0, -0.3, 0.05, -0.2
    if kind == "angle":
        tight = {"lower": -1.0, "upper": 0.4}
    else:
        tight = {kind: {"speed": 0.3, "acceleration": 0.5, "jerk": 7.0, "duty": 0.02}[kind]}
    limits = replace(JOINT_LIMITS, **{name: sealed([1.0, value]) for name, value in (loose | tight).items()})
    top = [getattr(limits, name)[1] for name in ("speed", "acceleration", "jerk")]
    values = [sign * q, sign * v / top[0], sign * a / top[1], sign * j / top[2]]
    own = replace(own, limits=limits)
    u = np.linspace(0.0, 0.2, 17)
    curves = {
        "speed": 0.05 - 0.3 * u + u**2,
        "acceleration": -0.3 + 2.0 * u,
        "jerk": np.array([2.0]),
        "duty": 0.012 * (-0.3 + 2.0 * u) + 0.1 * (0.05 - 0.3 * u + u**2),
        "angle": sign * (-0.2 + 0.05 * u - 0.15 * u**2 + u**3 / 3),
    }
    if kind == "angle":
        others = np.append(curves["angle"], sign * 0.1)
        expected = np.abs((others + 0.3) / 0.7).max()
    else:
        expected = np.abs(curves[kind]).max() / top_of(limits, kind)
    assert own.excess(times, values) == pytest.approx(expected, rel=1e-6)


def top_of(limits: Limits, name: str) -> float:
    return float(getattr(limits, name)[1])


def test_nonlinear_program_returns_the_constrained_minimum_or_none_if_infeasible():
    program = _Program()
    x = program.variable(np.zeros(2), [-1.0, -5.0], 2.0)
    y = program.variable(np.zeros(1), 0.0, np.inf)
    program.require(x[0] + x[1], -3.0, 3.0)
    program.require(y - x[0], 0.5, 0.5)
    first, second = program.solve(casadi.sumsqr(x - casadi.DM([9.0, -9.0])) + 0 * y)
    np.testing.assert_allclose(first, [2.0, -5.0], atol=1e-4)
    np.testing.assert_allclose(second, [2.5], atol=1e-4)
    program.require(x[0], 3.0, 4.0)
    assert program.solve(casadi.sumsqr(x)) is None


def test_optimal_key_times_keep_minimum_gaps_and_feasible_precedence_constraints(planned):
    keys = replace(MOTION_KEYS, bonds={(0, 2): 2.5, (0, 3): -9.0})
    best = best_times(keys, planned, JOINT_LIMITS, 0.1)
    assert best.times[0] >= -0.1 - 1e-6
    assert best.times[2] - best.times[0] == pytest.approx(2.5, abs=1e-4)
    assert all(best.times[j] - best.times[i] >= gap - 1e-6 for (i, j), gap in keys.gaps.items())
