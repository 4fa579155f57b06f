"""Steps of the trunk between sums of held values."""

import numpy as np
import pytest

from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.planning.quick_plan import compute_quintic_duration
from kinesic.realizer.held import (
    HELD_POSTURE_TOLERANCE,
    STEP_DURATION_FACTOR,
    HeldRamp,
    add_step_to_held_posture,
    end_warnings,
    held_posture,
    held_ramps,
    last_held,
    offset_to_held_posture,
    trunk_hinges,
    with_superseded_hinges,
)
from kinesic.realizer.occupancy import MOTION_TOLERANCE, Occupancy, Overlay, arm_hinges

KNOT_COUNT = 100  # length of the test motions


@pytest.fixture
def hinges(known):
    return trunk_hinges(known.robot)


@pytest.fixture
def offset(known, hinges):
    """Return an offset with a neck rotation [rad] and arbitrary arms."""
    neck = known.robot.joints("neck")[0]

    def of(turn: float) -> np.ndarray:
        result = np.where(hinges, 0.0, 9.0)
        result[neck] = turn
        return result

    return of


@pytest.fixture
def need(known, offset):
    """Return an occupancy that holds a neck rotation [rad] or returns."""

    def of(turn=None, *, id="a", role="look", begin=1.0, ready=2.0, relax=None, end=2.0, moved=()) -> Occupancy:
        moving = np.zeros(len(known.robot.skeleton.hinges), dtype=bool)
        moving[list(moved)] = True
        relax = end if relax is None else relax
        held = None if turn is None else offset(turn)
        return Occupancy(id, frozenset({role}), moving, begin, ready, relax, end, held)

    return of


@pytest.fixture
def steps(known):
    """Return the steps of the neck: (change [rad], begin [s], end [s])."""

    def of(running=(), performed=(), *, ends: float) -> list[tuple[float, float, float]]:
        neck = known.robot.joints("neck")[0]
        base = np.tile(known.robot.skeleton.rest, (KNOT_COUNT, 1))
        base[:, neck] += ends
        work = Overlay(base, base, known.robot.skeleton.rest, 0, running, performed)
        result = held_ramps(work, known, known.limits)
        for ramp in result:
            assert not np.delete(ramp.change, neck).any()
        return [(round(float(ramp.change[neck]), 9), ramp.begin, ramp.end) for ramp in result]

    return of


@pytest.fixture
def least(known):
    """Return the minimum duration [s] of a neck step."""
    return lambda turn: (
        STEP_DURATION_FACTOR * compute_quintic_duration(turn, known.limits, known.robot.joints("neck")[0])
    )


def motion(known, turn: float = 0.0) -> np.ndarray:
    controls = np.tile(known.robot.skeleton.rest, (KNOT_COUNT, 1))
    controls[:, known.robot.joints("neck")[0]] += turn
    return controls


def test_trunk_hinges_exclude_the_arms(known, hinges):
    arms = {hinge for role in ("l_hand", "r_hand") for hinge in arm_hinges(role, known.robot)}
    assert {*np.flatnonzero(~hinges)} == arms
    assert hinges[[*known.robot.joints("torso"), *known.robot.joints("neck")]].all()


def test_held_trunk_posture_is_the_sum_of_the_last_gaze_and_last_posture_shift(known, hinges, need):
    neck = known.robot.joints("neck")[0]
    looks = [need(0.3, end=4.0), need(0.1, end=2.0), need(None, end=9.0), need(0.2, role="trunk", end=6.0)]
    assert last_held("look", looks, hinges)[neck] == 0.3
    assert last_held("trunk", looks, hinges)[neck] == 0.2
    assert not last_held("sign", looks, hinges).any()
    posture = held_posture(looks, known.robot) - known.robot.skeleton.rest
    assert posture[neck] == pytest.approx(0.5)
    assert not np.delete(posture, neck).any()
    far = held_posture([need(50.0)], known.robot)
    assert far[neck] == known.robot.skeleton.upper[neck]
    assert held_posture([need(-50.0)], known.robot)[neck] == known.robot.skeleton.lower[neck]


