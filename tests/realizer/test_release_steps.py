"""Steps of the removal of an interrupted block, on small motions."""

import numpy as np
import pytest

from kinesic.body.dynamics import Clearance
from kinesic.motion.double_s import least_stop
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.clearance import MIN_LAG_RESERVE
from kinesic.planning.quick_plan import compute_quintic_duration
from kinesic.realizer import release as module
from kinesic.realizer.occupancy import Occupancy, arm_hinges
from kinesic.realizer.release import (
    _minimum_times,
    _rejoin_arms,
    _release_from,
    certified_motion,
    motion_without_block,
    release_motion,
)

HINGE_COUNT = 22
NECK = 3  # index of a neck hinge whose rest angle is 0
NO_HINGES = np.zeros(HINGE_COUNT, dtype=np.bool_)
START = 50.0  # [s] clock time at which the running motion starts


def motion(count: int, *, angle: float = 0.0, start: float = 0.0) -> Trajectory:
    return Trajectory(np.full((count, HINGE_COUNT), angle), 0.25, start)


def use(id: str, *roles: str, begin=0.3, ready=0.5, offset=None) -> Occupancy:
    return Occupancy(id, frozenset(roles), NO_HINGES, begin, ready, 0.6, 0.7, offset)


def test_release_times_are_relative_to_the_start_of_the_running_motion(known, monkeypatch):
    calls = []

    def release_from(*given):
        calls.append(given)
        return "released" if len(calls) == 2 else None

    monkeypatch.setattr(module, "_release_from", release_from)
    running, layer = motion(200, start=START), motion(9)
    others = [use("o", "look", begin=START + 0.3)]
    assert release_motion(running, START + 0.195, NO_HINGES, known, layer=layer, others=others) == "released"
    assert [call[1] for call in calls] == [20, 30]
    for run, _, hinges, setup, below, local in calls:
        assert (run, setup, below) == (running, known, layer)
        assert hinges is NO_HINGES
        assert [entry.begin for entry in local] == pytest.approx([0.3])


@pytest.fixture
def tries(monkeypatch):
    """Record calls of the transition search, with durations [s] and results."""
    calls, times, ends = [], np.zeros(HINGE_COUNT), []

    def cross_over(current, goal, knots, _limits, hinge):
        calls.append((hinge, *knots, len(current), current[-1], len(goal), goal[-1]))
        return None if knots[1] - knots[0] < 30 else np.full(len(current), 0.5 + hinge)

    monkeypatch.setattr(module, "cross_over", cross_over)
    monkeypatch.setattr(module, "_minimum_times", lambda *_: times)
    monkeypatch.setattr(module, "motion_without_block", lambda current, *_: np.full(current.shape, -1.0))
    monkeypatch.setattr(module, "_rejoin_arms", lambda *given: ends.append(given))
    monkeypatch.setattr(module, "certified_motion", lambda *given: given)
    return calls, times, ends


def freed(*hinges: int) -> np.ndarray:
    return np.isin(np.arange(HINGE_COUNT), hinges)


def test_release_of_no_hinges_leaves_the_motion_unchanged(known, tries):
    running = motion(60)
    assert _release_from(running, 20, NO_HINGES, known, None, ()) is running
    assert tries[0] == []


def test_released_hinges_return_together_in_the_first_feasible_duration(known, tries):
    calls, times, ends = tries
    times[[NECK, 5]] = 0.16, 0.9
    running, others = motion(60), [use("now", "r_hand", ready=0.2), use("soon", "r_hand", ready=0.201)]
    back, run, knot, setup = _release_from(running, 20, freed(2, NECK), known, None, others)
    assert [call[:3] for call in calls] == [(2, 20, 44), (2, 20, 50), (NECK, 20, 50)]
    assert {call[3:] for call in calls} == {(60, 0.0, 60, -1.0)}
    assert (run, knot, setup) == (running, 20, known)
    np.testing.assert_array_equal(back[:, [2, NECK]], [[2.5, 3.5]] * 60)
    assert not np.delete(back, [2, NECK], axis=1).any()
    ((joined, whole, land, later, joining_setup),) = ends
    assert joined is back
    assert not whole.any()
    assert (land, joining_setup) == (50, known)
    assert [entry.behaviour for entry in later] == ["soon"]


