"""Tests that secondary motion shifts with the underlying motion."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.style.standing import UNPOSED_STANDING
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.arcs import make_head_arcs
from kinesic.planning.secondary.breath import BREATH_PERIOD, INHALATION_FRACTION, PERIOD_VARIATION, make_breaths
from kinesic.planning.secondary.drift import DRIFT_PERIOD, make_drifts
from kinesic.planning.secondary.offset_bumps import OffsetBump
from kinesic.planning.secondary.rest_changes import CHANGE_DURATIONS, REST_MARGIN, make_rest_changes
from kinesic.session.setup import set_up

IDLE_SETUP = set_up(idle=1.0)  # setup with full idle motion
DEFAULT_ROBOT: Robot = IDLE_SETUP.robot
MOTION_DURATION = 40.0  # [s]
Maker = Callable[[Trajectory, np.random.Generator], list[OffsetBump]]


def held(begin: float) -> Trajectory:
    """Return a motion of head and forearm with a hold of 10 s."""
    times = np.arange(0.0, MOTION_DURATION, KNOT_INTERVAL)
    controls = np.tile(DEFAULT_ROBOT.skeleton.rest, (len(times), 1))
    there = minimum_jerk(times - 0.5) - minimum_jerk(times - 11.5)
    for name in ("l_elbow_flexion", "skullbase_torsion"):
        controls[:, DEFAULT_ROBOT.skeleton.joint(name)] += 0.7 * there
    return Trajectory(controls, 0.0, begin)


def span(motion: Trajectory) -> tuple[float, float]:
    return motion.start, motion.start + MOTION_DURATION - 0.1


def breaths(motion: Trajectory, chance: np.random.Generator) -> list[OffsetBump]:
    return [*make_breaths(span(motion), 1.0, DEFAULT_ROBOT, chance)]


def drifts(motion: Trajectory, chance: np.random.Generator) -> list[OffsetBump]:
    return [*make_drifts(motion, 1.0, DEFAULT_ROBOT, chance)]


def arcs(motion: Trajectory, chance: np.random.Generator) -> list[OffsetBump]:
    return [*make_head_arcs(motion, (), 1.0, DEFAULT_ROBOT, chance)]


def rest_changes(motion: Trajectory, chance: np.random.Generator) -> list[OffsetBump]:
    return [*make_rest_changes(motion, span(motion), IDLE_SETUP, UNPOSED_STANDING, chance)]


@pytest.mark.parametrize("make", [breaths, drifts, arcs, rest_changes])
def test_secondary_motion_is_equal_but_later_if_the_underlying_motion_starts_later(make: Maker):
    first, later = (make(held(begin), np.random.default_rng(2)) for begin in (0.0, 50.0))
    assert len(first) == len(later) >= 2
    for bump, other in zip(first, later, strict=True):
        expected = bump.later(50.0)
        assert (other.begin, other.peak, other.end) == pytest.approx((expected.begin, expected.peak, expected.end))
        assert other.stays == pytest.approx(expected.stays)
        np.testing.assert_allclose(other.away, expected.away, atol=1e-9)


@pytest.mark.parametrize("begin", [0.0, 50.0])
def test_breaths_vary_around_their_period_and_inhale_for_a_fixed_fraction(begin: float):
    tilt = DEFAULT_ROBOT.skeleton.joint("vl5_tilt")
    trunk = [bump for bump in breaths(held(begin), np.random.default_rng(1)) if bump.away[tilt]]
    lengths = np.array([bump.end - bump.begin for bump in trunk])
    assert np.all(lengths > BREATH_PERIOD * (1.0 - PERIOD_VARIATION) / (1.0 + PERIOD_VARIATION) * 0.9)
    assert np.all(lengths < BREATH_PERIOD * (1.0 + PERIOD_VARIATION) / (1.0 - PERIOD_VARIATION) * 1.1)
    assert np.ptp(lengths) > 0.05 * BREATH_PERIOD
    for bump in trunk:
        assert (bump.peak - bump.begin) / (bump.end - bump.begin) == pytest.approx(INHALATION_FRACTION)


@pytest.mark.parametrize("begin", [0.0, 50.0])
def test_successive_drifts_of_a_held_arm_have_no_gaps_and_last_about_one_period_each(begin: float):
    bumps = drifts(held(begin), np.random.default_rng(1))
    assert all(one.end == other.begin for one, other in pairwise(bumps))
    assert all(0.7 * DRIFT_PERIOD < bump.end - bump.begin < 1.4 * DRIFT_PERIOD for bump in bumps)
    assert bumps[0].begin == pytest.approx(begin + 1.5, abs=0.1)
    assert bumps[-1].end == pytest.approx(begin + 11.5, abs=0.1)


@pytest.mark.parametrize("begin", [0.0, 50.0])
def test_rest_changes_lie_within_the_rest_and_follow_one_another_without_gaps(begin: float):
    motion = held(begin)
    bumps = rest_changes(motion, np.random.default_rng(1))
    assert bumps[0].begin == pytest.approx(begin + 12.4 + REST_MARGIN, abs=0.3)
    assert bumps[-1].end <= begin + MOTION_DURATION - REST_MARGIN
    for bump in bumps:
        assert CHANGE_DURATIONS[0] <= bump.peak - bump.begin <= CHANGE_DURATIONS[1]
        assert CHANGE_DURATIONS[0] <= bump.end - bump.peak - bump.stays <= CHANGE_DURATIONS[1]
    for one, other in pairwise(bumps):
        assert one.peak + one.stays == pytest.approx(other.begin)


def test_half_the_amount_of_idle_motion_halves_the_rest_changes():
    motion = held(0.0)
    full, half = (
        [*make_rest_changes(motion, span(motion), setup, UNPOSED_STANDING, np.random.default_rng(4))]
        for setup in (IDLE_SETUP, replace(IDLE_SETUP, idling=replace(IDLE_SETUP.idling, amount=0.5)))
    )
    for one, other in zip(full, half, strict=True):
        np.testing.assert_allclose(other.away, 0.5 * one.away, atol=1e-9)
