from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Load
from kinesic.body.limits import Limits
from kinesic.motion.condition import Conditioned, condition
from kinesic.motion.keys import Bond, KeyPosture
from kinesic.motion.trajectory import STEP, Trajectory, stay
from kinesic.planning import certify as certify_module
from kinesic.planning.certify import ATTEMPTS, FULL, KNOTS_PER_WINDOW, TIGHTER, certify, duties, overloaded_times
from kinesic.planning.setup import Setup

Law = Callable[[Floats, Floats, Floats], Floats]  # (m, n) angles, speeds, accelerations -> (m, n) torques
MOVER, BEARER = 6, 10  # a hinge that moves, and one that stands and may feel its pull


@dataclass
class Pulls:
    """Dynamics of a robot whose torques follow a law."""

    load: Load
    law: Law
    asked: list[Floats] = field(default_factory=list)  # the angles of each question

    def torques(self, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        self.asked.append(angles)
        return self.law(angles, speeds, accelerations)


def nothing(angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
    return np.zeros_like(angles)


def under(known: Setup, law: Law) -> Setup:
    return replace(known, dynamics=Pulls(known.dynamics.load, law))


def keys_of(known: Setup, seconds: float = 0.1) -> tuple[KeyPosture, ...]:
    """A hinge goes to another angle, stays a little and comes back; all others stand."""
    limits, count = known.limits, len(known.limits.lower)
    here = np.clip(0.0, limits.lower + 0.1, limits.upper - 0.1)
    there = here + np.where(np.arange(count) == MOVER, 0.3, 0.0)
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
    """The motion through the keys within the limits as they are."""
    return condition(keys_of(known), known.limits)


@pytest.fixture
def searched(monkeypatch: pytest.MonkeyPatch) -> list[Limits]:
    """The limits under which motions are looked for."""
    found: list[Limits] = []
    monkeypatch.setattr(
        certify_module,
        "condition",
        lambda keys, limits, **options: found.append(limits) or condition(keys, limits, **options),
    )
    return found


def assert_limits(found: list[Limits], expected: list[Limits]) -> None:
    for given, wanted in zip(found, expected, strict=True):
        for name, values in vars(wanted).items():
            assert getattr(given, name) == pytest.approx(values), name


def pulling(known: Setup, first: Conditioned, times: float) -> Law:
    """The standing hinge feels the acceleration of the other: at first, so many times its full duty."""
    knots = np.arange(0.0, first.trajectory.duration, STEP)
    share = times * known.robot.drives.stall[BEARER] / largest(first.trajectory.sample(knots)[2][:, MOVER])

    def law(angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        torques = np.zeros_like(angles)
        torques[:, BEARER] = share * accelerations[:, MOVER]
        return torques

    return law


def test_the_duty_is_torque_of_the_stall_torque_and_speed_of_the_speed_without_load(known: Setup):
    count, drives = len(known.limits.lower), known.robot.drives
    heights = np.random.default_rng(5).uniform(-0.1, 0.1, (40, count))
    motion = Trajectory(sealed(heights), 0.0, start=12.5)
    setup = under(known, lambda angles, speeds, accelerations: 2.0 * drives.stall * angles - 0.01 * accelerations)
    angles, speeds, accelerations = motion.sample(12.5 + STEP * np.arange(37))
    expected = (2.0 * drives.stall * angles - 0.01 * accelerations) / drives.stall + speeds / drives.no_load
    assert duties(motion, setup) == pytest.approx(np.abs(expected).max(axis=0))
    (asked,) = setup.dynamics.asked
    assert asked == pytest.approx(angles)


def test_a_motion_whose_drives_have_enough_is_the_conditioned_one(known: Setup, first: Conditioned):
    setup = under(known, nothing)
    same(certify(keys_of(known), setup), first)
    assert len(setup.dynamics.asked) == 1


def test_bonds_ease_and_lead_in_are_those_that_are_given(known: Setup):
    keys, setup = keys_of(known), under(known, nothing)
    bonds = (Bond(("b", "strokeStart"), ("b", "stroke"), 0.9),)
    for asked in ({"bonds": bonds}, {"ease": 0.5}, {"lead_in": 0.0}):
        same(certify(keys, setup, **asked), condition(keys, known.limits, **asked))


def test_what_exceeds_a_drive_tightens_the_row_of_that_drive_alone(
    known: Setup, first: Conditioned, searched: list[Limits]
):
    keys, drives = keys_of(known), known.robot.drives
    knots = np.arange(0.0, first.trajectory.duration, STEP)
    _, speeds, accelerations = first.trajectory.sample(knots)
    weight = 1.3 * drives.stall[MOVER] / largest(accelerations[:, MOVER])
    setup = under(known, lambda angles, speeds, accelerations: weight * accelerations)
    peak = largest(weight * accelerations[:, MOVER] / drives.stall[MOVER] + speeds[:, MOVER] / drives.no_load[MOVER])
    share = np.where(np.arange(len(drives.stall)) == MOVER, TIGHTER / peak, 1.0)
    found = certify(keys, setup)
    assert_limits(searched, [known.limits, known.limits.times(share)])
    assert duties(first.trajectory, setup).max() > 1.05
    assert duties(found.trajectory, setup).max() <= FULL


def test_a_pull_of_another_hinge_is_met_by_tighter_limits_for_all(known: Setup, first: Conditioned):
    setup = under(known, pulling(known, first, 1.1))
    found = certify(keys_of(known), setup)
    assert len(setup.dynamics.asked) == ATTEMPTS // 2 + 3  # half of them in vain, and 1.1 needs two steps of 7 %
    assert duties(found.trajectory, setup)[BEARER] <= FULL


def test_a_duty_a_little_below_the_full_one_is_granted(known: Setup, first: Conditioned):
    assert FULL < 1.0
    for times, attempts in ((FULL - 1e-3, 1), (FULL + 1e-3, ATTEMPTS // 2 + 2)):
        setup = under(known, pulling(known, first, times))
        certify(keys_of(known), setup)
        assert len(setup.dynamics.asked) == attempts


def test_the_full_duty_itself_is_granted(known: Setup):
    stall = known.robot.drives.stall[BEARER]
    full = next(
        torque for torque in np.nextafter(FULL * stall, [FULL * stall, -np.inf, np.inf]) if torque / stall == FULL
    )

    def weight(angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        return np.where(np.arange(angles.shape[1]) == BEARER, full, 0.0) * np.ones_like(angles)

    setup = under(known, weight)
    assert duties(certify(keys_of(known), setup).trajectory, setup)[BEARER] == FULL
    assert len(setup.dynamics.asked) == 2  # once to certify, and once for this test


def test_a_weight_that_no_drive_holds_is_given_up_after_some_attempts(known: Setup, searched: list[Limits]):
    stall = known.robot.drives.stall

    def weight(angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        return np.where(np.arange(len(stall)) == BEARER, -1.25 * stall, 0.0) * np.ones_like(angles)

    setup, keys = under(known, weight), keys_of(known)
    certify(keys, setup)
    assert len(setup.dynamics.asked) == ATTEMPTS == 6
    all_rows = np.full(len(stall), TIGHTER ** (ATTEMPTS - ATTEMPTS // 2))
    all_rows[BEARER] *= (TIGHTER / 1.25) ** ATTEMPTS
    assert len(searched) == ATTEMPTS + 1
    assert_limits(searched[-1:], [known.limits.times(all_rows)])


def test_standing_still_counts_once(known: Setup):
    setup = under(known, nothing)
    duties(Trajectory(sealed(np.zeros((3000, len(known.limits.lower)))), 0.0), setup)
    assert sum(map(len, setup.dynamics.asked)) == 1


def test_a_long_motion_is_looked_at_to_its_end(known: Setup):
    heights = np.zeros((2 * KNOTS_PER_WINDOW, len(known.limits.lower)))
    heights[-5] = 0.1
    setup = under(known, lambda angles, speeds, accelerations: angles * known.robot.drives.stall)
    assert duties(Trajectory(sealed(heights), 0.0), setup).max() > 0.06


def test_overloads_are_found_wherever_they_are_and_fewer_times_are_looked_at(known: Setup, first: Conditioned):
    motion, setup = first.trajectory, under(known, pulling(known, first, 1.2))
    still = stay(motion.sample(np.zeros(1))[0][0], motion.duration)
    knots = motion.start + STEP * np.arange(round(motion.duration / STEP) + 1)
    apart = np.delete(knots, np.arange(0, len(knots), 3))
    for times in (knots, knots[1:], apart, knots[:1], knots[:0]):
        duty = np.abs(setup.dynamics.law(*motion.sample(times))[:, BEARER]) / known.robot.drives.stall[BEARER]
        assert sorted(overloaded_times(still, motion, times, setup)) == times[duty > FULL].tolist()
        assert overloaded_times(motion, motion, times, setup).size == 0
    setup.dynamics.asked.clear()
    overloaded_times(still, still, knots, setup)
    assert sum(map(len, setup.dynamics.asked)) < 0.6 * len(knots)
