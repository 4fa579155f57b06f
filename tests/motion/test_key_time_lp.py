from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import key_time_lp
from kinesic.motion.key_time_lp import CuttingPlane, KeyTimeProblem, relax_key_times, strain
from kinesic.motion.keys import Bond, KeyPosture, Keys

LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def keys_of(*rows: tuple[float, float, str]) -> tuple[KeyPosture, ...]:
    return tuple(KeyPosture(time, sealed([angle]), (True,), (("b", sync),)) for time, angle, sync in rows)


def test_gaps_push_the_cheapest_key():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), LIMITS)
    times = relax_key_times(KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.5}, 0.6))
    assert times == pytest.approx([0.0, 0.7, 1.2, 2.0])


def test_times_that_keep_everything_as_asked_need_no_program(monkeypatch):
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), LIMITS)
    kept = [CuttingPlane(sealed([0.0, 1.0, -1.0, 0.0]), -0.15)]
    met = KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.15}, 0.6, kept)
    for solve in ("_relax_few", "_relax_many"):
        monkeypatch.setattr(key_time_lp, solve, lambda problem: pytest.fail("there is nothing to solve"))
    np.testing.assert_array_equal(relax_key_times(met), keys.asked)


def test_the_lead_in_lets_the_start_come_earlier_and_no_more():
    keys = Keys.of(keys_of((0, 0, "start"), (0.5, 1, "stroke"), (2, 0, "end")), LIMITS)
    assert relax_key_times(KeyTimeProblem(keys, keys.gaps | {(0, 1): 0.9}, 0.6)) == pytest.approx([-0.4, 0.5, 2.0])
    assert relax_key_times(KeyTimeProblem(keys, keys.gaps | {(0, 1): 1.5}, 0.6)) == pytest.approx([-0.6, 0.9, 2.0])


def test_cuts_are_kept_as_gaps_are():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), LIMITS)
    slopes = sealed([0.0, 2.0, -2.0, 0.0])
    times = relax_key_times(KeyTimeProblem(keys, keys.gaps, 0.6, [CuttingPlane(slopes, -1.0)]))
    assert times == pytest.approx(relax_key_times(KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.5}, 0.6)))


def test_cuts_that_leave_nothing_are_told():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "stroke")), LIMITS)
    cuts = [CuttingPlane(sealed([0.0, 1.0]), 0.5), CuttingPlane(sealed([0.0, -1.0]), -0.7)]
    with pytest.raises(ArithmeticError, match="no key times"):
        relax_key_times(KeyTimeProblem(keys, keys.gaps, 0.6, cuts))


def random_problem(seed: int) -> KeyTimeProblem:
    """Up to twelve keys that are too near to one another, with planes over some of them, and bonds that may break."""
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
    keys = Keys.of(postures, LIMITS, bonds)
    gaps = {pair: max(gap, float(chance.uniform(0.0, 0.7))) for pair, gap in keys.gaps.items()}
    cuts = []
    for _ in range(int(chance.integers(0, 5))):
        first = int(chance.integers(0, count - 1))
        slopes = np.zeros(count)
        slopes[first : first + 2] = [2.0, -2.0]
        slopes[first : first + 3] += chance.normal(0.0, 0.5, len(slopes[first : first + 3]))
        cuts.append(CuttingPlane(sealed(slopes - slopes.mean()), float(-chance.uniform(0.1, 1.0))))
    return KeyTimeProblem(keys, gaps, 0.6, cuts)


@pytest.mark.skipif(key_time_lp.KERNEL == "numpy", reason="there is no compiled kernel")
def test_the_kernel_moves_keys_as_little_as_highs_does():
    moved = 0
    for seed in range(200):
        problem = random_problem(seed)
        try:
            many = key_time_lp._relax_many(problem)
        except ArithmeticError:
            assert key_time_lp._relax_few(problem) is None
            continue
        few = key_time_lp._relax_few(problem)
        assert few is not None
        assert strain(problem.keys, few) == pytest.approx(strain(problem.keys, many), abs=1e-6)
        assert all(few[j] - few[i] >= gap - 1e-7 for (i, j), gap in problem.gaps.items())
        assert all(float(cut.slopes @ few) <= cut.bound + 1e-7 for cut in problem.cuts)
        assert few.min() >= problem.keys.asked[0] - problem.lead_in - 1e-7
        moved += not np.allclose(few, problem.keys.asked)
    assert moved >= 100


