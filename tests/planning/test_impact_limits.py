"""Plans with limits on contact forces near people."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.impact_policy import find_policy
from kinesic.planning import impact_limits
from kinesic.planning.impact_limits import (
    MAX_IMPACT_RATIO,
    compute_contributions,
    compute_impact_ratios,
    find_excess_times,
    find_excessive_behaviours,
    knot_times,
    slow_hinges,
)
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<gesture id="g" lexeme="house" start="1.0"/><head id="h" lexeme="NOD" start="1.2"/></bml>'
)
ADULT = find_policy("adult")
CHILD = find_policy("child")


@pytest.fixture(scope="module")
def free() -> Setup:
    return set_up(idle=1.0, near="nobody")


@pytest.fixture(scope="module")
def unlimited(free: Setup) -> Plan:
    return plan(BLOCK, free)


@pytest.fixture(scope="module")
def near_child(free: Setup) -> Plan:
    return plan(BLOCK, replace(free, policy=CHILD))


def ratios(planned: Plan, setup: Setup):
    return compute_impact_ratios(planned.trajectory, knot_times(planned.trajectory), setup)


def test_plan_without_contact_limits_equals_the_plan_without_a_contact_model(free: Setup, unlimited: Plan):
    without_model = plan(BLOCK, replace(free, impacts=None, policy=None))
    assert unlimited.trajectory.controls.tobytes() == without_model.trajectory.controls.tobytes()
    assert [sync.planned for sync in unlimited.syncs] == [sync.planned for sync in without_model.syncs]
    assert ratios(unlimited, free).max() == 0.0
    assert slow_hinges(unlimited.trajectory, free.limits.speed, free, 0) is None


def test_plan_near_a_child_keeps_contact_limits_by_a_later_stroke_without_drops(
    free: Setup, unlimited: Plan, near_child: Plan
):
    setup = near_child.setup
    assert ratios(unlimited, setup).max() > 2.0
    assert ratios(near_child, setup).max() <= 1.0
    outcomes = {outcome.kind for outcome in near_child.keyframes.outcomes.values()}
    assert "dropped" not in outcomes
    assert near_child.syncs["g:stroke"].planned > unlimited.syncs["g:stroke"].planned


def test_stroke_shifts_caused_by_contact_limits_are_reported(near_child: Plan):
    assert any(notice.id == "b:g" and "stroke" in notice.text for notice in near_child.notices)


def test_only_hinges_that_move_the_point_with_the_largest_contact_force_are_slowed(free: Setup, unlimited: Plan):
    setup = replace(free, policy=CHILD)
    slowed = slow_hinges(unlimited.trajectory, free.limits.speed, setup, 0)
    assert slowed is not None
    names = np.array(free.robot.skeleton.names)
    slower = set(names[slowed < free.limits.speed])
    assert {"l_shoulder_flexion", "r_shoulder_flexion"} & slower
    assert not {name for name in slower if name.startswith("vl5_roll")}
    assert (slowed <= free.limits.speed).all()
    later = slow_hinges(unlimited.trajectory, free.limits.speed, setup, 99)
    assert later is not None
    assert (later[slowed < free.limits.speed] <= free.limits.speed[slowed < free.limits.speed]).all()


def test_contributions_of_hinges_to_a_contact_force_are_relative_to_the_largest_contribution(
    free: Setup, unlimited: Plan
):
    angles, velocities, _ = unlimited.trajectory.sample(np.array([0.3, 0.5]))
    assert free.impacts is not None
    points = np.array([len(free.impacts.owners) - 1] * 2)  # on the right hand
    parts = compute_contributions(angles, velocities, points, free)
    assert parts.max(axis=1) == pytest.approx(1.0)
    left = [k for k, name in enumerate(free.robot.skeleton.names) if name.startswith("l_")]
    assert not parts[:, left].any()


def test_secondary_motion_is_rejected_only_for_a_new_excess_over_the_contact_limits(
    free: Setup, unlimited: Plan, near_child: Plan
):
    setup = near_child.setup
    times = knot_times(unlimited.trajectory)
    found = find_excess_times(near_child.trajectory, unlimited.trajectory, times, setup)
    assert len(found)
    assert (compute_impact_ratios(unlimited.trajectory, found, setup) > MAX_IMPACT_RATIO).all()
    assert not len(find_excess_times(unlimited.trajectory, unlimited.trajectory, times, setup))
    assert not len(find_excess_times(unlimited.trajectory, near_child.trajectory, times, setup))


def test_behaviour_that_cannot_keep_the_contact_limits_is_dropped_with_a_reason(free: Setup, unlimited: Plan):
    reasons = find_excessive_behaviours(unlimited.keyframes, unlimited.motion, replace(free, policy=CHILD))
    assert list(reasons) == ["g"]
    assert "exceeds the limit of force on a face (near: child)" in reasons["g"]
    assert find_excessive_behaviours(unlimited.keyframes, unlimited.motion, free) == {}


def test_contact_ratio_is_a_new_excess_only_above_both_the_limit_and_the_former_ratio(
    unlimited: Plan, near_child: Plan, monkeypatch: pytest.MonkeyPatch
):
    motion, before = near_child.trajectory, unlimited.trajectory
    times = knot_times(motion)
    former, grown = np.full(len(times), 0.5), np.full(len(times), 0.9)
    former[0] = grown[0] = 1.5
    monkeypatch.setattr(
        impact_limits, "compute_impact_ratios", lambda each, times, setup: grown if each is motion else former
    )
    assert impact_limits.find_worst_excess(motion, before, near_child.setup) is None
    grown[3] = 1.2
    assert impact_limits.find_worst_excess(motion, before, near_child.setup) == (times[3], 1.2)
