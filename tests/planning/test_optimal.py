"""Tests of plans by IPOPT against plans by linear programs."""

import numpy as np
import pytest

from kinesic.bench.blocks import write_rapid_head_block
from kinesic.bml.parse import parse
from kinesic.motion.key_time_lp import shift_cost
from kinesic.motion.keys import Keys
from kinesic.motion.limit_check import check_limits
from kinesic.planning.certify import certify
from kinesic.planning.optimal import certify_optimal
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import find_bonds

HURRIED_SEED = 1  # random seed of nods with too little time; IPOPT finds their optimum within two seconds
MAX_LIMIT_RATIO = 1.001  # largest accepted value / limit


def plan_shift_cost(plan: Plan) -> float:
    keys = Keys.of(plan.postures.postures, plan.setup.limits, find_bonds(plan.timeline))
    return shift_cost(keys, plan.motion.planned)


@pytest.fixture(scope="module")
def plans(known: Setup) -> tuple[Plan, Plan]:
    """Return plans of a hurried block: by linear programs, and by IPOPT."""
    block = parse(write_rapid_head_block(HURRIED_SEED))
    return plan_block(block, known), plan_block(block, known, conditioned=certify_optimal)


def test_optimal_plan_shifts_key_times_less_than_the_usual_plan(plans: tuple[Plan, Plan]):
    usual, optimal = plans
    assert plan_shift_cost(optimal) < 0.995 * plan_shift_cost(usual)


def test_optimal_plan_keeps_all_limits(plans: tuple[Plan, Plan]):
    _, optimal = plans
    ratios = check_limits(optimal.trajectory, optimal.setup.limits).by_quantity.values()
    assert max(float(peak.ratios.max()) for peak in ratios) <= MAX_LIMIT_RATIO


def test_optimal_plan_has_the_requested_times_of_the_usual_plan(plans: tuple[Plan, Plan]):
    usual, optimal = plans
    assert np.array_equal(optimal.motion.requested_times, usual.motion.requested_times)
    assert {sync.sync: sync.requested for sync in optimal.syncs} == {sync.sync: sync.requested for sync in usual.syncs}
    assert optimal.motion.bottlenecks.keys() <= {
        (i, j) for i in range(len(optimal.motion.requested_times)) for j in range(len(optimal.motion.requested_times))
    }


def test_optimal_plan_without_shifts_equals_the_usual_plan(known: Setup):
    block = parse('<bml id="b"><head id="h" lexeme="NOD" start="1"/></bml>', dialect="none")
    keys = plan_block(block, known).postures.postures
    assert np.array_equal(certify_optimal(keys, known).trajectory.controls, certify(keys, known).trajectory.controls)
