from dataclasses import replace

import numpy as np
import pytest

from kinesic.motion.keys import KeyPassage
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning import detour
from kinesic.planning.detour import ClearPostures, add_detours
from kinesic.planning.posture_course import MIN_KEY_INTERVAL
from kinesic.sim.distances import CapsuleDistances

from ..performances import ROBOT
from .courses import (
    ARM_IN_FRONT,
    ARM_RAISED,
    CAPSULE_DISTANCES,
    LEFT_JOINTS,
    MIN_CLEARANCE,
    REST_ANGLES,
    RIGHT_JOINTS,
    course,
    key,
    least,
)


def test_collision_free_motion_has_no_detour():
    clear = course(key(0.0), key(1.0, right=ARM_IN_FRONT), key(2.0))
    assert least(clear) >= MIN_CLEARANCE
    assert add_detours(clear, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE) is clear


def test_detours_separate_hands_that_pass_the_same_position():
    together = course(
        key(0.0), key(1.0, left=ARM_IN_FRONT), key(1.4, right=ARM_IN_FRONT), key(1.8, left=ARM_RAISED), key(3.0)
    )
    assert least(together) < 0
    led = add_detours(together, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE)
    assert least(led) >= MIN_CLEARANCE - 1e-3


def test_detours_keep_arm_keys_apart_and_in_order():
    together = course(
        key(0.0), key(1.0, left=ARM_IN_FRONT), key(1.4, right=ARM_IN_FRONT), key(1.8, left=ARM_RAISED), key(3.0)
    )
    led = add_detours(together, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE)
    for arm in (LEFT_JOINTS, RIGHT_JOINTS):
        own = [k for k, posture in enumerate(led.postures) if posture.keyed[arm[0]]]
        assert np.diff(led.planned[own]).min() >= MIN_KEY_INTERVAL - 1e-9
        assert np.diff([led.postures[k].time for k in own]).min() > 0
    assert len({posture.time for posture in led.postures}) == len(led.postures)


def test_detour_search_checks_collisions_only_in_changed_motion_samples(monkeypatch):
    """Count the samples whose clearance is measured after each change."""
    asked: list[int] = []
    clearance = CapsuleDistances.clearance

    def counted(self, angles):
        asked.append(len(angles))
        return clearance(self, angles)

    monkeypatch.setattr(CapsuleDistances, "clearance", counted)
    first, second = (
        (key(at, left=ARM_IN_FRONT), key(at + 0.4, right=ARM_IN_FRONT), key(at + 0.8, left=ARM_RAISED))
        for at in (1.0, 61.0)
    )
    long = course(key(0.0), *first, key(3.0), key(60.0), *second, key(63.0))
    led = add_detours(long, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE)
    assert asked[0] >= 6300
    assert len(asked) > 2
    assert max(asked[1:]) < 700
    assert least(led) >= MIN_CLEARANCE - 1e-3


def test_overshoot_near_a_collision_is_halved_before_the_path_is_changed():
    """Expect reduced overshoot only at keys near the collision."""
    inner, outer = np.radians([-6, 30, 11, -32, 104, -72, 37, 30]), np.radians([-6, 22, 28, 2, 104, -66, 36, 1])

    def swinging(time, arm):
        plain = key(time, left=arm, right=arm)
        return replace(plain, passages=(KeyPassage(continuity=-0.5, swing=0.75),) * len(REST_ANGLES))

    def swings(course):
        return [posture.passages[LEFT_JOINTS[0]].swing if posture.passages else None for posture in course.postures]

    near = course(key(0.0), swinging(0.5, inner), swinging(0.8, outer), swinging(4.0, outer), key(6.0))
    assert least(near) < 0.0
    calm = near.reduce_overshoot(0.45)
    assert swings(calm) == [None, 0.0, 0.75, 0.75, None]
    assert least(calm) > MIN_CLEARANCE
    led = add_detours(near, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE)
    assert least(led) > MIN_CLEARANCE
    assert [posture.time for posture in led.postures] == [posture.time for posture in near.postures]
    assert swings(led)[1] == 0.375
    assert swings(near.reduce_overshoot(0.45, 0.5)) == [None, 0.375, 0.75, 0.75, None]
    assert swings(led)[3] == 0.75
    plain = course(key(0.0), key(0.5, left=inner), key(6.0))
    assert plain.reduce_overshoot(0.45) is plain


