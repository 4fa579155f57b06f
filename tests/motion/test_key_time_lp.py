import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import key_time_lp
from kinesic.motion.key_time_lp import CuttingPlane, KeyTimeProblem, relax_key_times, strain
from kinesic.motion.keys import KeyPosture, Keys

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
    monkeypatch.setattr(key_time_lp, "state_program", lambda problem: pytest.fail("there is nothing to solve"))
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
