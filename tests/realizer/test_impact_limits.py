"""Live motion under contact limits: merges, interruptions and quick plans."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.impact_policy import find_policy
from kinesic.motion.stopping import stop
from kinesic.motion.trajectory import Trajectory, stay
from kinesic.planning.impact_limits import compute_impact_ratios, find_worst_excess, knot_times
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.conflicts import find_conflict
from kinesic.realizer.merge import MergedMotion, merge
from kinesic.realizer.occupancy import Overlay
from kinesic.realizer.release import release_motion
from kinesic.session.setup import set_up

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
RAISE = ROOT.format('<gesture id="g" lexeme="house" start="0.5"/>')
LEAN = ROOT.format('<posture id="l" start="0" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>')


@pytest.fixture(scope="module")
def setup() -> Setup:
    return set_up(near="child")


@pytest.fixture(scope="module")
def raised(setup: Setup) -> Trajectory:
    return plan_block(parse(RAISE), setup).trajectory


def largest_ratio(motion: Trajectory, setup: Setup) -> float:
    return float(compute_impact_ratios(motion, knot_times(motion), setup).max())


def merged(setup: Setup, running: Trajectory) -> list[MergedMotion]:
    lean = plan_block(parse(LEAN), setup)
    return [merge(running, time, lean, begin=time) for time in np.arange(0.2, 1.8, 0.2)]


def test_merged_trunk_and_arm_motion_keeps_the_contact_limits_or_drops_the_behaviour(setup: Setup, raised: Trajectory):
    results = merged(setup, raised)
    assert max(largest_ratio(result.trajectory, setup) for result in results) <= 1.0
    texts = [notice.text for result in results for notice in result.notices]
    assert any("exceeds the limit of contacts (near: child) in combination" in text for text in texts)
    free = merged(replace(setup, policy=None), raised)
    assert max(largest_ratio(result.trajectory, setup) for result in free) > 1.0


def test_merged_motion_beyond_the_contact_limits_is_a_conflict(setup: Setup):
    count, hinge = 120, setup.robot.skeleton.names.index("l_shoulder_flexion")
    base = np.repeat(setup.robot.skeleton.rest[None], count, axis=0)
    swing = np.linspace(0.0, 2.0, count) ** 2 * 0.3
    coming, both = base.copy(), base.copy()
    coming[:, hinge] += 0.5 * swing
    both[:, hinge] += swing
    work = Overlay(base, coming, base[0], 0, (), ())
    assert find_conflict(work, both, replace(setup, policy=None)) is None
    failure = find_conflict(work, both, setup)
    assert failure is not None
    assert failure.why.startswith("exceeds the limit of contacts")


def test_hands_of_an_interrupted_block_return_within_the_contact_limits(setup: Setup, raised: Trajectory):
    everything = np.ones(len(setup.limits.lower), dtype=np.bool_)
    free = replace(setup, policy=None)
    times = (0.8, 1.6)
    kept = [largest_ratio(release_motion(raised, time, everything, setup), setup) for time in times]
    unlimited = [largest_ratio(release_motion(raised, time, everything, free), setup) for time in times]
    assert max(kept) <= 1.0 < max(unlimited)


def test_emergency_stops_stay_within_the_contact_limits(setup: Setup, raised: Trajectory):
    stops = [stop(raised, time, setup.limits) for time in np.linspace(0.3, 2.1, 5)]
    assert max(largest_ratio(stopped, setup) for stopped in stops) <= 1.0


def test_quick_plan_keeps_the_contact_limits_near_people(setup: Setup):
    quick = plan_quickly(parse(RAISE), setup)
    assert largest_ratio(quick.trajectory, setup) <= 1.0
    assert largest_ratio(plan_quickly(parse(RAISE), replace(setup, policy=None)).trajectory, setup) > 1.0


def test_contact_excess_that_existed_before_a_change_is_not_reported(setup: Setup, raised: Trajectory):
    free = plan_block(parse(RAISE), replace(setup, policy=None, impacts=setup.impacts)).trajectory
    excess = find_worst_excess(free, stay(setup.robot.skeleton.rest), setup)
    assert excess is not None
    ratios = compute_impact_ratios(free, knot_times(free), setup)
    assert excess == pytest.approx((float(knot_times(free)[ratios.argmax()]), ratios.max()))
    assert find_worst_excess(free, free, setup) is None
    assert find_worst_excess(raised, free, setup) is None


def test_contact_ratio_of_a_motion_depends_on_the_audience(raised: Trajectory, setup: Setup):
    near_adult = replace(setup, policy=find_policy("adult"))
    assert largest_ratio(raised, near_adult) < largest_ratio(raised, setup)
    assert largest_ratio(raised, replace(setup, policy=None)) == 0.0
