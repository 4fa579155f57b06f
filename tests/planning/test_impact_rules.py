"""Rules that lower velocity limits or name behaviours, with contact figures set by the test."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.dynamics import ImpactSurvey
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning import impact_limits
from kinesic.planning.impact_limits import (
    compute_contributions,
    compute_impact_ratios,
    find_excess_times,
    find_excessive_behaviours,
    knot_times,
    slow_hinges,
)

HINGES = 4
DURATION = 6.0  # [s]
NAMES = ("face", "upper_arm", "energy")


class Contacts:
    """Contact figures by time: ratio, row and point; a hinge moves each point along x by its weight [m]."""

    owners = ("chest", "forearm", "hand")

    def __init__(self, excesses, weights=(1.0, 1.0, 1.0, 1.0)):
        self.excesses, self.weights, self.gates = excesses, np.array(weights), []

    def survey(self, angles, velocities, rows, *, gate):
        values, points = np.full((len(angles), 3), 0.5), np.zeros((len(angles), 3), dtype=np.int64)
        for time, (ratio, row, point) in self.excesses.items():
            knot = round(time / KNOT_INTERVAL)
            if knot < len(angles):
                values[knot, row], points[knot, row] = ratio, point
        self.gates.append(gate)
        return ImpactSurvey(rows, values, points)

    def jacobians(self, angles, points):
        result = np.zeros((len(angles), 3, HINGES))
        result[:, 0] = self.weights
        return result


def near_person(excesses, **options):
    policy = SimpleNamespace(rows=SimpleNamespace(names=NAMES), audience="adult")
    return SimpleNamespace(policy=policy, impacts=Contacts(excesses, **options))


@pytest.fixture
def swing() -> Trajectory:
    """Motion of all hinges with equal velocities, largest in the middle."""
    times = np.arange(-1.0, DURATION / KNOT_INTERVAL + 2.0) * KNOT_INTERVAL
    return Trajectory(np.repeat(np.cos(np.pi * times / DURATION)[:, None], HINGES, axis=1), 0.0)


def velocity(motion, time):
    return float(np.abs(motion.sample(np.array([time]))[1]).max())


def test_velocity_limits_stay_if_no_contact_force_exceeds_99_5_percent_of_its_limit(swing):
    speeds = np.full(HINGES, 9.0)
    setup = near_person({2.0: (0.995, 0, 1)})
    assert slow_hinges(swing, speeds, setup, 0) is None
    assert setup.impacts.gates == [0.995]
    assert slow_hinges(swing, speeds, near_person({2.0: (0.9951, 0, 1)}), 0) is not None


def test_early_rounds_scale_the_peak_velocity_of_hinges_that_contribute_more_than_a_twentieth(swing):
    setup = near_person({2.0: (1.94, 0, 1)}, weights=(1.0, 0.06, 0.04, 0.0))
    peak = velocity(swing, DURATION / 2)
    for attempt in (0, 3):
        slowed = slow_hinges(swing, np.full(HINGES, 9.0), setup, attempt)
        np.testing.assert_allclose(slowed, [0.5 * peak, 0.5 * peak, 9.0, 9.0], rtol=1e-3)


def test_late_rounds_slow_hinges_with_over_three_tenths_of_the_largest_contribution_to_the_excess(swing):
    setup = near_person({1.0: (1.94, 0, 1)}, weights=(1.0, 0.31, 0.29, 0.0))
    slowed = slow_hinges(swing, np.full(HINGES, 9.0), setup, 4)
    moving = velocity(swing, 1.0)
    assert moving < 0.6 * velocity(swing, DURATION / 2)
    np.testing.assert_allclose(slowed, [0.5 * moving, 0.5 * moving, 9.0, 9.0], rtol=1e-3)


def test_slowest_of_several_excesses_counts_and_limits_never_rise_or_fall_below_the_lowest_limit(swing):
    peak = velocity(swing, DURATION / 2)
    several = near_person({2.0: (1.94, 0, 1), 3.0: (3.88, 1, 2)})
    np.testing.assert_allclose(slow_hinges(swing, np.full(HINGES, 9.0), several, 0), 0.25 * peak, rtol=1e-3)
    np.testing.assert_allclose(slow_hinges(swing, np.full(HINGES, 0.03), several, 0), 0.03)
    huge = near_person({2.0: (1e4, 0, 1)})
    np.testing.assert_allclose(slow_hinges(swing, np.full(HINGES, 9.0), huge, 0), 0.02)


def test_contribution_of_a_hinge_is_its_fraction_of_the_point_velocity():
    setup = near_person({}, weights=(2.0, -1.0, 0.5, 0.0))
    velocities = np.array([[1.0, 1.0, 1.0, 1.0], [0.0, 3.0, 1.0, 5.0]])
    parts = compute_contributions(np.zeros((2, HINGES)), velocities, np.zeros(2, dtype=int), setup)
    np.testing.assert_allclose(parts, [[1.0, 0.5, 0.25, 0.0], [0.0, 1.0, 1 / 6, 0.0]])
    still = compute_contributions(np.zeros((1, HINGES)), np.zeros((1, HINGES)), np.zeros(1, dtype=int), setup)
    assert not still.any()


def test_knot_times_begin_with_the_motion_and_end_before_its_end(swing):
    late = Trajectory(swing.controls[:13], 0.0, 7.0)
    np.testing.assert_allclose(knot_times(late), 7.0 + KNOT_INTERVAL * np.arange(10))


def test_impact_ratio_is_that_of_the_worst_region_at_each_time(swing):
    setup = near_person({0.0: (0.8, 2, 0), 0.02: (1.7, 1, 0)})
    np.testing.assert_allclose(compute_impact_ratios(swing, knot_times(swing)[:4], setup), [0.8, 0.5, 1.7, 0.5])
    assert setup.impacts.gates == [0.995]
    assert compute_impact_ratios(swing, np.zeros(0), setup).shape == (0,)
    for missing in ("policy", "impacts"):
        without = SimpleNamespace(**vars(setup) | {missing: None})
        assert compute_impact_ratios(swing, np.arange(3.0), without).tolist() == [0.0, 0.0, 0.0]
        assert slow_hinges(swing, np.full(HINGES, 9.0), without, 0) is None


def test_excess_times_are_those_with_a_larger_ratio_than_allowed_and_than_before(swing, monkeypatch):
    before = Trajectory(swing.controls, 1.0)
    ratios = {id(before): [0.2, 0.2, 1.2, 1.4, 0.2], id(swing): [0.995, 0.996, 1.3, 1.3, 0.2]}
    times = np.arange(5.0)
    monkeypatch.setattr(
        impact_limits, "compute_impact_ratios", lambda motion, at, setup: np.array(ratios[id(motion)])[at.astype(int)]
    )
    setup = near_person({})
    assert find_excess_times(before, swing, times, setup).tolist() == [1.0, 2.0]
    assert find_excess_times(before, swing, times[:1], setup).tolist() == []


def named(monkeypatch, swing, excesses, spans, *, zero=0.0):
    """Return the reasons for dropped behaviours whose planned times [s] are given."""
    rows = [(name, "stroke", 0.0, time) for name, times in spans.items() for time in times]
    monkeypatch.setattr(impact_limits, "list_keyed_syncs", lambda frames, motion: rows)
    setup = near_person(excesses)
    motion = SimpleNamespace(trajectory=Trajectory(swing.controls, zero))
    reasons = find_excessive_behaviours(SimpleNamespace(frames=[1]), motion, setup)
    assert setup.impacts.gates == [1.0]
    return reasons


def test_each_excess_is_attributed_to_the_nearest_behaviour_with_quantity_place_and_time(monkeypatch, swing):
    spans = {"early": (0.2, 1.0), "late": (4.0, 5.0)}
    reasons = named(monkeypatch, swing, {1.5: (1.2, 1, 1), 4.5: (1.1, 2, 2)}, spans)
    assert reasons == {
        "early": "exceeds the limit of force on a upper arm (near: adult) by forearm at 1.50 s",
        "late": "exceeds the limit of energy (near: adult) by hand at 4.50 s",
    }
    assert list(named(monkeypatch, swing, {2.6: (1.2, 0, 0)}, spans)) == ["late"]
    assert list(named(monkeypatch, swing, {2.4: (1.2, 0, 0)}, spans)) == ["early"]
    assert named(monkeypatch, swing, {2.4: (1.0, 0, 0)}, spans) == {}


def test_excesses_within_two_seconds_of_the_worst_one_name_no_further_behaviour(monkeypatch, swing):
    spans = {"a": (0.5, 0.6), "b": (2.4, 2.5), "c": (4.6, 4.7)}
    excesses = {0.5: (1.1, 0, 0), 2.5: (1.4, 0, 0), 4.6: (1.2, 0, 0)}
    reasons = named(monkeypatch, swing, excesses, spans)
    assert list(reasons) == ["b", "c"]
    assert "at 2.50 s" in reasons["b"]


def test_behaviour_with_several_far_excesses_is_named_once_for_the_worst(monkeypatch, swing):
    reasons = named(monkeypatch, swing, {0.5: (1.1, 0, 0), 3.5: (1.4, 0, 2)}, {"a": (0.2, 5.0)})
    assert list(reasons) == ["a"]
    assert "by hand at 3.50 s" in reasons["a"]


def test_times_of_an_excess_are_those_of_the_block_and_equal_distances_prefer_the_first_name(monkeypatch, swing):
    reasons = named(monkeypatch, swing, {3.0: (1.1, 0, 0)}, {"b": (1.5, 2.0), "a": (2.0, 2.5)}, zero=1.0)
    assert reasons == {"a": "exceeds the limit of force on a face (near: adult) by chest at 2.00 s"}


def test_nothing_is_attributed_without_key_frames(swing):
    motion = SimpleNamespace(trajectory=swing)
    assert find_excessive_behaviours(SimpleNamespace(frames=[]), motion, near_person({1.0: (2.0, 0, 0)})) == {}
