from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Load
from kinesic.body.limits import Limits
from kinesic.motion.condition import Conditioned, condition
from kinesic.motion.keys import Bond, KeyPosture
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, stay
from kinesic.planning import certify as certify_module
from kinesic.planning.certify import (
    KNOTS_PER_WINDOW,
    MAX_DUTY,
    MAX_TIGHTENINGS,
    TIGHTENING_FACTOR,
    certify,
    compute_peak_duties,
    find_overloaded_times,
)
from kinesic.planning.setup import Setup

Law = Callable[[Floats, Floats, Floats], Floats]  # (m, n) angles, speeds, accelerations -> (m, n) torques
MOVING_HINGE = 6  # index of the moving hinge
LOADED_HINGE = 10  # index of the hinge that stands still and is loaded by the motion


@dataclass
class Pulls:
    """Dynamics with torques by a given function."""

    load: Load
    law: Law
    asked: list[Floats] = field(default_factory=list)  # angles of each evaluation

    def torques(self, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        self.asked.append(angles)
        return self.law(angles, speeds, accelerations)


def nothing(angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
    return np.zeros_like(angles)


def under(known: Setup, law: Law) -> Setup:
    return replace(known, dynamics=Pulls(known.dynamics.load, law))


def keys_of(known: Setup, seconds: float = 0.1) -> tuple[KeyPosture, ...]:
    """Return keys of one hinge that moves, holds its angle and returns."""
    limits, count = known.limits, len(known.limits.lower)
    here = np.clip(0.0, limits.lower + 0.1, limits.upper - 0.1)
    there = here + np.where(np.arange(count) == MOVING_HINGE, 0.3, 0.0)
    times = np.array([0.0, seconds, seconds + 0.4, 2 * seconds + 0.4])
    return tuple(
        KeyPosture(float(time), sealed(angles), (True,) * count, (("b", sync),))
        for time, angles, sync in zip(
            times, (here, there, there, here), ("start", "strokeStart", "stroke", "end"), strict=True
        )
    )


def largest(values: Floats) -> float:
    return float(np.abs(values).max())


def same(found: Conditioned, expected: Conditioned) -> None:
    np.testing.assert_array_equal(found.planned, expected.planned)
    np.testing.assert_array_equal(found.trajectory.controls, expected.trajectory.controls)


@pytest.fixture(scope="module")
def first(known: Setup) -> Conditioned:
    """Return the motion through the keys within the given limits."""
    return condition(keys_of(known), known.limits)


@pytest.fixture
def searched(monkeypatch: pytest.MonkeyPatch) -> list[Limits]:
    """Record the limits of all conditionings."""
    results: list[Limits] = []
    monkeypatch.setattr(
        certify_module,
        "condition",
        lambda keys, limits, **options: results.append(limits) or condition(keys, limits, **options),
    )
    return results


def assert_limits(found: list[Limits], expected: list[Limits]) -> None:
    for given, wanted in zip(found, expected, strict=True):
        for name, values in vars(wanted).items():
            assert getattr(given, name) == pytest.approx(values), name


def pulling(known: Setup, first: Conditioned, times: float) -> Law:
    """Return dynamics that load a hinge at rest by another hinge's acceleration."""
    knots = np.arange(0.0, first.trajectory.duration, KNOT_INTERVAL)
    share = times * known.robot.drives.stall[LOADED_HINGE] / largest(first.trajectory.sample(knots)[2][:, MOVING_HINGE])

    def law(angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        torques = np.zeros_like(angles)
        torques[:, LOADED_HINGE] = share * accelerations[:, MOVING_HINGE]
        return torques

    return law


def test_drive_duty_combines_torque_and_velocity(known: Setup):
    count, drives = len(known.limits.lower), known.robot.drives
    heights = np.random.default_rng(5).uniform(-0.1, 0.1, (40, count))
    motion = Trajectory(sealed(heights), 0.0, start=12.5)
    setup = under(known, lambda angles, speeds, accelerations: 2.0 * drives.stall * angles - 0.01 * accelerations)
    angles, speeds, accelerations = motion.sample(12.5 + KNOT_INTERVAL * np.arange(37))
    expected = (2.0 * drives.stall * angles - 0.01 * accelerations) / drives.stall + speeds / drives.no_load
    assert compute_peak_duties(motion, setup) == pytest.approx(np.abs(expected).max(axis=0))
    (asked,) = setup.dynamics.asked
    assert asked == pytest.approx(angles)


def test_motion_within_the_maximum_duty_is_unchanged(known: Setup, first: Conditioned):
    setup = under(known, nothing)
    same(certify(keys_of(known), setup), first)
    assert len(setup.dynamics.asked) == 1


def test_torque_certification_passes_its_options_on_to_conditioning(known: Setup):
    keys, setup = keys_of(known), under(known, nothing)
    bonds = (Bond(("b", "strokeStart"), ("b", "stroke"), 0.9),)
    for asked in ({"bonds": bonds}, {"limit_scale": 0.5}, {"lead_in": 0.0}):
        same(certify(keys, setup, **asked), condition(keys, known.limits, **asked))


def test_all_motions_computed_in_one_torque_certification_share_stored_cutting_planes(
    known: Setup, first: Conditioned, monkeypatch: pytest.MonkeyPatch
):
    memories: list[PlaneMemory | None] = []
    monkeypatch.setattr(certify_module, "condition", lambda *_, memory, **__: memories.append(memory) or first)
    setup, given = under(known, pulling(known, first, 1.1)), PlaneMemory()
    certify(keys_of(known), setup, memory=given)
    assert memories == [given] * (MAX_TIGHTENINGS + 1)
    memories.clear()
    certify(keys_of(known), setup)
    assert isinstance(memories[0], PlaneMemory)
    assert memories == memories[:1] * (MAX_TIGHTENINGS + 1)


def test_overload_tightens_only_the_limits_of_the_overloaded_drive(
    known: Setup, first: Conditioned, searched: list[Limits]
):
    keys, drives = keys_of(known), known.robot.drives
    knots = np.arange(0.0, first.trajectory.duration, KNOT_INTERVAL)
    _, speeds, accelerations = first.trajectory.sample(knots)
    weight = 1.3 * drives.stall[MOVING_HINGE] / largest(accelerations[:, MOVING_HINGE])
    setup = under(known, lambda angles, speeds, accelerations: weight * accelerations)
    peak = largest(
        weight * accelerations[:, MOVING_HINGE] / drives.stall[MOVING_HINGE]
        + speeds[:, MOVING_HINGE] / drives.no_load[MOVING_HINGE]
    )
    share = np.where(np.arange(len(drives.stall)) == MOVING_HINGE, TIGHTENING_FACTOR / peak, 1.0)
    certified = certify(keys, setup)
    assert_limits(searched, [known.limits, known.limits.scaled(share)])
    assert compute_peak_duties(first.trajectory, setup).max() > 1.05
    assert compute_peak_duties(certified.trajectory, setup).max() <= MAX_DUTY


def test_persistent_overload_tightens_the_limits_of_all_drives(known: Setup, first: Conditioned):
    setup = under(known, pulling(known, first, 1.1))
    certified = certify(keys_of(known), setup)
    assert len(setup.dynamics.asked) == MAX_TIGHTENINGS // 2 + 3  # half of them in vain, and 1.1 needs two steps of 7 %
    assert compute_peak_duties(certified.trajectory, setup)[LOADED_HINGE] <= MAX_DUTY


def test_duty_below_the_maximum_is_accepted_and_above_it_tightens_limits(known: Setup, first: Conditioned):
    assert MAX_DUTY < 1.0
    for times, attempts in ((MAX_DUTY - 1e-3, 1), (MAX_DUTY + 1e-3, MAX_TIGHTENINGS // 2 + 2)):
        setup = under(known, pulling(known, first, times))
        certify(keys_of(known), setup)
        assert len(setup.dynamics.asked) == attempts


def test_duty_equal_to_the_maximum_is_accepted(known: Setup):
    stall = known.robot.drives.stall[LOADED_HINGE]
    full = next(
        torque
        for torque in np.nextafter(MAX_DUTY * stall, [MAX_DUTY * stall, -np.inf, np.inf])
        if torque / stall == MAX_DUTY
    )

    def weight(angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        return np.where(np.arange(angles.shape[1]) == LOADED_HINGE, full, 0.0) * np.ones_like(angles)

    setup = under(known, weight)
    assert compute_peak_duties(certify(keys_of(known), setup).trajectory, setup)[LOADED_HINGE] == MAX_DUTY
    assert len(setup.dynamics.asked) == 2  # once to certify, and once for this test


def test_torque_certification_of_an_impossible_load_ends_after_six_attempts(known: Setup, searched: list[Limits]):
    stall = known.robot.drives.stall

    def weight(angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        return np.where(np.arange(len(stall)) == LOADED_HINGE, -1.25 * stall, 0.0) * np.ones_like(angles)

    setup, keys = under(known, weight), keys_of(known)
    certify(keys, setup)
    assert len(setup.dynamics.asked) == MAX_TIGHTENINGS == 6
    all_rows = np.full(len(stall), TIGHTENING_FACTOR ** (MAX_TIGHTENINGS - MAX_TIGHTENINGS // 2))
    all_rows[LOADED_HINGE] *= (TIGHTENING_FACTOR / 1.25) ** MAX_TIGHTENINGS
    assert len(searched) == MAX_TIGHTENINGS + 1
    assert_limits(searched[-1:], [known.limits.scaled(all_rows)])


def test_torque_of_repeated_motion_states_is_evaluated_once(known: Setup):
    setup = under(known, nothing)
    compute_peak_duties(Trajectory(sealed(np.zeros((3000, len(known.limits.lower)))), 0.0), setup)
    assert sum(map(len, setup.dynamics.asked)) == 1


def test_torque_certification_checks_a_long_motion_to_its_end(known: Setup):
    heights = np.zeros((2 * KNOTS_PER_WINDOW, len(known.limits.lower)))
    heights[-5] = 0.1
    setup = under(known, lambda angles, speeds, accelerations: angles * known.robot.drives.stall)
    assert compute_peak_duties(Trajectory(sealed(heights), 0.0), setup).max() > 0.06


def moving_slowly(known: Setup, knots: int, *, bump: int) -> Trajectory:
    """Return a motion without repeated states that bumps the loaded hinge once."""
    heights = np.zeros((knots + 3, len(known.limits.lower)))
    heights[:, MOVING_HINGE] = np.random.default_rng(8).uniform(0.0, 1e-3, knots + 3)
    heights[bump + 1, LOADED_HINGE] = 1e-3
    return Trajectory(sealed(heights), 0.0)


def test_time_between_two_low_duties_is_evaluated_only_if_they_are_over_two_knots_apart(known: Setup):
    motion, stall = moving_slowly(known, 20, bump=7), known.robot.drives.stall[LOADED_HINGE]
    peak = motion.sample(np.array([7 * KNOT_INTERVAL]))[0][0, LOADED_HINGE]
    setup = under(
        known,
        lambda angles, *_: np.where(np.arange(angles.shape[1]) == LOADED_HINGE, 1.2, 0.0) * stall * (angles / peak),
    )
    at_rest = Trajectory(sealed(np.zeros_like(motion.controls)), 0.0)

    def found(*knots: int) -> tuple[list[int], int]:
        """Return the overloaded knots and the number of evaluated states."""
        setup.dynamics.asked.clear()
        times = KNOT_INTERVAL * np.array(knots)
        overloaded = np.rint(find_overloaded_times(at_rest, motion, times, setup) / KNOT_INTERVAL)
        return sorted(overloaded.astype(int)), sum(map(len, setup.dynamics.asked[:2]))

    assert found(0, 1, 2, 3, 4) == ([], 3)
    assert found(0, 1, 2, 3) == ([], 3)  # the last time has no successor
    assert found(1, 2, 3, 7, 9, 10) == ([7], 5)
    assert found(10, 11, 12, 14, 15) == ([], 4)  # an interval of 3 knots
    assert found(5, 6, 7, 8, 9) == ([7], 5)


@pytest.mark.parametrize(("duty", "evaluated"), [(0.5, 3), (0.51, 5)])
def test_duty_is_not_evaluated_between_two_times_with_duty_of_at_most_one_half(
    duty: float, evaluated: int, known: Setup
):
    motion, stall = moving_slowly(known, 20, bump=15), known.robot.drives.stall[LOADED_HINGE]
    share = np.where(np.arange(len(known.limits.lower)) == LOADED_HINGE, duty * stall, 0.0)
    setup = under(known, lambda angles, *_: share + np.zeros_like(angles))
    assert find_overloaded_times(motion, motion, KNOT_INTERVAL * np.arange(5), setup).size == 0
    assert sum(map(len, setup.dynamics.asked)) == evaluated


def test_overloaded_times_match_an_evaluation_of_all_times_and_need_fewer_at_rest(known: Setup, first: Conditioned):
    motion, setup = first.trajectory, under(known, pulling(known, first, 1.2))
    still = stay(motion.sample(np.zeros(1))[0][0], motion.duration)
    knots = motion.start + KNOT_INTERVAL * np.arange(round(motion.duration / KNOT_INTERVAL) + 1)
    apart = np.delete(knots, np.arange(0, len(knots), 3))
    for times in (knots, knots[1:], apart, knots[:1], knots[:0]):
        duty = (
            np.abs(setup.dynamics.law(*motion.sample(times))[:, LOADED_HINGE]) / known.robot.drives.stall[LOADED_HINGE]
        )
        assert sorted(find_overloaded_times(still, motion, times, setup)) == times[duty > MAX_DUTY].tolist()
        assert find_overloaded_times(motion, motion, times, setup).size == 0
    setup.dynamics.asked.clear()
    find_overloaded_times(still, still, knots, setup)
    assert sum(map(len, setup.dynamics.asked)) < 0.6 * len(knots)