def between(one, other, share):
    """Return a trajectory between the motions of two courses."""
    times = np.arange(-KNOT_INTERVAL, one.motion.duration + 1.5 * KNOT_INTERVAL, KNOT_INTERVAL)
    inside = np.clip(times, 0.0, one.motion.duration)
    angles = (1.0 - share) * one.motion.angles(inside) + share * other.motion.angles(inside)
    return Trajectory(angles, one.motion.zero)


def test_detours_reduce_a_collision_of_a_trajectory_that_deviates_from_its_course():
    together = course(
        key(0.0), key(1.0, left=ARM_IN_FRONT), key(1.4, right=ARM_IN_FRONT), key(1.8, left=ARM_RAISED), key(3.0)
    )
    clear = add_detours(together, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE)
    trajectory = between(clear, together, 0.5)
    straying = clear.with_deviation(trajectory)
    np.testing.assert_allclose(straying.at(1.2), trajectory.at(1.2 + trajectory.zero).angles, atol=1e-3)
    last = float(clear.planned[-1])
    np.testing.assert_allclose(straying.at(last), trajectory.at(last + trajectory.zero).angles, atol=1e-3)
    lacking = MIN_CLEARANCE - CAPSULE_DISTANCES.clearance(straying.samples()).distances.min()
    assert lacking > 0.002
    led = add_detours(straying, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE)
    assert MIN_CLEARANCE - CAPSULE_DISTANCES.clearance(led.samples()).distances.min() < 0.2 * lacking


def test_search_for_collision_free_postures_is_cached(monkeypatch):
    asked = []
    separate = detour.separate
    monkeypatch.setattr(detour, "separate", lambda *given: asked.append(given) or separate(*given))
    together = course(
        key(0.0), key(1.0, left=ARM_IN_FRONT), key(1.4, right=ARM_IN_FRONT), key(1.8, left=ARM_RAISED), key(3.0)
    )
    known = ClearPostures(ROBOT, CAPSULE_DISTANCES)
    detoured = [add_detours(together, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE, cache=known) for _ in range(2)]
    here = [(given[0].tobytes(), given[1], given[-1]) for given in asked]
    assert here
    assert len(here) == len(set(here))
    for one, other in zip(*(led.postures for led in detoured), strict=True):
        np.testing.assert_array_equal(one.angles, other.angles)


def test_maximum_detour_count_grows_up_to_40_s_and_falls_for_longer_motions():
    assert [detour._compute_max_detours(seconds) for seconds in (0.5, 10.0, 40.0, 150.0, 1000.0)] == [
        16,
        16,
        64,
        17,
        16,
    ]


def test_detour_search_keeps_a_motion_with_an_unavoidable_collision(monkeypatch):
    monkeypatch.setattr(detour, "separate", lambda *given: None)
    together = course(
        key(0.0), key(1.0, left=ARM_IN_FRONT), key(1.4, right=ARM_IN_FRONT), key(1.8, left=ARM_RAISED), key(3.0)
    )
    assert add_detours(together, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE) is together


def test_detours_start_from_the_closest_sample_of_each_collision():
    lacking = np.array([0.0, 1.0, 3.0, 2.0, 0.0, 0.0, 2.0, 1.0, 0.0])
    assert list(detour._find_closest_samples(lacking)) == [2, 6]
    assert list(detour._find_closest_samples(lacking[1:8])) == [1, 5]
    assert list(detour._find_closest_samples(np.zeros(4))) == []


def test_later_collisions_get_detours_although_an_earlier_one_has_none(monkeypatch):
    usual = detour._propose_detours
    monkeypatch.setattr(
        detour, "_propose_detours", lambda course, time, *more: usual(course, time, *more) if time > 5.0 else iter(())
    )
    first, second = (
        (key(at, left=ARM_IN_FRONT + off), key(at + 0.4, right=ARM_IN_FRONT + off), key(at + 0.8, left=ARM_RAISED))
        for at, off in ((1.0, 0.0), (11.0, 0.001))  # in other postures, so that no key moves with those of the other
    )
    made = course(key(0.0), *first, key(3.0), key(10.0), *second, key(13.0))
    led = add_detours(made, CAPSULE_DISTANCES, min_clearance=MIN_CLEARANCE)
    assert led is not made
    angles = led.samples()
    clearance = CAPSULE_DISTANCES.clearance(angles).distances
    assert clearance[:500].min() < MIN_CLEARANCE
    assert clearance[500:].min() >= MIN_CLEARANCE - 1e-3