@pytest.mark.parametrize(
    ("least", "pieces"),
    [
        (0.001, [3, 4, 5, 7, 9, 12, 15, 19, 24, 30, 38, 48, 60, 75, 94, 118, 148, 185, 232, 290, 363]),
        (0.66, [99, 124, 155, 194, 243, 304, 380]),
        (0.661, [100, 125, 157, 197, 247, 309, 387]),
        (2.665, [400]),
        (2.67, []),
    ],
)
def test_return_durations_are_tried_from_1_5_minimum_durations_in_steps_of_a_quarter_up_to_4_seconds(
    known, tries, monkeypatch, least, pieces
):
    calls, times, _ = tries
    times[NECK] = least
    monkeypatch.setattr(module, "join_columns", lambda columns: list(columns) and None)
    assert _release_from(motion(60), 20, freed(NECK), known, None, ()) is None
    assert [last - first for _, first, last, *_ in calls] == pieces
    assert [call[3] for call in calls] == [max(60, 20 + count + 3) for count in pieces]
    assert [call[5] for call in calls] == [call[3] for call in calls]


def test_motion_that_has_ended_is_released_from_its_last_posture(known, tries):
    tries[1][NECK] = 0.3
    back, *_ = _release_from(motion(10, angle=0.2), 50, freed(NECK), known, None, ())
    assert len(back) == 50 + 45 + 3
    np.testing.assert_array_equal(np.delete(back, NECK, axis=1), 0.2)


def test_minimum_return_time_suffices_for_the_largest_difference_at_three_control_points(known):
    current, after = np.zeros((30, HINGE_COUNT)), np.zeros((30, HINGE_COUNT))
    after[20, 0], after[22, 1], after[21, 2] = 0.5, -0.5, 0.5
    after[19, NECK] = after[23, NECK] = 0.5
    times = _minimum_times(current, after, 20, known.limits)
    expected = [compute_quintic_duration(0.5, known.limits, hinge) for hinge in range(3)]
    np.testing.assert_allclose(times[:3], expected)
    np.testing.assert_allclose(times[3:], compute_quintic_duration(0.0, known.limits, NECK), atol=1e-9)
    far = _minimum_times(np.full((30, HINGE_COUNT), 0.3), np.full((30, HINGE_COUNT), 0.1), 20, known.limits)
    assert far[NECK] == pytest.approx(compute_quintic_duration(0.2, known.limits, NECK))


def test_minimum_return_time_includes_the_stop_from_velocity_and_acceleration(known):
    moving = np.zeros((30, HINGE_COUNT))
    moving[20:23, NECK] = 0.01, 0.011, 0.013
    limits = known.limits
    stop = least_stop(0.15, 10.0, limits.acceleration[NECK], limits.jerk[NECK])
    assert _minimum_times(moving, moving, 20, limits)[NECK] == pytest.approx(float(stop))


def test_motion_without_offsets_and_other_blocks_is_the_rest_posture(known):
    rest = known.robot.skeleton.rest
    np.testing.assert_array_equal(motion_without_block(motion(9).controls, None, (), known.robot), [rest] * 9)


@pytest.mark.parametrize("count", [20, 40])
def test_motion_without_a_block_lacks_its_trunk_offsets_and_holds_the_last_arm_posture(known, count):
    robot, arm = known.robot, arm_hinges("r_hand", known.robot)[1]
    layer, current = motion(count).controls, np.tile(robot.skeleton.rest, (30, 1))
    layer[10:15, [NECK, arm]] = 0.1
    layer[15:, arm] = 0.05
    current[:, [NECK, arm]] += 0.3
    current[5, arm] += 0.4
    current[-1, arm] += 0.1
    current[:20, 0] = 0.02
    after = motion_without_block(
        current, Trajectory(layer, 0.0), [use("o", "look", offset=0.3 * np.eye(22)[NECK])], robot
    )
    assert len(after) == 30
    np.testing.assert_allclose(after[:, NECK], np.where((np.arange(30) < 10) | (np.arange(30) >= 15), 0.3, 0.2))
    np.testing.assert_allclose(after[:, arm], robot.skeleton.rest[arm] + 0.35)
    np.testing.assert_allclose(after[:, 0], current[:, 0])


def test_motion_without_a_block_ends_in_the_posture_held_by_other_blocks(known):
    current, layer = motion(30).controls, motion(30)
    held = [use("o", "look", offset=0.2 * np.eye(22)[NECK])]
    after = motion_without_block(current, layer, held, known.robot)
    np.testing.assert_allclose(after[:, NECK], 0.2)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_motion_without_a_block_exceeds_joint_ranges_no_more_than_the_running_motion(known, sign):
    skeleton = known.robot.skeleton
    end = skeleton.upper[NECK] if sign > 0 else skeleton.lower[NECK]
    current, layer = motion(30).controls, motion(30)
    current[:, NECK] = np.where(np.arange(30) < 10, end + 0.1 * sign, 0.0)
    layer.controls[:20, NECK] = -sign
    layer.controls[12:15, NECK] = -4.0 * sign
    after = motion_without_block(current, layer, (), known.robot)
    np.testing.assert_allclose(after[:10, NECK], end + 0.1 * sign)
    np.testing.assert_allclose(after[12:15, NECK], end)
    np.testing.assert_allclose(after[10:12, NECK], sign)


