import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.condition import LEAD_IN, Conditioned, condition
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.keys import Bond, KeyPassage, KeyPosture
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import KNOT_INTERVAL, stay

# angle, velocity, acceleration and jerk limits of two hinges
BOX_LIMITS = ([-2] * 2, [2] * 2, [4, 6], [40, 60], [1e3, 1.5e3])
# duty per acceleration, duty per velocity and duty limit of two hinges
DUTY_LIMITS = ([0.01] * 2, [0.15] * 2, [0.7] * 2)
JOINT_LIMITS = Limits(*(sealed(pair) for pair in (*BOX_LIMITS, *DUTY_LIMITS)))  # limits of two hinges


def posture(time: float, angles: tuple[float, float], *syncs: str, behaviour: str = "b") -> KeyPosture:
    return KeyPosture(time, sealed(angles), (True, True), tuple((behaviour, sync) for sync in syncs))


def highest(motion) -> float:
    """Return the largest ratio of a quantity to its limit."""
    return max(float(peak.ratios.max()) for peak in check_limits(motion.trajectory, JOINT_LIMITS).by_quantity.values())


def test_motion_within_limits_keeps_its_requested_times():
    keys = (posture(0.0, (0, 0), "start"), posture(1.0, (0.5, 0.5), "stroke"), posture(2.0, (0, 0), "end"))
    motion = condition(keys, JOINT_LIMITS)
    np.testing.assert_array_equal(motion.planned, motion.requested_times)
    assert not motion.bottlenecks
    assert motion.rms_distances.max() < 1e-4


def test_too_fast_motion_is_stretched_and_reports_its_bottleneck_hinge():
    keys = (posture(0.0, (0, 0), "start"), posture(0.2, (1.5, 0.1), "stroke"), posture(0.4, (0, 0), "end"))
    motion = condition(keys, JOINT_LIMITS)
    assert {bottleneck.hinge for bottleneck in motion.bottlenecks.values()} == {0}
    assert highest(motion) <= 1.0 + 1e-6
    assert motion.planned[2] - motion.planned[0] > 0.4


@pytest.mark.parametrize("pairs", [((0, 1),), ((0, 1), (1, 2), (2, 4))])
def test_bottleneck_near_a_time_is_the_nearest_bottleneck_and_preferably_of_the_given_hinges(pairs):
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    bottlenecks = {pair: Bottleneck(hinge, "velocity", 2.0) for hinge, pair in enumerate(pairs)}
    motion = Conditioned(stay(np.zeros(3)), times, times, bottlenecks, np.zeros(3))
    nearest = {(0.4, ()): 0, (1.0, (1,)): 1, (1.5, (2,)): 1, (2.0, (0,)): 1, (2.0, (2,)): 2, (5.0, ()): 2}
    for (time, hinges), hinge in nearest.items():
        bottleneck = motion.bottleneck_near(time, hinges)
        assert bottleneck is not None
        assert bottleneck.hinge == (hinge if len(pairs) > 1 else 0)


def test_sharp_desired_motion_keeps_its_times_and_is_smoothed():
    keys = (posture(0.0, (0, 0), "start"), posture(0.44, (1.0, 0), "stroke"), posture(0.88, (0, 0), "end"))
    motion = condition(tuple(replace(key, passages=(KeyPassage(tension=1.0),) * 2) for key in keys), JOINT_LIMITS)
    np.testing.assert_array_equal(motion.planned, motion.requested_times)
    assert motion.rms_distances[0] > 1e-3
    assert highest(motion) <= 1.0 + 1e-6


@dataclass(frozen=True, eq=False)
class Curve:
    """Desired motion that does not depend on the keys."""

    start: float  # [s] block time

    def angles(self, at):
        times = at + self.start
        return np.stack([0.3 * np.sin(2.0 * times), 0.2 * np.cos(3.0 * times)], axis=1)


def on_the_curve(*times: float) -> tuple[KeyPosture, ...]:
    return tuple(posture(time, tuple(Curve(time).angles(np.zeros(1))[0]), "stroke") for time in times)


def test_reported_deviation_is_the_rms_distance_from_the_desired_motion_at_the_knots():
    """Test keys on the desired motion, then one key away from it."""
    ends = on_the_curve(1.0, 3.0)
    aside = posture(2.0, tuple(Curve(2.0).angles(np.zeros(1))[0] + [0.3, 0.0]), "stroke")
    for keys in (ends, (ends[0], aside, ends[1])):
        motion = condition(keys, JOINT_LIMITS, make_desired=lambda times, keys: Curve(float(times[0])))
        knots = np.arange(201) * KNOT_INTERVAL
        away = motion.trajectory.sample(knots)[0] - Curve(float(motion.planned[0])).angles(knots)
        assert motion.trajectory.duration == pytest.approx(2.0)
        assert motion.rms_distances == pytest.approx(np.sqrt((away**2).sum(axis=0) / 201))
        assert motion.rms_distances.shape == (2,)
    assert motion.rms_distances[0] > 3.0 * motion.rms_distances[1] > 0.0


