import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.keys import KeyPosture
from kinesic.motion.limit_check import check_limits
from kinesic.motion.segments import SplineSegment
from kinesic.planning import quick_plan
from kinesic.planning.quick_plan import DURATION_MARGIN, compute_quintic_duration, plan_quickly

from ..passage import passage_text

condition = sys.modules["kinesic.motion.condition"]  # the package has a function of this name

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


@pytest.fixture(scope="module")
def slow(known):
    return plan_quickly(parse(passage_text(1)), known)


def largest(trajectory, limits) -> float:
    return max(float(peak.ratios.max()) for peak in check_limits(trajectory, limits).by_quantity.values())


def test_quintic_duration_keeps_all_limits():
    s = np.linspace(0, 1, 2001)
    for way in (0.001, 0.03, 0.4, -0.4, 3.9):
        t = compute_quintic_duration(way, JOINT_LIMITS, 0)
        speed = way / t * 30 * (s**2 - 2 * s**3 + s**4)
        acceleration = way / t**2 * (60 * s - 180 * s**2 + 120 * s**3)
        jerk = way / t**3 * (60 - 360 * s + 360 * s**2)
        duty = JOINT_LIMITS.inertial * acceleration + JOINT_LIMITS.viscous * speed
        rows = (speed, acceleration, jerk, duty)
        used = [np.abs(values).max() / limit for values, limit in zip(rows, (4, 40, 1e3, 0.7), strict=True)]
        assert 0.2 < max(used) <= 1.0, "and not much longer than some limit asks for"
    assert compute_quintic_duration(0.0, JOINT_LIMITS, 0) == 0.0


@pytest.mark.parametrize("way", [0.4, 3.9])
@pytest.mark.parametrize(
    ("binding", "peak", "order"),
    [("speed", 1.875, 1), ("acceleration", 10 / 3**0.5, 2), ("jerk", 60.0, 3), ("duty", None, 0)],
)
def test_motion_of_the_quintic_duration_reaches_its_binding_limit(way, binding, peak, order):
    """Expect velocity, acceleration, jerk or duty to peak at its limit."""
    wide = {
        name: sealed(np.full_like(getattr(JOINT_LIMITS, name), 1e9))
        for name in ("speed", "acceleration", "jerk", "duty")
    }
    duration = (
        compute_quintic_duration(way, replace(JOINT_LIMITS, **wide | {binding: getattr(JOINT_LIMITS, binding)}), 0)
        / DURATION_MARGIN
    )
    if binding == "duty":
        used = (
            JOINT_LIMITS.viscous[0] * 1.875 * way / duration
            + JOINT_LIMITS.inertial[0] * 10 / 3**0.5 * way / duration**2
        )
        assert used == pytest.approx(JOINT_LIMITS.duty[0], rel=1e-3)
    else:
        assert peak * way / duration**order == pytest.approx(getattr(JOINT_LIMITS, binding)[0], rel=1e-3)


def test_quick_plan_keeps_limits_and_clearance_and_starts_with_its_block(slow, known):
    assert largest(slow.trajectory, known.limits) <= 1.001
    assert slow.trajectory.zero == pytest.approx(-slow.timeline.start)
    assert slow.clearance.distances.min() >= known.robot.min_clearance


def test_quick_plan_stops_at_every_key(slow):
    times = slow.motion.planned + slow.trajectory.zero
    speeds = slow.trajectory.sample(times)[1]
    for row, posture in enumerate(slow.postures.postures):
        assert np.abs(speeds[row, list(posture.keyed)]).max(initial=0.0) < 0.05


def test_quick_plan_reaches_its_keys_at_the_planned_times(slow):
    reached = slow.trajectory.sample(slow.motion.planned + slow.trajectory.zero)[0]
    for row, posture in enumerate(slow.postures.postures):
        keyed = list(posture.keyed)
        np.testing.assert_allclose(reached[row, keyed], posture.angles[keyed], atol=1.1e-3)


def test_quick_plan_solves_all_hinges_in_at_most_three_solver_calls(known, monkeypatch):
    solved = []

    def find(*given):
        solved.append(given)
        return find_free_motion(*given)

    find_free_motion = condition.find_free_motion
    monkeypatch.setattr(condition, "find_free_motion", find)
    plan_quickly(parse(passage_text(2)), known)
    assert 1 <= len(solved) <= 3


def test_desired_motion_of_a_quick_plan_passes_through_a_requested_key(slow):
    requested = slow.requested_postures[3]
    there = slow.desired.angles(np.array([requested.time + slow.desired.zero]))[0]
    np.testing.assert_allclose(there[list(requested.keyed)], requested.angles[list(requested.keyed)], atol=1.1e-3)


def test_quick_plan_lengthens_key_intervals_until_limits_are_kept(known, monkeypatch):
    rest, away = known.robot.skeleton.rest, known.robot.skeleton.rest.copy()
    away[known.robot.joints("neck")[0]] += 0.5
    keys = tuple(KeyPosture.whole(0.01 * k, sealed(each)) for k, each in enumerate((rest, away, rest)))
    tried: list[np.ndarray] = []
    usual = quick_plan.NearestFinder.find

    def find(finder, times):
        tried.append(np.array(times))
        return object.__new__(SplineSegment) if len(tried) < 3 else usual(finder, times)

    monkeypatch.setattr(quick_plan.NearestFinder, "find", find)
    motion = quick_plan.rest_at_keys(keys, known)
    gaps = [np.diff(times) for times in tried]
    assert len(gaps) == 3
    for before, after in pairwise(gaps):
        assert after == pytest.approx(quick_plan.GAP_GROWTH * before)
    np.testing.assert_array_equal(motion.planned, tried[-1])
    assert largest(motion.trajectory, known.limits) <= 1.001
