"""Dry runs that share a process: at once, one within another, one after another."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from kinesic.controller.perform import dry_runs
from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors

LATE_AND_LOOSE = Factors(gain=0.7, latency=0.013, play=0.004)
SAGGING = Factors(resistance=0.2)  # [ohm]


def arrays(run):
    """All that was measured of hinges, hands, clearance and power."""
    measured = run.measured
    of_hinges = [getattr(measured, name) for name in ("times", "angles", "speeds", "torques", "duties", "goals")]
    return [
        *of_hinges,
        *measured.hands.values(),
        measured.clearance.distances,
        measured.power.mean,
        measured.power.peak,
    ]


def assert_the_same(runs, others):
    for run, other in zip(runs, others, strict=True):
        assert all(np.array_equal(one, same) for one, same in zip(arrays(run), arrays(other), strict=True))


@pytest.fixture
def hasty():
    """Has threads take turns every 10 us, so that they get into each other's way wherever they can."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    yield
    sys.setswitchinterval(usual)


@pytest.mark.parametrize("twins", [(NOMINAL, LATE_AND_LOOSE), (SAGGING,)], ids=["compiled", "in Python"])
def test_threads_may_perform_at_once(calm, hasty, twins):
    alone = dry_runs(calm.plan, twins, watch=False)
    with ThreadPoolExecutor(3) as threads:
        for together in threads.map(lambda _: dry_runs(calm.plan, twins, watch=False), range(6)):
            assert_the_same(together, alone)


def test_whoever_hears_of_progress_may_perform_meanwhile(calm):
    alone = dry_runs(calm.plan, (NOMINAL,), watch=False)
    inner = []
    outer = dry_runs(
        calm.plan,
        (NOMINAL,),
        watch=False,
        progress=lambda _: inner.append(dry_runs(calm.plan, (NOMINAL,), watch=False)),
    )
    assert inner
    for runs in (outer, *inner):
        assert_the_same(runs, alone)


def test_a_performance_stays_as_it_is_while_others_use_its_physics(calm):
    (kept,) = dry_runs(calm.plan, (NOMINAL,), watch=False)
    before = [each.copy() for each in arrays(kept)]
    for factors in (PESSIMISTIC, Factors(gain=0.5, friction=3.0)):
        (other,) = dry_runs(calm.plan, (factors,), watch=False)
        assert not np.array_equal(other.measured.angles, kept.measured.angles)
    assert all(np.array_equal(now, then) for now, then in zip(arrays(kept), before, strict=True))