def test_trajectory_time_of_block_time_zero_is_minus_the_first_key_time():
    for first in (-0.5, 0.0, 2.0):
        keys = (posture(first, (0, 0), "start"), posture(first + 2.0, (0.5, 0.5), "end"))
        motion = condition(keys, JOINT_LIMITS)
        assert motion.trajectory.zero == pytest.approx(-first)
        assert motion.trajectory.at(first + 2.0 + motion.trajectory.zero).angles == pytest.approx([0.5, 0.5])


def test_reduced_limits_determine_key_times_and_full_limits_determine_the_motion():
    """Expect less smoothing than if reduced limits also determined the motion."""
    sharp = (KeyPassage(tension=1.0),) * 2
    keys = tuple(
        replace(posture(time, angles, sync), passages=sharp)
        for time, angles, sync in ((0.0, (0, 0), "start"), (0.5, (1.0, 0.4), "stroke"), (1.0, (0, 0), "end"))
    )
    hard, easy, slow = (
        condition(keys, JOINT_LIMITS),
        condition(keys, JOINT_LIMITS, limit_scale=0.25),
        condition(keys, JOINT_LIMITS.scaled(0.25)),
    )
    assert np.ptp(easy.planned) > 1.2 * np.ptp(hard.planned)
    np.testing.assert_allclose(easy.planned, slow.planned, atol=1e-9)
    assert easy.rms_distances[0] < 0.5 * slow.rms_distances[0]
    assert highest(easy) <= 1.0 + 1e-6
    np.testing.assert_array_equal(condition(keys, JOINT_LIMITS, limit_scale=1.0).planned, hard.planned)


@pytest.mark.parametrize("finder", ["can_pass", "nearest_within_limits"])
def test_motion_without_a_spline_solution_takes_longer_and_keeps_limits(monkeypatch, finder):
    keys = (posture(0.0, (0, 0), "start"), posture(0.2, (1.5, 0.1), "stroke"), posture(0.4, (0, 0), "end"))
    usual = condition(keys, JOINT_LIMITS, limit_scale=0.8)
    monkeypatch.setattr(sys.modules[condition.__module__], finder, lambda *_: None)
    slower = condition(keys, JOINT_LIMITS, limit_scale=0.8)
    assert np.ptp(slower.planned) > 1.05 * np.ptp(usual.planned)
    assert highest(slower) <= 1.0 + 1e-6


def test_motion_passes_exactly_through_keys_between_spline_knots():
    rng = np.random.default_rng(3)
    times = np.cumsum(rng.uniform(0.3, 0.6, 8))
    keys = tuple(posture(float(t), tuple(rng.uniform(-0.6, 0.6, 2)), "stroke") for t in times)
    motion = condition(keys, JOINT_LIMITS)
    samples = motion.trajectory.sample(motion.planned + motion.trajectory.zero)[0]
    np.testing.assert_allclose(samples, [key.angles for key in keys], atol=1e-7)


def test_stroke_time_is_kept_if_the_preparation_can_begin_earlier():
    keys = (posture(0.0, (0, 0), "start"), posture(0.3, (1.2, 0.1), "stroke"), posture(3.0, (0, 0), "end"))
    motion = condition(keys, JOINT_LIMITS)
    assert motion.planned[1] == pytest.approx(0.3, abs=1e-6)
    assert motion.planned[0] < 0.0


def test_default_lead_in_is_600_ms():
    """Test a preparation that lacks time and uses the whole lead-in."""
    slow = replace(JOINT_LIMITS, speed=sealed([1.0, 1.0]))
    keys = (posture(0.0, (0, 0), "start"), posture(0.2, (1.5, 0.0), "stroke"), posture(9.0, (0, 0), "end"))
    planned = condition(keys, slow).planned
    assert planned[0] == pytest.approx(-0.6, abs=1e-6)
    assert planned[1] > 0.9
    assert condition(keys, slow, lead_in=0.25).planned[0] == pytest.approx(-0.25, abs=1e-6)


def test_start_key_moves_earlier_by_at_most_the_given_lead_in():
    keys = (posture(0.0, (0, 0), "start"), posture(0.05, (1.9, 1.9), "stroke"), posture(3.0, (0, 0), "end"))
    assert condition(keys, JOINT_LIMITS).planned[0] >= -LEAD_IN - 1e-9
    assert condition(keys, JOINT_LIMITS, lead_in=0.0).planned[0] >= -1e-9


def test_start_key_at_a_joint_limit_is_met_within_1_mrad():
    keys = (posture(0.0, (2, -2), "start"), posture(1.0, (0.5, 2), "stroke"), posture(2.0, (2, 0), "end"))
    motion = condition(keys, JOINT_LIMITS)
    assert abs(motion.trajectory.at(0.0).angles[0] - 2.0) <= 1.001e-3
    assert highest(motion) <= 1.0 + 1e-6