def test_the_strain_is_what_is_made_least():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), LIMITS)
    assert strain(keys, keys.asked) == 0.0
    assert strain(keys, np.add(keys.asked, [0.0, -0.3, 0.1, 0.0])) == pytest.approx(0.3 * 0.3 + 3.0 * 5.0 * 0.1)


@pytest.mark.parametrize("seed", range(12))
def test_no_two_keys_move_apart_by_more_than_all_gaps_lack(seed):
    chance = np.random.default_rng(seed)
    syncs = chance.choice(["start", "ready", "stroke", "strokeEnd", "relax", "end"], 9)
    asked = np.cumsum(chance.uniform(0.05, 0.6, len(syncs)))
    keys = Keys.of(keys_of(*zip(asked, chance.uniform(-1.0, 1.0, len(syncs)), syncs, strict=True)), LIMITS)
    pairs = [(i, j) for i, j in chance.integers(0, len(syncs), (12, 2)).tolist() if i < j]
    gaps = keys.gaps | {(i, j): float((asked[j] - asked[i]) * chance.uniform(0.6, 1.5)) for i, j in pairs}
    problem = KeyTimeProblem(keys, gaps, lead_in=0.0)
    moved = relax_key_times(problem) - keys.asked
    assert np.ptp(moved) <= problem.lacking + 1e-6
    assert (np.ptp(moved) > 0.0) == (problem.lacking > 0.0)


def crowded(monkeypatch) -> tuple[Keys, KeyTimeProblem]:
    """A program that counts as crowded, with a bond between its first stroke and its last key."""
    rows = keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (1.3, 0.5, "relax"), (2, 0, "end"))
    keys = Keys.of(rows, LIMITS)
    monkeypatch.setattr(key_time_lp, "MAX_PUSHED_KEYS", 1.0)
    monkeypatch.setattr(key_time_lp, "_relax_many", lambda problem: pytest.fail("that takes too long"))
    monkeypatch.setattr(key_time_lp, "_relax_few", lambda problem: pytest.fail("that takes too long"))
    return keys, KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.5, (2, 3): 0.6}, 0.6)


def test_a_crowd_of_keys_is_only_made_later_one_after_the_other(monkeypatch):
    keys, problem = crowded(monkeypatch)
    assert problem.is_crowded
    assert relax_key_times(problem) == pytest.approx([0.0, 1.0, 1.5, 2.1, 2.1 + keys.gaps[3, 4]])


def test_a_crowd_of_keys_keeps_its_bonds(monkeypatch):
    keys, problem = crowded(monkeypatch)
    bound = replace(problem, keys=replace(keys, bonds={(0, 4): 3.0, (4, 1): -2.0}))
    times = relax_key_times(bound)
    assert times[4] - times[0] >= 3.0 - 1e-9
    assert times[1] - times[4] >= -2.0 - 1e-9
    assert all(times[j] - times[i] >= gap - 1e-9 for (i, j), gap in bound.gaps.items())


def test_a_crowd_of_keys_that_would_miss_a_cut_has_no_times(monkeypatch):
    _, problem = crowded(monkeypatch)
    cut = replace(problem, cuts=[CuttingPlane(sealed([0.0, 0.0, 0.0, 1.0, -1.0]), -1.0)])
    with pytest.raises(ArithmeticError, match="too many keys"):
        relax_key_times(cut)


def test_few_pushed_keys_are_no_crowd():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "ready"), (1.2, 0, "stroke"), (2, 0, "end")), LIMITS)
    assert not KeyTimeProblem(keys, keys.gaps | {(1, 2): 0.5}, 0.6).is_crowded
