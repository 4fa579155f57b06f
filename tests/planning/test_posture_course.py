from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion.keys import KeyPassage
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.posture_course import MIN_KEY_INTERVAL, SCAN_RATE

from .courses import ARM_IN_FRONT, ARM_RAISED, CROSSING_COURSE, LEFT_JOINTS, REST_ANGLES, RIGHT_JOINTS, course, key


def test_moving_a_hold_key_moves_all_keys_of_the_hold():
    held = course(key(0.0), key(1.0, right=ARM_IN_FRONT), key(2.0, right=ARM_IN_FRONT), key(3.0))
    aside = held.at(1.0)
    aside[RIGHT_JOINTS] += 0.05
    moved = held.moved(1, aside, tuple(RIGHT_JOINTS))
    np.testing.assert_array_equal(moved.postures[1].angles, moved.postures[2].angles)
    np.testing.assert_array_equal(moved.postures[3].angles, REST_ANGLES)


def test_new_detour_key_has_an_interpolated_requested_time():
    late = replace(CROSSING_COURSE, planned=sealed([0.0, 1.5, 3.0, 4.0]))
    longer = late.extended(2.25, late.at(2.25), tuple(LEFT_JOINTS))
    (added,) = set(longer.postures) - set(late.postures)
    assert added.time == pytest.approx(1.5)
    assert longer.planned[list(longer.postures).index(added)] == 2.25
    assert [joint for joint, keyed in enumerate(added.keyed) if keyed] == LEFT_JOINTS


def test_requested_time_of_a_new_key_depends_only_on_keys_of_its_arm():
    both = course(key(0.0), key(1.0, left=ARM_IN_FRONT), key(2.0, right=ARM_IN_FRONT), key(3.0))
    late = replace(both, planned=sealed([0.0, 1.5, 1.6, 3.0]))
    (added,) = set(late.extended(2.4, late.at(2.4), tuple(LEFT_JOINTS)).postures) - set(late.postures)
    assert added.time == pytest.approx(2.2)


def synced(posture, name):
    """Return a key with a sync point."""
    return replace(posture, syncs=((name, "stroke"),))


def test_detour_search_does_not_move_keys_of_a_stroke_or_its_hold():
    made = course(
        key(0.0),
        synced(key(1.0, right=ARM_IN_FRONT), "g"),
        key(1.5, right=ARM_RAISED),
        key(2.0, right=ARM_IN_FRONT),
        key(2.5, right=REST_ANGLES[RIGHT_JOINTS]),
        key(3.0),
    )
    assert made.detours(1.7, [tuple(RIGHT_JOINTS)]) == {2}  # the key at 2.0 is a hold of the stroke
    assert made.detours(1.2, [tuple(RIGHT_JOINTS)]) == {2}
    assert made.detours(0.0, [tuple(RIGHT_JOINTS)]) <= {0}


def test_colliding_keys_are_the_neighbours_of_a_time_with_missing_clearance():
    arm = tuple(RIGHT_JOINTS)
    made = course(key(0.0), key(1.0, right=ARM_IN_FRONT), key(2.0, right=ARM_RAISED), key(3.0))
    deficits = np.zeros(len(made.samples()))
    assert made.colliding_keys(1.5, [arm], deficits, min_deficit=0.002) == set()
    deficits[round((2.0 + made.motion.zero) * SCAN_RATE)] = 0.01
    assert made.colliding_keys(1.5, [arm], deficits, min_deficit=0.002) == {2}
    assert (
        made.colliding_keys(0.5, [arm], deficits, min_deficit=0.002) == set()
    )  # the key at 2.0 is not next to this time


@pytest.mark.parametrize(("away", "is_near"), [(0.0, True), (0.9, True), (1.1, False)])
def test_arm_key_within_the_minimum_interval_of_a_time_is_found(away, is_near):
    only_left = course(key(0.0), key(1.0, left=ARM_IN_FRONT), key(2.0, right=ARM_IN_FRONT), key(3.0))
    for side in (-1, 1):
        time = 1.0 + side * away * MIN_KEY_INTERVAL
        assert only_left.near(tuple(LEFT_JOINTS), time) == (1 if is_near else None)
        assert only_left.near(tuple(RIGHT_JOINTS), time) is None


