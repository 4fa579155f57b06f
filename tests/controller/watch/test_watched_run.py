"""Clearance watch of a twin with soft, late servos and folded hands."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.dry_run import dry_run, make_observer
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.watch.clearance import MAX_CREEP_TIME, RESERVE_FRACTION
from kinesic.controller.watch.watched_run import COMMAND_PERIOD, SLOWING_TIME, SlowedMotion, perform_watched
from kinesic.hardware.protocol.registers import TICK_ANGLE
from kinesic.planning.plan import Plan
from kinesic.report.checks import checks
from kinesic.report.report import report
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.twin import Twin

from ...performances import BLOCK_BML

SOFT_AND_LATE = Factors(gain=0.4, latency=0.02)


@pytest.fixture(scope="module")
def praying(known) -> Plan:
    return plan(BLOCK_BML.format('<gesture id="g" lexeme="prayer" start="0.1" stroke="0.7" end="1.5"/>'), known)


def test_clearance_watch_slows_the_twin_before_the_hands_come_too_near(praying):
    even, watched = (dry_run(praying, twin=SOFT_AND_LATE, correction=False, watch=watch) for watch in (False, True))
    limit = 0.5 * praying.setup.robot.min_clearance
    assert even.measured.clearance.distances.min() < limit < watched.measured.clearance.distances.min()
    assert watched.min_pace < 0.5 < even.min_pace == 1.0
    assert watched.performed == pytest.approx(1.0, abs=0.01)
    assert len(watched.reference.times) == len(watched.measured.times) > len(even.measured.times)
    assert np.all(np.diff(watched.reference.times) > 0.0)


def test_clearance_watch_does_not_slow_the_nominal_twin(praying):
    performance = dry_run(praying)
    assert (performance.min_pace, performance.performed) == (1.0, 1.0)


def test_twin_run_with_clearance_watch_equals_plain_dry_run_at_ample_clearance(known, calm):
    """Streamed inputs give the same result as precomputed ones."""
    trajectory, robot = calm.plan.trajectory, known.robot
    twin = Twin(robot, start=trajectory.at(0.0).angles)
    observer = make_observer(known, NOMINAL_FACTORS, 0.0, 1)
    run = perform_watched(calm.plan, twin, FeedForward(robot, known.dynamics), observer)
    assert run.min_pace == 1.0
    count = len(calm.measured.times)
    np.testing.assert_allclose(run.times[:count], calm.measured.times, atol=1e-9)
    np.testing.assert_allclose(
        run.measured.angles[:count], calm.measured.angles, atol=TICK_ANGLE
    )  # rounding may differ once
    np.testing.assert_allclose(run.duties[:count], calm.reference.duties, atol=1e-9)


def test_twin_run_stops_after_the_maximum_time_at_minimum_speed(known, praying):
    """The robot requires more clearance than its hands can keep."""
    start = praying.trajectory.at(0.0).angles
    least = float(known.distances.clearance(start[None]).distances[0]) / (RESERVE_FRACTION + 0.05)
    cautious = replace(praying, setup=replace(known, robot=replace(known.robot, min_clearance=least)))
    twin = Twin(known.robot, factors=NOMINAL_FACTORS, start=start)
    run = perform_watched(cautious, twin, FeedForward(known.robot, known.dynamics), None)
    assert len(run.times) * COMMAND_PERIOD == pytest.approx(MAX_CREEP_TIME, abs=0.1)
    assert run.times[-1] < SLOWING_TIME


@pytest.mark.filterwarnings("error")
def test_dry_run_stopped_at_its_first_posture_is_reported_as_failed(known, praying):
    """The robot requires four times the clearance of the first posture."""
    start = praying.trajectory.at(0.0).angles
    least = float(known.distances.clearance(start[None]).distances[0]) / (RESERVE_FRACTION - 0.05)
    cautious = replace(praying, setup=replace(known, robot=replace(known.robot, min_clearance=least)))
    stopped = dry_run(cautious)
    assert len(stopped.reference.times) == 2
    assert {check.name: check.status for check in checks(stopped)}["collision.performed"] == "fail"
    assert report(stopped, source="x.bml")["grade"] == "fail"


def test_slowed_motion_follows_the_planned_path_at_scaled_velocity(calm):
    trajectory = calm.plan.trajectory
    angles, speeds, accelerations = SlowedMotion(trajectory, 1.0, 0.5).sample(np.array([0.0, 0.2]))
    planned = trajectory.sample(np.array([1.0, 1.1]))
    np.testing.assert_allclose(angles, planned[0])
    np.testing.assert_allclose(speeds, 0.5 * planned[1])
    np.testing.assert_allclose(accelerations, 0.25 * planned[2])
