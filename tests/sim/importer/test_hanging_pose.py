"""Hanging arm poses: results on a small robot, and the search for them."""

import numpy as np
import pytest

from kinesic.body.least_squares import Minimum
from kinesic.sim.importer import hanging_pose
from kinesic.sim.importer.arm import Split, centres
from kinesic.sim.importer.hanging_pose import Ranges, find_elbow_sense, pose_arm
from kinesic.sim.importer.hinge_row import HingeRow
from kinesic.sim.importer.zero_pose import HANGING_ARM, hang_arm

ARM_SPLIT = Split(0, 3, 3)


@pytest.fixture(autouse=True, scope="module")
def random_starts() -> None:
    """Keep the usual number of random starts."""


@pytest.fixture
def row(tee):
    names = [joint.name for joint in tee.joints]
    return tuple(names.index(f"l_{part}") for part in ("pitch", "roll", "twist", "bend", "turn", "nod", "wag"))


def test_imported_arm_in_t_pose_is_turned_to_hang_straight_down(tee, row):
    posed = hang_arm(tee, row, ARM_SPLIT, HANGING_ARM, strict=False)
    assert np.degrees(posed.off) < 0.5
    assert np.degrees(posed.angles[1]) == pytest.approx(-90, abs=0.5)
    at = centres(HingeRow.of(tee, row).turned(posed.angles), ARM_SPLIT)
    assert at.wrist == pytest.approx(at.shoulder - [0, 0, sum(at.lengths)], abs=0.005)


def test_imported_arm_turned_to_hang_stays_within_its_narrow_joint_range(tee, row):
    roll = tee.joints[row[1]]
    posed = hang_arm(tee, row, ARM_SPLIT, HANGING_ARM, strict=True)
    assert roll.lower - 1e-6 <= posed.angles[1] <= roll.upper + 1e-6


def test_elbow_of_a_hanging_imported_arm_bends_towards_the_middle_of_its_range(tee, row):
    limb = HingeRow.of(tee, row)
    assert find_elbow_sense(limb, ARM_SPLIT, -2.4, 0.1) == -1.0
    assert find_elbow_sense(limb, ARM_SPLIT, -0.1, 2.4) == 1.0
    assert find_elbow_sense(limb, ARM_SPLIT, -2.0, 2.0) == 0.0
    assert find_elbow_sense(limb, ARM_SPLIT, -np.inf, np.inf) == 0.0


X, Y, Z = np.eye(3)
PLAIN_SPLIT, WRIST_SPLIT = Split(0, 3, 0), Split(0, 3, 1)


def hanging_row(elbow_axis=Y, wrist=False):
    """Return an arm that hangs straight, with a shoulder of three hinges."""
    anchors = [0 * X, 0 * X, 0 * X, -0.3 * Z, -0.6 * Z][: 5 if wrist else 4]
    axes = [X, Y, Z, elbow_axis, X][: len(anchors)]
    return HingeRow(np.array(anchors), np.array(axes), -0.7 * Z, -0.75 * Z)


def free(count):
    return np.full(count, -np.inf), np.full(count, np.inf)


class RecordedSearch:
    """Search that returns given solutions and records its calls."""

    def __init__(self, monkeypatch, solutions):
        self.calls, self._solutions = [], list(solutions)
        monkeypatch.setattr(hanging_pose, "minimise_squares", self)

    def __call__(self, residuals, start, *, bounds, max_evaluations):
        self.calls.append((residuals, start, bounds, max_evaluations))
        values, cost = self._solutions.pop(0) if self._solutions else (start, 1.0)
        return Minimum(np.array(values, float), cost)


def search(monkeypatch, row, split, ranges, *, first=(), solutions=()):
    """Return the calls of a recorded search, and the pose found."""
    recorded = RecordedSearch(monkeypatch, solutions)
    return recorded.calls, pose_arm(row, split, HANGING_ARM, ranges, list(first))


def test_arm_pose_search_begins_with_given_angles_then_zero_then_ten_random_postures(monkeypatch):
    ranges = Ranges(np.array([-9.0, -0.5, 0.25, -1.0]), np.array([9.0, 0.5, 0.75, 1.0]), strict=True)
    first = np.array([0.1, 0.2, 0.3, 0.4])
    calls, _ = search(monkeypatch, hanging_row(), PLAIN_SPLIT, ranges, first=[first])
    starts = np.array([start for _, start, *_ in calls[:-1]])
    assert len(starts) == 12
    np.testing.assert_array_equal(starts[:2], [first, [0, 0, 0.25, 0]])
    random = starts[2:]
    assert (np.abs(random[:, 0]) <= np.pi).all()
    assert (np.ptp(random, axis=0) > [2.0, 0.3, 0.15, 0.6]).all()
    assert ((random >= ranges.lower) & (random <= ranges.upper)).all()
    assert {evaluations for *_, evaluations in calls} == {60}


@pytest.mark.parametrize(("strict", "limit"), [(True, 0.5), (False, np.inf)])
def test_arm_pose_search_stays_within_joint_ranges_only_if_they_are_strict(monkeypatch, strict, limit):
    ranges = Ranges(np.full(4, -0.5), np.full(4, 0.5), strict=strict)
    calls, _ = search(monkeypatch, hanging_row(), PLAIN_SPLIT, ranges, first=[np.full(4, 2.0)])
    _, start, (lower, upper), _ = calls[0]
    assert start.tolist() == [min(2.0, limit)] * 4
    assert (lower.tolist(), upper.tolist()) == ([-limit] * 4, [limit] * 4)


