"""Collisions and overloads of merged motions, with given distances and duties."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.planning.clearance import MIN_LAG_RESERVE
from kinesic.realizer import conflicts as module
from kinesic.realizer.conflicts import find_conflict
from kinesic.realizer.occupancy import MergeFailure, Overlay
from kinesic.realizer.release import motion_from_knot

from .small_blocks import HINGE_COUNT, use

ROW_COUNT = 60  # control points of the test motions
CHANGE_KNOT = 10  # first spline knot at which the motion may change


def work(performed=(), *, base_rows: int = ROW_COUNT) -> Overlay:
    base = np.zeros((base_rows, HINGE_COUNT))
    return Overlay(base, np.full((ROW_COUNT, HINGE_COUNT), 2.0), base[0], CHANGE_KNOT, (), performed)


@pytest.fixture
def checks(monkeypatch):
    """Results of both stubbed checks, with the motion that each received."""
    results, given = {"_find_collision": None, "_find_overload": None}, {}

    def check(name):
        def take(coming, work, setup):
            given[name] = coming
            return results[name]

        return take

    for name in results:
        monkeypatch.setattr(module, name, check(name))
    return results, given


def summed(*rows: int, value: float = 1.0) -> np.ndarray:
    controls = np.zeros((ROW_COUNT, HINGE_COUNT))
    controls[list(rows), 3] = value
    return controls


@pytest.mark.parametrize("value", [0.0, 1e-9])
def test_merged_motion_equal_to_the_running_one_is_not_checked(known, checks, value):
    assert find_conflict(work(), summed(30, value=value), known) is None
    assert checks[1] == {}


def test_merged_motion_equal_to_that_of_the_block_is_not_checked(known, checks):
    assert find_conflict(work(), np.full((ROW_COUNT, HINGE_COUNT), 2.0), known) is None
    assert checks[1] == {}


@pytest.mark.parametrize(
    ("row", "is_checked"), [(CHANGE_KNOT + 2, False), (CHANGE_KNOT + 3, True), (CHANGE_KNOT + 4, True)]
)
def test_merged_motion_is_checked_only_if_it_differs_three_or_more_knots_after_the_change_time(
    known, checks, row, is_checked
):
    find_conflict(work(), summed(5, row), known)
    assert bool(checks[1]) is is_checked


def test_merged_motion_is_checked_from_the_change_time_to_its_last_difference_from_both_motions(known, checks):
    find_conflict(work(base_rows=20), summed(5, 40), known)
    controls = checks[1]["_find_collision"].controls
    np.testing.assert_array_equal(controls, motion_from_knot(summed(5, 40)[:43], CHANGE_KNOT).controls)
    assert len(controls) == 33
    assert checks[1]["_find_overload"].controls is controls


def test_collision_is_reported_instead_of_an_overload(known, checks):
    results, given = checks
    results["_find_overload"] = MergeFailure("heavy", "")
    assert find_conflict(work(), summed(30), known).behaviour == "heavy"
    given.clear()
    results["_find_collision"] = MergeFailure("close", "")
    assert find_conflict(work(), summed(30), known).behaviour == "close"
    assert list(given) == ["_find_collision"]


@pytest.fixture
def collision(known, monkeypatch):
    """Return the failure caused by a distance [m] of two bodies."""

    def at(distance: float, pair: tuple[str, str], performed) -> MergeFailure | None:
        clearance = SimpleNamespace(worst=1, distances=np.array([9.0, distance]), pairs=[("a", "b"), pair])
        monkeypatch.setattr(module, "scan_clearance", lambda *_: (np.array([5.0, 0.2]), clearance))
        monkeypatch.setattr(module, "_find_overload", lambda *_: None)
        return find_conflict(work(performed), summed(30), known)

    return at


def test_only_a_distance_below_the_required_clearance_is_a_collision(known, collision):
    least = known.robot.min_clearance + MIN_LAG_RESERVE
    assert collision(least, ("torso", "head"), ()) is None
    assert collision(least + 0.001, ("torso", "head"), ()) is None
    assert collision(least - 0.001, ("torso", "head"), ()) is not None


def test_collision_names_both_bodies_and_their_distance(collision):
    failure = collision(-0.0124, ("torso", "head"), ())
    assert failure.behaviour == ""
    assert failure.why.startswith("brings torso within -12 mm of head in combination")


@pytest.mark.parametrize("side", ["l", "r"])
def test_collision_of_an_arm_names_the_behaviour_of_this_arm(known, collision, side):
    arms = {each: known.robot.arm(each) for each in "lr"}
    body = sorted(arms[side].bodies - arms["l" if side == "r" else "r"].bodies)[0]
    performed = [use("n", hinges=[3], begin=0.25, end=0.35)]
    performed += [use(each, hinges=arms[each].all_joints, begin=5.0, end=6.0) for each in "lr"]
    assert collision(0.0, (body, "torso"), performed).behaviour == side
    assert collision(0.0, ("torso", body), performed).behaviour == side


def test_collision_of_torso_and_head_names_the_behaviour_at_its_time(collision):
    performed = [use("early", begin=0.0, end=0.1), use("at", begin=0.28, end=0.29), use("late", begin=0.5, end=0.9)]
    assert collision(0.0, ("torso", "head"), performed).behaviour == "at"


@pytest.fixture
def overload(known, monkeypatch):
    """Return a function from peak motor duties to the failure of a merge."""

    def at(after: tuple[float, float], before: tuple[float, float], performed=()) -> MergeFailure | None:
        pairs, lengths = iter((after, before)), []

        def peaks(motion, setup):
            lengths.append(len(motion.controls))
            return np.array([*next(pairs), *np.zeros(HINGE_COUNT - 2)])

        monkeypatch.setattr(module, "compute_peak_duties", peaks)
        monkeypatch.setattr(module, "_find_collision", lambda *_: None)
        failure = find_conflict(work(performed), summed(30), known)
        assert len(set(lengths)) == 1
        return failure

    return at


@pytest.mark.parametrize(
    ("after", "before", "is_overload"),
    [
        ((1.0, 0.5), (0.0, 0.0), False),
        ((1.1, 0.5), (1.2, 0.0), False),
        ((1.1, 0.5), (1.1, 0.0), False),
        ((1.1, 0.5), (1.0, 0.0), True),
        ((1.3, 1.1), (1.4, 1.0), True),
    ],
)
def test_duty_above_one_is_an_overload_only_if_the_block_raises_it(overload, after, before, is_overload):
    assert (overload(after, before) is not None) == is_overload


def test_overload_names_the_worst_raised_joint_and_its_behaviour(known, overload):
    first, second = known.robot.skeleton.names[:2]
    performed = [use("one", hinges=[0], begin=0.0, end=9.0), use("two", hinges=[1], begin=5.0, end=9.0)]
    failure = overload((1.3, 1.124), (1.4, 1.0), performed)
    assert failure.behaviour == "two"
    assert failure.why.startswith(f"needs 112 % of the duty of {second} in combination")
    assert first in overload((1.3, 1.1), (1.0, 1.0), performed).why


def test_overload_names_the_first_behaviour_after_the_change_time(overload):
    performed = [use("late", hinges=[0], begin=0.5, end=0.6), use("soon", hinges=[0], begin=0.11, end=0.2)]
    performed.append(use("past", hinges=[0], begin=0.0, end=0.05))
    assert overload((1.3, 0.0), (1.0, 1.0), performed).behaviour == "soon"