@pytest.fixture
def rejoins(monkeypatch):
    """Record knots at which arms rejoin, except those of given hinges."""
    calls, failing = [], set()

    def cross_over(back, current, knots, _limits, hinge):
        calls.append((hinge, *knots, back[0], current[0]))
        return None if hinge in failing else np.full(len(back), 0.5)

    monkeypatch.setattr(module, "cross_over", cross_over)
    return calls, failing


@pytest.mark.parametrize(("knot", "leave"), [(20, 30), (35, 35)])
def test_resting_arm_rejoins_its_next_behaviour(known, rejoins, knot, leave):
    back, current = motion(60).controls, motion(60, angle=1.0).controls
    others = [
        use("late", "r_hand", begin=0.1, ready=0.9),
        use("g", "r_hand", begin=0.306, ready=0.507),
        use("n", "sign"),
    ]
    _rejoin_arms(back, current, knot, others, known)
    arm = list(arm_hinges("r_hand", known.robot))
    assert rejoins[0] == [(hinge, leave, 50, 0.0, 1.0) for hinge in arm]
    np.testing.assert_array_equal(back[:, arm], 0.5)
    assert not np.delete(back, arm, axis=1).any()


def test_arm_with_a_hinge_that_cannot_rejoin_keeps_the_running_motion(known, rejoins):
    back, current = motion(60).controls, motion(60, angle=1.0).controls
    arm = list(arm_hinges("l_hand", known.robot))
    rejoins[1].add(arm[2])
    _rejoin_arms(back, current, 20, [use("g", "l_hand")], known)
    np.testing.assert_array_equal(back[:, arm], 1.0)
    assert not np.delete(back, arm, axis=1).any()


@pytest.fixture
def checks(monkeypatch):
    """Record corrections of hinges, and set the smallest distance [m]."""
    calls, distance, seen = [], [1.0], []

    def keep_limits(column, first, last, _limits, hinge):
        calls.append((hinge, first, last))
        return np.full(len(column), 0.2)

    def scan_clearance(trajectory, _distances):
        seen.append(trajectory.controls)
        return np.zeros(2), Clearance(np.array([1.0, distance[0]]), [("a", "b")] * 2)

    monkeypatch.setattr(module, "keep_limits", keep_limits)
    monkeypatch.setattr(module, "scan_clearance", scan_clearance)
    return calls, distance, seen


@pytest.mark.parametrize(("knot", "corrections"), [(24, [(NECK, 24, 57)]), (25, [])])
def test_returning_hinge_is_corrected_only_if_it_exceeds_limits_after_the_release_time(
    known, checks, knot, corrections
):
    """The neck jumps in the knot intervals 22 to 24."""
    calls, _, seen = checks
    controls = np.tile(known.robot.skeleton.rest, (60, 1))
    controls[25:, NECK] = 1.5 * known.limits.jerk[NECK] * KNOT_INTERVAL**3
    released = certified_motion(controls, motion(9, start=START), knot, known)
    assert calls == corrections
    assert (released.zero, released.start) == (0.25, START)
    assert len(released.controls) == (4 if corrections else 28)
    np.testing.assert_array_equal(released.controls[-1, NECK], 0.2 if corrections else controls[-1, NECK])
    np.testing.assert_array_equal(seen[0], released.controls[max(0, min(knot, len(released.controls) - 7)) :])


def test_return_to_rest_that_cannot_be_corrected_is_rejected(known, checks, monkeypatch):
    monkeypatch.setattr(module, "keep_limits", lambda *_: None)
    controls = np.tile(known.robot.skeleton.rest, (60, 1))
    controls[25:, NECK] = 0.5
    assert certified_motion(controls, motion(9), 0, known) is None


@pytest.mark.parametrize(("spare", "is_rejected"), [(0.0, False), (-1e-9, True), (-1.0, True)])
def test_return_to_rest_below_the_required_clearance_is_rejected(known, checks, spare, is_rejected):
    checks[1][0] = known.robot.min_clearance + MIN_LAG_RESERVE + spare
    controls = np.tile(known.robot.skeleton.rest, (60, 1))
    assert (certified_motion(controls, motion(9), 0, known) is None) is is_rejected