def test_missing_part_of_a_held_trunk_posture_is_added_during_the_last_holding_behaviour(known, need):
    neck = known.robot.joints("neck")[0]
    controls = motion(known, 0.1)
    holding = [need(0.1, begin=0.1, ready=0.2, end=0.2), need(0.3, role="trunk", begin=0.5, ready=1.0, end=1.0)]
    assert offset_to_held_posture(controls, holding, known.robot)[neck] == pytest.approx(0.3)
    led = add_step_to_held_posture(controls, [*holding, need(None, end=9.0)], known.robot)
    early = round(0.5 / KNOT_INTERVAL) + 3
    np.testing.assert_allclose(led[:early], controls[:early], atol=1e-12)
    late = round(1.0 / KNOT_INTERVAL) + 3
    np.testing.assert_allclose(led[late:, neck] - controls[late:, neck], 0.3)
    middle = round(0.75 / KNOT_INTERVAL) + 3
    assert led[middle, neck] - controls[middle, neck] == pytest.approx(0.15, abs=0.03)


def test_motion_ending_in_the_held_posture_is_unchanged(known, need):
    controls = motion(known, 0.3)
    assert add_step_to_held_posture(controls, [need(0.3)], known.robot) is controls
    controls[-1, known.robot.joints("neck")[0]] += MOTION_TOLERANCE / 2
    assert add_step_to_held_posture(controls, [need(0.3)], known.robot) is controls


def test_motion_without_holding_behaviour_is_shifted_to_rest(known, need):
    led = add_step_to_held_posture(motion(known, 0.3), [need(None)], known.robot)
    np.testing.assert_allclose(led, motion(known), atol=1e-12)


def test_offset_to_a_held_posture_does_not_include_arm_hinges(known):
    controls = motion(known)
    controls[:, list(arm_hinges("l_hand", known.robot))] += 0.2
    assert not offset_to_held_posture(controls, (), known.robot).any()


def test_new_gaze_also_occupies_the_trunk_hinges_of_the_superseded_gaze(known, need):
    (neck, tilt, *_), torso, arm = (
        known.robot.joints("neck"),
        known.robot.joints("torso")[0],
        known.robot.joints("l_arm")[0],
    )
    earlier = [need(0.1, moved=(neck, arm)), need(None, moved=(tilt,)), need(0.1, role="trunk", moved=(torso,))]
    look, nod = with_superseded_hinges(
        [need(0.2, moved=(tilt,)), need(role="sign", moved=(tilt,))], earlier, known.robot
    )
    assert {*np.flatnonzero(look.hinges)} == {neck, tilt}
    assert {*np.flatnonzero(nod.hinges)} == {tilt}
    (alone,) = with_superseded_hinges([need(0.2, moved=(arm,))], (), known.robot)
    assert {*np.flatnonzero(alone.hinges)} == {arm}


@pytest.mark.parametrize(("share", "warned"), [(0.99, False), (1.01, True)])
def test_warning_of_an_unreached_held_posture_names_the_last_holding_behaviour(known, need, share, warned):
    controls = motion(known, 0.5 - share * HELD_POSTURE_TOLERANCE)
    performed = [need(0.1, id="first", end=1.0), need(0.3, id="last", end=3.0), need(None, id="back", end=9.0)]
    other = [need(0.2, role="trunk", id="other", end=5.0)]
    result = end_warnings(controls, performed, other, known.robot)
    assert [id for id, _ in result] == ["last"] * warned
    for _, text in result:
        assert text.startswith("ends 1 deg off its held posture")
        assert f"{known.robot.skeleton.names[known.robot.joints('neck')[0]]} would exceed its range" in text


def test_block_without_holding_behaviour_gets_no_warning_of_an_unreached_posture(known, need):
    assert end_warnings(motion(known, 0.5), [need(None)], [need(0.2)], known.robot) == []


def test_sampled_trunk_transition_is_shifted_by_the_knots_before_the_motion_start(known):
    ramp = HeldRamp(np.array([2.0, 0.0]), begin=2 * KNOT_INTERVAL, end=4 * KNOT_INTERVAL)
    np.testing.assert_allclose(ramp.at(8, lead=3)[:, 0], [0, 0, 0, 0, 0, 0, 1, 2], atol=1e-12)
    assert not ramp.at(8, lead=3)[:, 1].any()
    sudden = HeldRamp(np.ones(1), begin=KNOT_INTERVAL, end=KNOT_INTERVAL)
    np.testing.assert_allclose(sudden.at(4, lead=0)[:, 0], [0, 0, 1, 1], atol=1e-12)


