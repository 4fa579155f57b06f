"""A gesture with folded hands in a twin whose servos are soft and late: its hands touch, unless somebody watches."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.feedforward import FeedForward
from kinesic.controller.perform import dry_run, make_observer, plan
from kinesic.controller.watch.clearance import LONGEST_CREEP, RESERVE
from kinesic.controller.watch.watched_run import PERIOD, SLOWING, Slowed, perform_watched
from kinesic.hardware.protocol.registers import TICK
from kinesic.planning.plan import Plan
from kinesic.report.checks import checks
from kinesic.report.report import report
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.sim.twin import Twin

from ...performances import BLOCK

SOFT_AND_LATE = Factors(gain=0.4, latency=0.02)


@pytest.fixture(scope="module")
def pleading(known) -> Plan:
    return plan(BLOCK.format('<gesture id="g" lexeme="plead" start="0.1" stroke="0.7" end="1.5"/>'), known)


def test_time_slows_where_hands_would_touch(pleading):
    even, watched = (dry_run(pleading, twin=SOFT_AND_LATE, correction=False, watch=watch) for watch in (False, True))
    assert even.measured.clearance.distances.min() < 0.0 < watched.measured.clearance.distances.min()
    assert watched.least_pace < 0.5 < even.least_pace == 1.0
    assert watched.performed == pytest.approx(1.0, abs=0.01)
    assert len(watched.reference.times) == len(watched.measured.times) > len(even.measured.times)
    assert np.all(np.diff(watched.reference.times) > 0.0)


def test_servos_as_described_are_not_slowed(pleading):
    performance = dry_run(pleading)
    assert (performance.least_pace, performance.performed) == (1.0, 1.0)


def test_nothing_to_slow_down_for_gives_the_same_motion(known, calm):
    """Tick by tick, with inputs that are found on the way, it is the performance that was computed beforehand."""
    trajectory, robot = calm.plan.trajectory, known.robot
    twin = Twin(robot, start=trajectory.at(0.0).angles)
    observer = make_observer(known, NOMINAL, 0.0, 1)
    run = perform_watched(calm.plan, twin, FeedForward(robot, known.dynamics), observer)
    assert run.least_pace == 1.0
    count = len(calm.measured.times)
    np.testing.assert_allclose(run.times[:count], calm.measured.times, atol=1e-9)
    np.testing.assert_allclose(run.measured.angles[:count], calm.measured.angles, atol=TICK)  # rounding may differ once
    np.testing.assert_allclose(run.duties[:count], calm.reference.duties, atol=1e-9)


def test_who_waits_in_vain_is_stopped(known, pleading):
    """A robot that asks for more clearance than anything leaves: time creeps, and it is over."""
    start = pleading.trajectory.at(0.0).angles
    least = float(known.distances.clearance(start[None]).distances[0]) / (RESERVE + 0.05)
    cautious = replace(pleading, setup=replace(known, robot=replace(known.robot, least_clearance=least)))
    twin = Twin(known.robot, factors=NOMINAL, start=start)
    run = perform_watched(cautious, twin, FeedForward(known.robot, known.dynamics), None)
    assert len(run.times) * PERIOD == pytest.approx(LONGEST_CREEP, abs=0.1)
    assert run.times[-1] < SLOWING


@pytest.mark.filterwarnings("error")
def test_who_is_stopped_at_once_is_judged_like_others(known, pleading):
    """Its robot asks for four times the clearance that the first posture has: little is to be reported, but some."""
    start = pleading.trajectory.at(0.0).angles
    least = float(known.distances.clearance(start[None]).distances[0]) / (RESERVE - 0.05)
    cautious = replace(pleading, setup=replace(known, robot=replace(known.robot, least_clearance=least)))
    stopped = dry_run(cautious)
    assert len(stopped.reference.times) == 2
    assert {check.name: check.status for check in checks(stopped)}["collision.performed"] == "fail"
    assert report(stopped, source="x.bml")["grade"] == "fail"


def test_a_slowed_motion_passes_the_same_places_at_its_pace(calm):
    trajectory = calm.plan.trajectory
    angles, speeds, accelerations = Slowed(trajectory, 1.0, 0.5).sample(np.array([0.0, 0.2]))
    planned = trajectory.sample(np.array([1.0, 1.1]))
    np.testing.assert_allclose(angles, planned[0])
    np.testing.assert_allclose(speeds, 0.5 * planned[1])
    np.testing.assert_allclose(accelerations, 0.25 * planned[2])
