"""Removal of motion and of the past."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.motion.double_s import least_stop
from kinesic.motion.trajectory import KNOT_INTERVAL, stay
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer import release as module
from kinesic.realizer.merge import merge
from kinesic.realizer.occupancy import arm_hinges, freed_hinges, occupancy_of
from kinesic.realizer.release import motion_from_knot, release_motion

from ..passage import passage_text
from .certified import certified

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
OFFER = '<gesture id="{0}" lexeme="offer" mode="{1}_HAND" start="{2}" stroke="{3}" relax="{4}"/>'
GAZE = '<gaze id="z" target="left" start="0" ready="0.9" relax="6" end="7"/>'


@pytest.fixture(scope="module")
def planned(known):
    return lambda text: plan_quickly(parse(text if "<bml" in text else ROOT.format(text)), known)


@pytest.fixture(scope="module")
def rest(known):
    return stay(known.robot.skeleton.rest)


@pytest.mark.parametrize("time", [0.4, 0.85, 1.3, 3.5, 4.6])
def test_release_at_sampled_times_returns_to_rest_within_2_5_s(planned, known, rest, time):
    running = planned(passage_text(0)).trajectory
    released = release_motion(running, time, np.ones(22, dtype=bool), known)
    certified(released, known, running, time)
    np.testing.assert_allclose(released.controls[-1], rest.controls[-1], atol=1e-9)
    assert released.duration < time + 2.5


@pytest.mark.parametrize(
    ("duration", "delays"), [(20.0, [0, 10, 20, 40, 80, 160, 320]), (1.41, [0, 10, 20, 40]), (1.4, [0, 10, 20])]
)
def test_failed_release_is_retried_at_doubling_delays_until_the_motion_ends(known, monkeypatch, duration, delays):
    running, tried = stay(known.robot.skeleton.rest, duration), list[int]()
    monkeypatch.setattr(module, "_release_from", lambda _running, knot, *_: tried.append(knot - 100))
    assert release_motion(running, 1.0, np.ones(22, dtype=bool), known) is running
    assert tried == delays


def test_minimum_return_time_of_a_hinge_covers_the_stop_from_its_velocity(known):
    velocities = np.linspace(-1.0, 1.0, 22)  # [rad/s]
    moving = np.arange(5)[:, None] * KNOT_INTERVAL * velocities
    times = module._minimum_times(moving, moving, 2, known.limits)
    stops = least_stop(velocities, np.zeros(22), known.limits.acceleration, known.limits.jerk)
    assert (times >= stops - 1e-9).all()
    np.testing.assert_allclose(times[[0, -1]], stops[[0, -1]])


def test_releasing_hinges_at_rest_keeps_the_rest_posture(known, rest):
    released = release_motion(rest, 0.02, np.ones(22, dtype=bool), known)
    np.testing.assert_allclose(released.at(5.0).angles, rest.controls[0], atol=1e-12)


def test_released_arm_returns_to_rest_while_the_other_hinges_keep_their_motion(planned, known):
    running, left = planned(passage_text(0)).trajectory, list(arm_hinges("l_hand", known.robot))
    free = np.isin(np.arange(22), left)
    released = release_motion(running, 1.0, free, known)
    certified(released, known, running, 1.0)
    np.testing.assert_allclose(released.controls[-1][left], known.robot.skeleton.rest[left], atol=1e-9)
    times = np.linspace(0.0, 6.0, 200)
    np.testing.assert_allclose(released.sample(times)[0][:, ~free], running.sample(times)[0][:, ~free], atol=1e-12)


def test_removing_a_head_shake_restores_the_motion_of_the_underlying_gaze(planned, known, rest):
    gaze = merge(rest, 0.0, planned(GAZE), begin=0.0)
    shake = planned('<head id="s" lexeme="SHAKE" repetition="3" start="0"/>')
    both = merge(gaze.trajectory, 1.5, shake, begin=1.5, occupied=gaze.occupancy)
    moved = np.ptp(both.layer.controls, axis=0) > 0.0
    free = freed_hinges(both.occupancy, moved, 2.2, known.robot, others=gaze.occupancy)
    released = release_motion(both.trajectory, 2.2, free, known, layer=both.layer, others=gaze.occupancy)
    certified(released, known, both.trajectory, 2.2)
    times = np.linspace(3.2, 8.0, 100)
    np.testing.assert_allclose(released.sample(times)[0], gaze.trajectory.sample(times)[0], atol=1e-6)


def test_released_arm_rests_until_another_block_uses_it(planned, known, rest):
    first = merge(rest, 0.0, planned(OFFER.format("one", "RIGHT", 0, 1.0, 2.0)), begin=0.0)
    plan = planned(OFFER.format("two", "RIGHT", 3.5, 4.8, 5.3))
    both = merge(first.trajectory, 0.5, plan, begin=0.5, occupied=first.occupancy)
    assert both.dropped == ()
    moved = np.ptp(first.layer.controls, axis=0) > 0.0
    free = freed_hinges(first.occupancy, moved, 1.1, known.robot, others=both.occupancy)
    released = release_motion(both.trajectory, 1.1, free, known, layer=first.layer, others=both.occupancy)
    certified(released, known, both.trajectory, 1.1)
    hinges = list(arm_hinges("r_hand", known.robot))
    np.testing.assert_allclose(released.at(3.2).angles[hinges], known.robot.skeleton.rest[hinges], atol=1e-6)
    times = np.linspace(both.occupancy[0].ready + KNOT_INTERVAL, 9.0, 100)
    np.testing.assert_allclose(
        released.sample(times)[0][:, hinges], both.trajectory.sample(times)[0][:, hinges], atol=1e-9
    )


@pytest.mark.parametrize("knot", [-1, 0, 200, 9900])
def test_motion_truncated_before_a_knot_keeps_the_later_control_points(planned, knot):
    running = planned(passage_text(0)).trajectory
    left = motion_from_knot(running.controls, knot)
    cut = len(running.controls) - len(left.controls)
    assert cut == min(max(knot, 0), len(running.controls) - 7)
    np.testing.assert_array_equal(left.controls, running.controls[cut:])
    assert (left.zero, left.start) == (0.0, 0.0)


@pytest.mark.parametrize(("late", "rejoins"), [(0.0, False), (1.0, True)])
def test_released_arm_rejoins_only_behaviours_that_are_not_ready_yet(planned, known, late, rejoins):
    """A behaviour that is ready exactly at the release has reached its posture."""
    running, knot = planned(OFFER.format("g", "RIGHT", 0, 1, 6)), 120
    ready = knot * KNOT_INTERVAL + late
    hand = list(arm_hinges("r_hand", known.robot))
    other = replace(occupancy_of(running)[0], behaviour="o", begin=ready - 0.4, ready=ready, relax=5.0)
    released = release_motion(
        running.trajectory,
        knot * KNOT_INTERVAL,
        np.isin(np.arange(len(known.limits.lower)), hand),
        known,
        others=[other],
    )
    before, after = (motion.at(4.0).angles[hand] for motion in (running.trajectory, released))
    assert bool(np.abs(after - before).max() < 1e-6) is rejoins


def test_first_tried_arm_return_takes_one_and_a_half_times_its_minimum_duration(planned, known, monkeypatch):
    running, spans = planned(passage_text(0)).trajectory, list[int]()

    def refuse(current, _after, knots, *_):
        spans.append(knots[1] - knots[0])

    monkeypatch.setattr(module, "cross_over", refuse)
    assert release_motion(running, 1.0, np.ones(22, dtype=bool), known) is running
    after = np.repeat(known.robot.skeleton.rest[None], len(running.controls), axis=0)
    slowest = module._minimum_times(running.controls, after, round(1.0 / KNOT_INTERVAL), known.limits).max()
    assert KNOT_INTERVAL * spans[0] == pytest.approx(1.5 * slowest, abs=KNOT_INTERVAL)
    assert spans[0] > 2 * module.MIN_TRANSITION