def test_later_gaze_removes_the_held_angle_of_the_earlier_one(steps, need, least):
    running, coming = need(0.3, begin=-3.0, ready=-2.0, end=-2.0), need(-0.2)
    assert steps([running], [coming], ends=0.3) == [(-0.3, 1.0, 2.0)]
    hasty = need(-0.2, begin=1.0, ready=1.001, end=1.001)
    assert steps([running], [hasty], ends=0.3) == [(-0.3, 1.0, pytest.approx(1.0 + least(0.3)))]


def test_nods_and_posture_shifts_keep_the_held_gaze_angle(steps, need):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    assert steps([running], [need(role="sign")], ends=0.3) == []
    assert steps([running], [need(0.1, role="trunk")], ends=0.3) == [(0.0, 1.0, 2.0)]


def test_held_angle_reduced_by_limits_is_removed_by_only_one_later_behaviour(steps, need):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    assert steps([running], [need(-0.2)], ends=0.25) == [(-0.25, 1.0, 2.0)]
    both = [need(-0.2), need(0.1, role="trunk")]
    assert steps([running], both, ends=0.25) == [(-0.25, 1.0, 2.0), (0.0, 1.0, 2.0)]
    assert steps([], [need(-0.2)], ends=0.1) == [(-0.1, 1.0, 2.0)]


def test_temporary_gaze_replaces_a_held_gaze_and_restores_it(steps, need, least):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    gaze = need(None, begin=1.0, ready=2.0, relax=4.0, end=6.0)
    assert steps([running], [gaze], ends=0.3) == [(-0.3, 1.0, 2.0), (0.3, 4.0, 6.0)]
    brief = need(None, begin=1.0, ready=2.0, relax=4.0, end=4.001)
    back = steps([running], [brief], ends=0.3)[1]
    assert back == (0.3, pytest.approx(4.001 - least(0.3)), 4.001)


def test_gaze_that_starts_before_another_gaze_has_returned_replaces_its_return(steps, need):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    gaze = need(None, begin=1.0, ready=2.0, relax=4.0, end=6.0)
    soon, later = need(-0.2, begin=5.0, ready=7.0, end=7.0), need(-0.2, begin=6.0, ready=8.0, end=8.0)
    assert steps([running], [gaze, soon], ends=0.3) == [(-0.3, 1.0, 2.0), (0.0, 5.0, 7.0)]
    assert steps([running], [gaze, later], ends=0.3) == [(-0.3, 1.0, 2.0), (0.3, 4.0, 6.0), (-0.3, 6.0, 8.0)]


def test_held_angle_of_a_new_gaze_is_removed_by_a_running_gaze_that_is_ready_later(steps, need):
    late = need(0.3, begin=0.5, ready=5.0, end=5.0)
    result = steps([late], [need(-0.2, begin=1.0, ready=2.0, end=2.0)], ends=0.3)
    assert result == [(0.0, 1.0, 2.0), (0.2, 1.0, 5.0)]
    late = need(0.3, begin=3.0, ready=5.0, end=5.0)
    result = steps([late], [need(-0.2, begin=1.0, ready=2.0, end=2.0)], ends=0.3)
    assert result == [(0.0, 1.0, 2.0), (0.2, 3.0, 5.0)]


def test_running_gaze_ready_after_a_new_gaze_ends_at_its_angle_reduced_by_joint_limits(steps, need):
    before, late = need(0.1, begin=-3.0, ready=-2.0, end=-2.0), need(0.3, begin=3.0, ready=5.0, end=5.0)
    result = steps([before, late], [need(-0.2, begin=1.0, ready=2.0, end=2.0)], ends=0.25)
    assert result == [(-0.1, 1.0, 2.0), (pytest.approx(0.3), 3.0, 5.0)]


def test_held_angle_of_a_new_gaze_is_suspended_during_a_temporary_gaze_scheduled_before_it(steps, need):
    gaze = need(None, begin=3.0, ready=4.0, relax=5.0, end=7.0)
    result = steps([gaze], [need(-0.2, begin=1.0, ready=2.0, end=2.0)], ends=0.0)
    assert result == [(0.0, 1.0, 2.0), (0.2, 3.0, 4.0), (-0.2, 5.0, 7.0)]
