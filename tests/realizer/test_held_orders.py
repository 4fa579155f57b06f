"""Order and durations of the steps of the trunk between held values."""

import numpy as np
import pytest

from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.planning.quick_plan import compute_quintic_duration
from kinesic.realizer.held import end_warnings, held_ramps, last_held, smooth_step, with_superseded_hinges
from kinesic.realizer.occupancy import Occupancy, Overlay

HINGE_COUNT = 22
NECK = 3  # index of a neck hinge
TILT = 4  # index of another neck hinge
ALL_HINGES = np.ones(HINGE_COUNT, dtype=np.bool_)


def need(turn=None, *, id="a", role="look", begin=1.0, ready=2.0, relax=None, end=2.0, moved=()) -> Occupancy:
    """Return an occupancy that holds a neck rotation [rad] or returns."""
    held = None if turn is None else np.where(np.arange(HINGE_COUNT) == NECK, turn, 0.0)
    moves = np.isin(np.arange(HINGE_COUNT), moved)
    return Occupancy(id, frozenset({role}), moves, begin, ready, end if relax is None else relax, end, held)


@pytest.fixture
def steps(known):
    """Return the steps of the neck: (change [rad], begin [s], end [s])."""

    def of(running=(), performed=(), *, ends: float) -> list[tuple[float, float, float]]:
        base = np.tile(known.robot.skeleton.rest, (100, 1))
        base[:, NECK] += ends
        work = Overlay(base, base, known.robot.skeleton.rest, 0, running, performed)
        return [
            (round(float(ramp.change[NECK]), 9), ramp.begin, ramp.end) for ramp in held_ramps(work, known, known.limits)
        ]

    return of


def test_transition_of_a_held_angle_lasts_at_least_1_5_minimum_durations(known, steps):
    hasty = need(-0.2, begin=1.0, ready=1.001, end=1.001)
    ((_, _, end),) = steps([need(0.3, begin=-3.0, ready=-2.0, end=-2.0)], [hasty], ends=0.3)
    assert end - 1.0 == pytest.approx(1.5 * compute_quintic_duration(0.3, known.limits, NECK))


def test_smooth_step_is_symmetric_between_its_times():
    times = np.array([0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 9.0])
    values = smooth_step(times, 1.0, 3.0)
    assert values[[0, 1, 3, 5, 6]] == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])
    assert values[2] == pytest.approx(1.0 - values[4])
    assert 0.0 < values[2] < 0.25
    assert smooth_step(np.array([2.0, 2.0 + KNOT_INTERVAL]), 2.0, 2.0) == pytest.approx([0.0, 1.0])


def test_posture_listed_last_is_held_if_two_end_at_the_same_time():
    both = [need(0.1, end=4.0), need(0.3, end=4.0)]
    assert last_held("look", both, ALL_HINGES)[NECK] == 0.3
    assert last_held("look", both[::-1], ALL_HINGES)[NECK] == 0.1


def test_gaze_of_a_new_block_removes_the_held_angle_of_the_last_gaze_before_it(steps):
    first = need(0.1, begin=-5.0, ready=-4.0, end=-4.0)
    second = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    for running in ([first, second], [second, first]):
        assert steps(running, [need(-0.2)], ends=0.3) == [(-0.3, 1.0, 2.0)]


def test_running_gaze_ready_at_the_same_time_as_that_of_the_block_is_superseded_by_it(steps):
    running = need(0.3, begin=0.5, ready=2.0, end=2.0)
    assert steps([running], [need(-0.2)], ends=0.3) == [(0.0, 1.0, 2.0), (-0.3, 1.0, 2.0)]


def test_held_angle_without_a_holding_gaze_is_removed_by_the_next_gaze(steps):
    returned = need(None, begin=-3.0, ready=-2.0, end=-1.0)
    assert steps([returned], [need(-0.2)], ends=0.1) == [(-0.1, 1.0, 2.0)]
    assert steps([], [need(-0.2, role="trunk")], ends=0.1) == [(-0.1, 1.0, 2.0)]


def test_gazes_of_a_block_are_applied_in_order_of_time(steps):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    late, soon = need(0.2, begin=5.0, ready=7.0, end=7.0), need(-0.2)
    assert steps([running], [late, soon], ends=0.3) == [(-0.3, 1.0, 2.0), (0.0, 5.0, 7.0)]


def test_correction_of_a_running_gaze_that_is_ready_last_starts_with_the_first_new_gaze(steps):
    running = need(0.3, begin=0.5, ready=5.0, end=5.0)
    performed = [need(0.1, begin=3.0, ready=4.0, end=4.0), need(-0.2)]
    assert steps([running], performed, ends=0.3) == [(0.0, 1.0, 2.0), (0.0, 3.0, 4.0), (-0.1, 1.0, 5.0)]


def test_gaze_shifts_with_equal_ready_times_are_ordered_by_their_relax_times(steps):
    first = need(None, begin=1.0, ready=2.0, relax=3.0, end=9.0)
    second = need(-0.2, begin=1.0, ready=2.0, relax=4.0, end=4.0)
    expected = steps([], [first, second], ends=0.0)
    assert steps([], [second, first], ends=0.0) == expected
    assert len(expected) == 2


def test_new_gaze_also_occupies_the_trunk_hinges_of_earlier_held_gazes(known):
    arm = known.robot.joints("l_arm")[0]
    others = [need(0.1, moved=(NECK, arm)), need(None, moved=(TILT,)), need(0.1, role="trunk", moved=(TILT,))]
    (entry,) = with_superseded_hinges([need(None, moved=(5,))], others, known.robot)
    assert np.flatnonzero(entry.hinges).tolist() == [NECK, 5]


def test_warning_of_an_unreached_held_posture_names_the_farthest_joint(known):
    controls = np.tile(known.robot.skeleton.rest, (9, 1))
    controls[-1, NECK] += 0.3 - np.radians(3.0)
    controls[-1, TILT] -= np.radians(12.4)
    ((id, text),) = end_warnings(controls, [need(0.1, id="b")], [need(0.2, role="trunk", end=9.0)], known.robot)
    assert id == "b"
    assert text.startswith("ends 12 deg off its held posture")
    assert f"{known.robot.skeleton.names[TILT]} would exceed" in text
    controls[-1, TILT] = known.robot.skeleton.rest[TILT]
    controls[-1, NECK] += np.radians(2.1)
    assert end_warnings(controls, [need(0.1, id="b")], [need(0.2, role="trunk", end=9.0)], known.robot) == []


def test_arm_away_from_the_held_posture_causes_no_warning(known):
    controls = np.tile(known.robot.skeleton.rest, (9, 1))
    controls[-1, NECK] += 0.1
    controls[-1, known.robot.joints("l_arm")[0]] += 1.0
    assert end_warnings(controls, [need(0.1)], [], known.robot) == []