def test_conditioning_preserves_the_order_of_keys():
    rng = np.random.default_rng(4)
    keys = tuple(posture(0.1 * k, tuple(rng.uniform(-1.5, 1.5, 2)), "stroke") for k in range(8))
    motion = condition(keys, JOINT_LIMITS)
    assert np.all(np.diff(motion.planned) > 0)


def test_conditioning_separates_simultaneous_keys_of_different_hinges():
    keys = (
        posture(0.0, (0, 0), "start"),
        posture(1.0, (0.3, 0), "stroke"),
        posture(1.0, (0.2, 0.1)),
        posture(2.0, (0, 0), "end"),
    )
    motion = condition(keys, JOINT_LIMITS)
    assert np.all(np.diff(motion.planned) > 0.019)
    assert np.all(np.isfinite(motion.trajectory.sample(np.linspace(0, 2, 50))[2]))


def test_sync_points_with_a_fixed_offset_are_shifted_together():
    first, second = (True, False), (False, True)
    keys = (
        posture(0.0, (0, 0), "start", behaviour="one"),
        KeyPosture(0.15, sealed((1.5, 0)), first, (("one", "stroke"),)),
        KeyPosture(0.65, sealed((1.5, 0.1)), second, (("two", "stroke"),)),
        posture(3.0, (0, 0), "end", behaviour="one"),
    )
    ties = (Bond(("one", "stroke"), ("two", "stroke"), 0.5), Bond(("two", "stroke"), ("one", "stroke"), -0.5))
    free, tied = (condition(keys, JOINT_LIMITS, bonds=bonds, lead_in=0.0).planned for bonds in ((), ties))
    assert free[1] > 0.25
    assert free[2] == pytest.approx(0.65)
    assert tied[2] - tied[1] == pytest.approx(0.5)


def on_a_circle(turns: float, amplitude: float, seconds: float) -> tuple[KeyPosture, ...]:
    """Return path keys on circles between an exact first and last key."""
    shares = np.linspace(0.0, 1.0, 9 * round(turns))
    circle = amplitude * np.stack([np.sin(2 * np.pi * turns * shares), np.cos(2 * np.pi * turns * shares) - 1.0])
    is_exact = [0, len(shares) - 1]
    inner = tuple(
        KeyPosture(
            1.0 + seconds * float(share),
            sealed(angles),
            (True, True),
            ((("b", "strokeStart"), ("b", "stroke"))[k > 0],) if k in is_exact else (),
            is_exact=k in is_exact,
        )
        for k, (share, angles) in enumerate(zip(shares, circle.T, strict=True))
    )
    return (posture(0.0, (0, 0), "start"), *inner, posture(2.0 + seconds, (0, 0), "end"))


def test_feasible_path_is_followed_within_1_mrad_at_its_keys():
    keys = on_a_circle(turns=2, amplitude=0.2, seconds=2.0)
    motion = condition(keys, JOINT_LIMITS)
    np.testing.assert_array_equal(motion.planned, motion.requested_times)
    samples = motion.trajectory.sample(motion.planned + motion.trajectory.zero)[0]
    np.testing.assert_allclose(samples, [key.angles for key in keys], atol=1e-3)


def test_infeasible_path_shrinks_and_keeps_its_key_times():
    keys = on_a_circle(turns=4, amplitude=0.3, seconds=1.0)
    motion = condition(keys, JOINT_LIMITS)
    np.testing.assert_array_equal(motion.planned, motion.requested_times)
    assert not motion.bottlenecks
    assert highest(motion) <= 1.0 + 1e-6
    samples = motion.trajectory.sample(motion.planned + motion.trajectory.zero)[0]
    is_exact = [key.is_exact for key in keys]
    np.testing.assert_allclose(samples[is_exact], [key.angles for key in keys if key.is_exact], atol=1e-6)
    assert 0.02 < np.ptp(samples[:, 0]) < 0.5 * np.ptp([key.angles[0] for key in keys])


def test_path_keys_stay_evenly_spaced_in_time_if_the_ends_of_their_path_move():
    keys = on_a_circle(turns=1, amplitude=0.2, seconds=0.5)
    late = tuple(replace(key, time=key.time - 0.95) if key.time > 0 else key for key in keys)
    far = tuple(replace(key, angles=sealed(np.asarray(key.angles) + 0.9)) if key.time > 0 else key for key in late)
    motion = condition((*far[:-1], replace(far[-1], angles=sealed([0.0, 0.0]))), JOINT_LIMITS, lead_in=0.0)
    assert motion.bottlenecks
    assert np.all(np.diff(motion.planned) > 0.0)
    share = np.interp(motion.planned, motion.planned[[1, -2]], [0.0, 1.0])
    np.testing.assert_allclose(share[1:-1], np.linspace(0.0, 1.0, len(share) - 2), atol=1e-6)