def test_requested_key_times_are_distinct_and_ordered():
    longer = CROSSING_COURSE
    for time, arm in ((1.5, LEFT_JOINTS), (1.5, RIGHT_JOINTS), (0.5, LEFT_JOINTS)):
        longer = longer.extended(time, longer.at(time), tuple(arm))
    times = [posture.time for posture in longer.postures]
    assert times == sorted(set(times))
    assert len(times) == len(CROSSING_COURSE.postures) + 3
    assert np.all(np.diff(longer.planned) >= 0.0)


def test_arms_are_grouped_only_if_they_have_equal_key_times():
    arms = [tuple(LEFT_JOINTS), tuple(RIGHT_JOINTS)]
    assert CROSSING_COURSE.group_by_key_times(arms) == [(*LEFT_JOINTS, *RIGHT_JOINTS)]
    apart = course(key(0.0), key(1.0, left=ARM_IN_FRONT), key(3.0))
    assert apart.group_by_key_times(arms) == arms


def test_moving_an_arm_keeps_other_arm_and_postures():
    moved = CROSSING_COURSE.moved(1, CROSSING_COURSE.postures[1].angles + 0.1, tuple(LEFT_JOINTS))
    for k, (before, after) in enumerate(zip(CROSSING_COURSE.postures, moved.postures, strict=True)):
        np.testing.assert_allclose(after.angles[LEFT_JOINTS] - before.angles[LEFT_JOINTS], 0.1 if k == 1 else 0.0)
        np.testing.assert_array_equal(after.angles[RIGHT_JOINTS], before.angles[RIGHT_JOINTS])


def test_existing_detour_keys_before_and_after_a_time_are_found():
    made = course(
        key(0.0),
        key(1.0, right=ARM_RAISED),
        key(2.0, right=ARM_IN_FRONT),
        synced(key(2.5, right=REST_ANGLES[RIGHT_JOINTS]), "g"),
        key(3.0),
    )
    assert made.detours(1.5, [tuple(RIGHT_JOINTS)]) == {1, 2}
    assert made.detours(2.2, [tuple(RIGHT_JOINTS)]) == {2}
    assert made.detours(1.5, []) == set()


def test_overshoot_is_removed_only_from_keys_adjacent_to_a_time():
    def lively(time):
        return replace(key(time, left=ARM_IN_FRONT), passages=(KeyPassage(swing=1.0),) * len(REST_ANGLES))

    made = course(key(0.0), *map(lively, (0.5, 1.0, 2.0, 3.0, 4.0)), key(5.0))
    calm = made.reduce_overshoot(2.5)
    assert [bool(posture.passages) and posture.passages[LEFT_JOINTS[0]].swing for posture in calm.postures] == [
        False,
        1.0,
        1.0,
        0.0,
        0.0,
        1.0,
        False,
    ]
    assert all(calm.postures[3].passages[joint] == KeyPassage(swing=1.0) for joint in RIGHT_JOINTS)


def test_posture_course_follows_a_trajectory_with_another_start_time():
    early = course(key(-0.4), key(0.6, left=ARM_IN_FRONT), key(1.6))
    speed, zero = 0.2, 0.7  # [rad/s], [s]
    block_times = KNOT_INTERVAL * np.arange(-1.0, 299.0) - zero  # a B-spline follows control points on a line
    controls = sealed(np.repeat(speed * block_times[:, None], len(REST_ANGLES), axis=1))
    followed = early.with_deviation(Trajectory(controls, zero))
    for time in (-0.4, 0.3, 1.5):
        assert followed.at(time) == pytest.approx(np.full(len(REST_ANGLES), speed * time))