@pytest.mark.parametrize(("costs", "chosen"), [((1.019, 1.0, 1.0), 0.1), ((1.021, 1.0, 1.0), 0.2), ((3, 2, 1), 0.3)])
def test_earliest_arm_pose_within_two_percent_of_the_least_cost_is_refined(monkeypatch, costs, chosen):
    poses = [([0.1 * k, 0, 0, 0], cost) for k, cost in enumerate((*costs, *[9.0] * 9), 1)]
    ranges = Ranges(*free(4), strict=False)
    calls, posed = search(monkeypatch, hanging_row(), PLAIN_SPLIT, ranges, first=[np.zeros(4)], solutions=poses)
    residuals, start, *_ = calls[-1]
    np.testing.assert_allclose(start, [chosen, 0, 0, 0])
    np.testing.assert_array_equal(posed.angles, start)
    moved = residuals(start + np.array([0, 0, 0.2, 0])) - residuals(start)
    assert np.abs(moved[9:13]) == pytest.approx([0, 0, 0.05 * 0.2, 0]), "the refinement stays near the chosen pose"


def test_arm_pose_residuals_weigh_bones_elbow_axis_start_pose_and_ranges(monkeypatch):
    ranges = Ranges(np.array([0.2, -1, -1, -1, 0.1]), np.array([1.0, 1, 1, 0.3, 1.0]), strict=False)
    calls, _ = search(monkeypatch, hanging_row(-Y, wrist=True), WRIST_SPLIT, ranges)
    errors = calls[0][0](np.array([0, 0, 0, 0.5, -0.1]))
    upper, fore, elbow, stay, excess, hand = np.split(errors, [3, 6, 9, 14, 19])
    np.testing.assert_allclose(upper, 0, atol=1e-9)
    np.testing.assert_allclose(fore, [np.sin(0.5), 0, 1 - np.cos(0.5)], atol=1e-9)
    np.testing.assert_allclose(elbow, [0, 0.5 * 2, 0], atol=1e-9)  # this range bends it backward
    np.testing.assert_allclose(stay, [0.1 * -0.2, 0, 0, 0.1 * 0.5, 0.1 * 3 * -0.2])
    np.testing.assert_allclose(excess, [0.3 * 0.2, 0, 0, 0.3 * 0.2, 0.3 * 0.2])
    turned = hanging_row(-Y, wrist=True).turned(np.array([0, 0, 0, 0.5, -0.1]))
    away = (turned.centre - turned.anchors[4]) / np.linalg.norm(turned.centre - turned.anchors[4])
    np.testing.assert_allclose(hand, 0.1 * (away + Z), atol=1e-9)


@pytest.mark.parametrize("axis", [Y, -Y])
def test_elbow_without_range_should_bend_so_that_the_forearm_moves_forward(monkeypatch, axis):
    calls, _ = search(monkeypatch, hanging_row(axis), PLAIN_SPLIT, Ranges(*free(4), strict=False))
    np.testing.assert_allclose(calls[0][0](np.zeros(4))[6:9], 0, atol=1e-9)


@pytest.mark.parametrize(
    ("lower", "upper", "strict", "result"),
    [
        (-np.inf, np.inf, False, 7.0 - 2 * np.pi),
        (4.0, 9.0, False, 7.0),
        (9.0, 14.0, False, 7.0 + 2 * np.pi),
        (-np.inf, 9.0, False, 7.0 - 2 * np.pi),
        (-4.0, 9.0, True, 7.0),
    ],
)
def test_arm_angles_are_shifted_by_full_turns_towards_the_middle_of_their_range(
    monkeypatch, lower, upper, strict, result
):
    ranges = Ranges(np.full(4, lower), np.full(4, upper), strict=strict)
    poses = [([7.0, 7.0, 7.0, 7.0], 1.0)] * 12
    _, posed = search(monkeypatch, hanging_row(), PLAIN_SPLIT, ranges, solutions=poses)
    assert posed.angles == pytest.approx([result] * 4)


@pytest.mark.parametrize(("angles", "error"), [([0, 0, 0, 0], 0.0), ([0, 0.2, 0, -0.5], 0.3), ([0, 0.4, 0, -0.3], 0.4)])
def test_error_of_an_arm_pose_is_the_larger_direction_error_of_both_bones(monkeypatch, angles, error):
    ranges = Ranges(*free(4), strict=True)
    _, posed = search(monkeypatch, hanging_row(), PLAIN_SPLIT, ranges, solutions=[(angles, 1.0)] * 12)
    assert posed.off == pytest.approx(error, abs=1e-6)


@pytest.mark.parametrize(
    ("bend", "lower", "upper", "sense"),
    [
        (0.0, -0.9, 1.11, 1.0),
        (0.0, -0.9, 1.09, 0.0),
        (0.0, -1.11, 0.9, -1.0),
        (0.4, -0.5, 0.3, 1.0),
        (-0.4, -0.3, 0.5, -1.0),
        (0.0, 2 * np.pi - 0.5, 2 * np.pi + 1.5, 1.0),
        (0.0, -2 * np.pi - 1.5, -2 * np.pi + 0.5, -1.0),
        (0.0, -1.0, np.inf, 0.0),
    ],
)
@pytest.mark.parametrize("axis", [Y, np.array([0.0, 0.8, 0.6])])
def test_elbow_bends_away_from_the_straight_arm_towards_the_middle_of_its_range(axis, bend, lower, upper, sense):
    row = hanging_row(axis).turned(np.array([0, 0, 0, bend]))
    assert find_elbow_sense(row, PLAIN_SPLIT, lower, upper) == sense