class Asked:
    """Clear-posture cache without collisions that records its queries."""

    def __init__(self):
        self.distances, self.near_to = CAPSULE_DISTANCES, []

    def near(self, angles, joints, spacing):
        self.near_to.append((angles, joints, spacing))
        return angles


def test_new_detour_key_is_tried_on_the_path_first_and_then_nearer_to_rest():
    room, arm = Asked(), tuple(LEFT_JOINTS)
    before = course(key(0.0), key(1.0, left=ARM_IN_FRONT), key(3.0))
    fractions = (0.0, *detour.WITHDRAWAL_FRACTIONS)
    changes = list(detour._add_key_candidates(before, 1.5, [arm], room, MIN_CLEARANCE, fractions))
    here = before.at(1.5)
    for share, (start, joints, spacing), change in zip(fractions, room.near_to, changes, strict=True):
        np.testing.assert_allclose(
            start[LEFT_JOINTS], here[LEFT_JOINTS] + share * (REST_ANGLES[LEFT_JOINTS] - here[LEFT_JOINTS])
        )
        np.testing.assert_array_equal(start[RIGHT_JOINTS], here[RIGHT_JOINTS])
        assert joints == arm
        assert (spacing.min_distance, spacing.desired_distance) == (MIN_CLEARANCE, MIN_CLEARANCE + detour.DETOUR_MARGIN)
        (added,) = set(change.postures) - set(before.postures)
        np.testing.assert_array_equal(added.angles, start)


def test_detour_search_withdraws_arms_towards_rest_only_for_a_visible_clearance_deficit(monkeypatch):
    tried: list[tuple[float, ...]] = []
    monkeypatch.setattr(detour, "_propose_detours", lambda *given: tried.append(given[-1]) or iter(()))
    near = course(
        key(0.0), key(1.0, left=ARM_IN_FRONT), key(1.4, right=ARM_IN_FRONT), key(1.8, left=ARM_RAISED), key(3.0)
    )
    clearance = least(near)
    add_detours(near, CAPSULE_DISTANCES, min_clearance=clearance + 0.5 * detour.MIN_VISIBLE_DEFICIT)
    assert set(tried) == {(0.0,)}
    add_detours(near, CAPSULE_DISTANCES, min_clearance=clearance + 2.0 * detour.MIN_VISIBLE_DEFICIT)
    assert detour.WITHDRAWAL_FRACTIONS in tried


def test_detour_moves_a_key_only_for_arms_that_are_not_at_rest():
    room = Asked()
    before = course(key(0.0), key(1.0, left=ARM_IN_FRONT, right=REST_ANGLES[RIGHT_JOINTS]), key(3.0))
    assert len(
        list(detour._move_key_candidates(before, 1, [tuple(LEFT_JOINTS), tuple(RIGHT_JOINTS)], room, MIN_CLEARANCE))
    ) == len(detour.KEY_OFFSETS)
    gap = CAPSULE_DISTANCES.gaps(before.at(1.0)[None])[0].min()
    for more, (start, joints, spacing) in zip(detour.KEY_OFFSETS, room.near_to, strict=True):
        np.testing.assert_array_equal(start, before.at(1.0))
        assert joints == tuple(LEFT_JOINTS)
        assert spacing.min_distance == pytest.approx(max(gap, MIN_CLEARANCE) + more)
    assert list(detour._move_key_candidates(before, 0, [tuple(LEFT_JOINTS)], room, MIN_CLEARANCE)) == []


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("has_rest_key", [False, True])
def test_detours_turn_only_the_arm_that_is_too_close(side, has_rest_key):
    at_the_head = np.radians([20, 131, 23, -6, 111, 31, 40, 15])
    close_arm, other_arm = (LEFT_JOINTS, RIGHT_JOINTS) if side == "left" else (RIGHT_JOINTS, LEFT_JOINTS)
    other_side = {"left": "right", "right": "left"}[side]
    rest_key = {other_side: ARM_IN_FRONT} if has_rest_key else {}
    made = course(key(0.0), key(1.0, **{side: at_the_head}, **rest_key), key(3.0))
    clear_postures = Asked()
    clear = np.zeros(len(made.samples()))
    changes = list(detour._propose_detours(made, 1.0, clear_postures, MIN_CLEARANCE, clear, (0.0,)))
    assert changes
    assert {joints for _, joints, _ in clear_postures.near_to} == {tuple(close_arm)}
    for change in changes:
        added = set(change.postures) - set(made.postures)
        assert all(posture.angles[other_arm] == pytest.approx(made.at(1.0)[other_arm]) for posture in added)
