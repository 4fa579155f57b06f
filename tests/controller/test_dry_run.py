"""Dry runs in one process: concurrent, nested and successive."""

import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller import dry_run as module
from kinesic.controller.dry_run import dry_runs
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors

LATE_AND_LOOSE = Factors(gain=0.7, latency=0.013, play=0.004)  # servos with weak P gain, latency and backlash
SAGGING_SUPPLY = Factors(resistance=0.2)  # [ohm] internal resistance of the power supply


def arrays(run):
    """Return all measurements of hinges, hands, clearance and power."""
    measured = run.measured
    of_hinges = [
        getattr(measured, name) for name in ("times", "angles", "velocities", "torques", "duties", "setpoints")
    ]
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
    """Switch threads every 10 us, which provokes races."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    yield
    sys.setswitchinterval(usual)


@pytest.mark.parametrize("twins", [(NOMINAL_FACTORS, LATE_AND_LOOSE), (SAGGING_SUPPLY,)], ids=["compiled", "in Python"])
def test_concurrent_dry_runs_in_threads_are_independent(calm, hasty, twins):
    alone = dry_runs(calm.plan, twins, watch=False)
    with ThreadPoolExecutor(3) as threads:
        for together in threads.map(lambda _: dry_runs(calm.plan, twins, watch=False), range(6)):
            assert_the_same(together, alone)


def test_progress_callback_may_start_another_dry_run(calm):
    alone = dry_runs(calm.plan, (NOMINAL_FACTORS,), watch=False)
    inner = []
    outer = dry_runs(
        calm.plan,
        (NOMINAL_FACTORS,),
        watch=False,
        progress=lambda _: inner.append(dry_runs(calm.plan, (NOMINAL_FACTORS,), watch=False)),
    )
    assert inner
    for runs in (outer, *inner):
        assert_the_same(runs, alone)


def test_results_of_a_dry_run_are_not_changed_by_later_dry_runs(calm):
    (kept,) = dry_runs(calm.plan, (NOMINAL_FACTORS,), watch=False)
    before = [array.copy() for array in arrays(kept)]
    for factors in (PESSIMISTIC_FACTORS, Factors(gain=0.5, friction=3.0)):
        (other,) = dry_runs(calm.plan, (factors,), watch=False)
        assert not np.array_equal(other.measured.angles, kept.measured.angles)
    assert all(np.array_equal(now, then) for now, then in zip(arrays(kept), before, strict=True))


@pytest.mark.parametrize(("min_clearance", "simulated"), [(0.001, [False]), (0.5, [False, True])])
def test_dry_run_is_repeated_with_contacts_only_if_segments_come_too_near(calm, monkeypatch, min_clearance, simulated):
    setup = calm.plan.setup
    plan = replace(calm.plan, setup=replace(setup, robot=replace(setup.robot, min_clearance=min_clearance)))
    touching, borrow = list[bool](), module.borrow_simulations
    monkeypatch.setattr(
        module,
        "borrow_simulations",
        lambda robot, twins, *, touches: (touching.append(touches), borrow(robot, twins, touches=touches))[1],
    )
    dry_runs(plan, (NOMINAL_FACTORS,), watch=False, correction=False)
    assert touching == simulated
