from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion.keys import KeyPassage, KeyPosture
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning import detour
from kinesic.planning.detour import LEAST_STEP, ClearPostures, PostureCourse, lead_around
from kinesic.sim.distances import CapsuleDistances

from ..performances import LIMITS, ROBOT

DISTANCES = CapsuleDistances(ROBOT)
REST = ROBOT.skeleton.rest
LEFT, RIGHT = (list(ROBOT.joints(f"{side}_arm")) for side in ("l", "r"))
LEAST = 0.014
IN_FRONT = np.radians([0, 40, -15, -50, 70, 0, 0, 0])
HIGHER = np.radians([0, 75, -15, -50, 70, 0, 0, 0])


def key(time, left=None, right=None):
    """A key of the arms that are given; of all hinges, at rest, when none is."""
    angles, keyed = REST.copy(), np.full(len(REST), left is None and right is None)
    for arm, given in ((LEFT, left), (RIGHT, right)):
        if given is not None:
            angles[arm], keyed[arm] = given, True
    return KeyPosture(time, sealed(angles), tuple(bool(one) for one in keyed))


def course(*keys):
    return PostureCourse(keys, sealed([posture.time for posture in keys]), ROBOT, LIMITS)


CROSSING = course(
    key(0.0),
    key(1.0, left=IN_FRONT, right=REST[RIGHT]),
    key(2.0, left=REST[LEFT], right=IN_FRONT),
    key(3.0),
)


def least(made):
    times = np.arange(0.0, made.motion.duration, 0.005)
    return DISTANCES.clearance(made.motion.sample(times)[0]).distances.min()


def test_a_clear_motion_stays_as_it_is():
    clear = course(key(0.0), key(1.0, right=IN_FRONT), key(2.0))
    assert least(clear) >= LEAST
    assert lead_around(clear, DISTANCES, least=LEAST) is clear


def test_hands_in_one_place_go_round_one_another():
    together = course(key(0.0), key(1.0, left=IN_FRONT), key(1.4, right=IN_FRONT), key(1.8, left=HIGHER), key(3.0))
    assert least(together) < 0
    led = lead_around(together, DISTANCES, least=LEAST)
    assert least(led) >= LEAST - 1e-3


def test_keys_of_an_arm_stay_apart_and_in_order():
    together = course(key(0.0), key(1.0, left=IN_FRONT), key(1.4, right=IN_FRONT), key(1.8, left=HIGHER), key(3.0))
    led = lead_around(together, DISTANCES, least=LEAST)
    for arm in (LEFT, RIGHT):
        own = [k for k, posture in enumerate(led.postures) if posture.keyed[arm[0]]]
        assert np.diff(led.planned[own]).min() >= LEAST_STEP - 1e-9
        assert np.diff([led.postures[k].time for k in own]).min() > 0
    assert len({posture.time for posture in led.postures}) == len(led.postures)


def test_a_key_that_moves_away_moves_with_its_hold():
    held = course(key(0.0), key(1.0, right=IN_FRONT), key(2.0, right=IN_FRONT), key(3.0))
    aside = held.at(1.0)
    aside[RIGHT] += 0.05
    moved = held.moved(1, aside, tuple(RIGHT))
    np.testing.assert_array_equal(moved.postures[1].angles, moved.postures[2].angles)
    np.testing.assert_array_equal(moved.postures[3].angles, REST)


def test_a_new_key_is_asked_for_when_its_arm_was_asked_to_be_there():
    late = replace(CROSSING, planned=sealed([0.0, 1.5, 3.0, 4.0]))
    longer = late.extended(2.25, late.at(2.25), tuple(LEFT))
    (added,) = set(longer.postures) - set(late.postures)
    assert added.time == pytest.approx(1.5)
    assert longer.planned[list(longer.postures).index(added)] == 2.25
    assert [joint for joint, keyed in enumerate(added.keyed) if keyed] == LEFT


def test_a_change_is_looked_at_where_it_changes_something(monkeypatch):
    """Each change of a long course costs what it changes, and what is known of the rest stays."""
    asked: list[int] = []
    clearance = CapsuleDistances.clearance

    def counted(self, angles):
        asked.append(len(angles))
        return clearance(self, angles)

    monkeypatch.setattr(CapsuleDistances, "clearance", counted)
    first, second = (
        (key(at, left=IN_FRONT), key(at + 0.4, right=IN_FRONT), key(at + 0.8, left=HIGHER)) for at in (1.0, 61.0)
    )
    long = course(key(0.0), *first, key(3.0), key(60.0), *second, key(63.0))
    led = lead_around(long, DISTANCES, least=LEAST)
    assert asked[0] >= 6300
    assert len(asked) > 2
    assert max(asked[1:]) < 700
    assert least(led) >= LEAST - 1e-3


def test_swing_goes_before_the_path_changes():
    """A hand that swings too near to the body passes its keys plainly, and where it is clear it goes on swinging."""
    inner, outer = np.radians([-6, 30, 11, -32, 104, -72, 37, 30]), np.radians([-6, 22, 28, 2, 104, -66, 36, 1])

    def swinging(time, arm):
        plain = key(time, left=arm, right=arm)
        return replace(plain, passages=(KeyPassage(continuity=-0.5, swing=1.0),) * len(REST))

    def swings(course):
        return [posture.passages[LEFT[0]].swing if posture.passages else None for posture in course.postures]

    near = course(key(0.0), swinging(0.5, inner), swinging(0.8, outer), swinging(4.0, outer), key(6.0))
    assert least(near) < 0.0
    calm = near.calmed(0.45)
    assert swings(calm) == [None, 0.0, 1.0, 1.0, None]
    assert least(calm) > LEAST
    led = lead_around(near, DISTANCES, least=LEAST)
    assert least(led) > LEAST
    assert [posture.time for posture in led.postures] == [posture.time for posture in near.postures]
    assert swings(led)[1] == 0.0
    assert swings(led)[3] == 1.0
    plain = course(key(0.0), key(0.5, left=inner), key(6.0))
    assert plain.calmed(0.45) is plain


def synced(posture, name):
    """The same key with a sync point of a behaviour."""
    return replace(posture, syncs=((name, "stroke"),))


def test_keys_of_detours_are_those_that_no_sync_point_falls_on():
    made = course(
        key(0.0),
        synced(key(1.0, right=IN_FRONT), "g"),
        key(1.5, right=HIGHER),
        key(2.0, right=IN_FRONT),
        key(2.5, right=REST[RIGHT]),
        key(3.0),
    )
    assert made.detours(1.7, [tuple(RIGHT)]) == {2}  # the key at 2.0 is a hold of the stroke
    assert made.detours(1.2, [tuple(RIGHT)]) == {2}
    assert made.detours(0.0, [tuple(RIGHT)]) <= {0}


def between(one, other, share):
    """A trajectory between the motions of two courses."""
    times = np.arange(-STEP, one.motion.duration + 1.5 * STEP, STEP)
    inside = np.clip(times, 0.0, one.motion.duration)
    angles = (1.0 - share) * one.motion.angles(inside) + share * other.motion.angles(inside)
    return Trajectory(angles, one.motion.zero)


def test_a_trajectory_that_strays_is_led_around_where_it_is():
    together = course(key(0.0), key(1.0, left=IN_FRONT), key(1.4, right=IN_FRONT), key(1.8, left=HIGHER), key(3.0))
    clear = lead_around(together, DISTANCES, least=LEAST)
    trajectory = between(clear, together, 0.5)
    straying = clear.straying(trajectory)
    np.testing.assert_allclose(straying.at(1.2), trajectory.at(1.2 + trajectory.zero).angles, atol=1e-3)
    last = float(clear.planned[-1])
    np.testing.assert_allclose(straying.at(last), trajectory.at(last + trajectory.zero).angles, atol=1e-3)
    lacking = LEAST - DISTANCES.clearance(straying.samples()).distances.min()
    assert lacking > 0.002
    led = lead_around(straying, DISTANCES, least=LEAST)
    assert LEAST - DISTANCES.clearance(led.samples()).distances.min() < 0.2 * lacking


def test_a_clear_posture_is_looked_for_once(monkeypatch):
    asked = []
    separate = detour.separate
    monkeypatch.setattr(detour, "separate", lambda *given: asked.append(given) or separate(*given))
    together = course(key(0.0), key(1.0, left=IN_FRONT), key(1.4, right=IN_FRONT), key(1.8, left=HIGHER), key(3.0))
    known = ClearPostures(ROBOT, DISTANCES)
    found = [lead_around(together, DISTANCES, least=LEAST, known=known) for _ in range(2)]
    here = [(given[0].tobytes(), given[1], given[-1]) for given in asked]
    assert here
    assert len(here) == len(set(here))
    for one, other in zip(*(led.postures for led in found), strict=True):
        np.testing.assert_array_equal(one.angles, other.angles)


@pytest.mark.parametrize(("away", "is_near"), [(0.0, True), (0.9, True), (1.1, False)])
def test_a_key_is_near_within_the_least_step(away, is_near):
    only_left = course(key(0.0), key(1.0, left=IN_FRONT), key(2.0, right=IN_FRONT), key(3.0))
    for side in (-1, 1):
        time = 1.0 + side * away * LEAST_STEP
        assert only_left.near(tuple(LEFT), time) == (1 if is_near else None)
        assert only_left.near(tuple(RIGHT), time) is None


def test_no_two_keys_are_asked_for_at_one_time_and_all_stay_in_order():
    longer = CROSSING
    for time, arm in ((1.5, LEFT), (1.5, RIGHT), (0.5, LEFT)):
        longer = longer.extended(time, longer.at(time), tuple(arm))
    times = [posture.time for posture in longer.postures]
    assert times == sorted(set(times))
    assert len(times) == len(CROSSING.postures) + 3
    assert np.all(np.diff(longer.planned) >= 0.0)


def test_only_arms_with_the_same_keys_move_together():
    arms = [tuple(LEFT), tuple(RIGHT)]
    assert CROSSING.keyed_alike(arms) == [(*LEFT, *RIGHT)]
    apart = course(key(0.0), key(1.0, left=IN_FRONT), key(3.0))
    assert apart.keyed_alike(arms) == arms


def test_a_moved_arm_leaves_the_other_and_other_postures_alone():
    moved = CROSSING.moved(1, CROSSING.postures[1].angles + 0.1, tuple(LEFT))
    for k, (before, after) in enumerate(zip(CROSSING.postures, moved.postures, strict=True)):
        np.testing.assert_allclose(after.angles[LEFT] - before.angles[LEFT], 0.1 if k == 1 else 0.0)
        np.testing.assert_array_equal(after.angles[RIGHT], before.angles[RIGHT])


def test_longer_motions_may_change_more_as_far_as_that_costs_no_more():
    assert [detour._most_changes(seconds) for seconds in (0.5, 10.0, 40.0, 150.0, 1000.0)] == [16, 16, 64, 17, 16]


def test_detours_of_both_sides_are_found():
    made = course(
        key(0.0), key(1.0, right=HIGHER), key(2.0, right=IN_FRONT), synced(key(2.5, right=REST[RIGHT]), "g"), key(3.0)
    )
    assert made.detours(1.5, [tuple(RIGHT)]) == {1, 2}
    assert made.detours(2.2, [tuple(RIGHT)]) == {2}
    assert made.detours(1.5, []) == set()


def test_what_nothing_helps_is_left(monkeypatch):
    monkeypatch.setattr(detour, "separate", lambda *given: None)
    together = course(key(0.0), key(1.0, left=IN_FRONT), key(1.4, right=IN_FRONT), key(1.8, left=HIGHER), key(3.0))
    assert lead_around(together, DISTANCES, least=LEAST) is together


def test_worst_sample_of_each_stretch_is_looked_at():
    lacking = np.array([0.0, 1.0, 3.0, 2.0, 0.0, 0.0, 2.0, 1.0, 0.0])
    assert list(detour._closest(lacking)) == [2, 6]
    assert list(detour._closest(lacking[1:8])) == [1, 5]
    assert list(detour._closest(np.zeros(4))) == []


def test_stretch_that_nothing_helps_keeps_none_of_the_later_ones_from_help(monkeypatch):
    usual = detour._changes
    monkeypatch.setattr(
        detour, "_changes", lambda course, time, *more: usual(course, time, *more) if time > 5.0 else iter(())
    )
    first, second = (
        (key(at, left=IN_FRONT + off), key(at + 0.4, right=IN_FRONT + off), key(at + 0.8, left=HIGHER))
        for at, off in ((1.0, 0.0), (11.0, 0.001))  # in other postures, so that no key moves with those of the other
    )
    made = course(key(0.0), *first, key(3.0), key(10.0), *second, key(13.0))
    led = lead_around(made, DISTANCES, least=LEAST)
    assert led is not made
    angles = led.samples()
    clearance = DISTANCES.clearance(angles).distances
    assert clearance[:500].min() < LEAST
    assert clearance[500:].min() >= LEAST - 1e-3


class Asked:
    """A room that is clear everywhere, and remembers the postures that it is asked for."""

    def __init__(self):
        self.distances, self.near_to = DISTANCES, []

    def near(self, angles, joints, spacing):
        self.near_to.append((angles, joints, spacing))
        return angles


def test_new_key_is_looked_for_at_the_motion_and_then_nearer_to_rest():
    room, arm = Asked(), tuple(LEFT)
    before = course(key(0.0), key(1.0, left=IN_FRONT), key(3.0))
    changes = list(detour._with_a_key(before, 1.5, [arm], room, LEAST))
    here = before.at(1.5)
    for share, (start, joints, spacing), change in zip(detour.WITHDRAWALS, room.near_to, changes, strict=True):
        np.testing.assert_allclose(start[LEFT], here[LEFT] + share * (REST[LEFT] - here[LEFT]))
        np.testing.assert_array_equal(start[RIGHT], here[RIGHT])
        assert joints == arm
        assert (spacing.least, spacing.room) == (LEAST, LEAST + detour.DETOUR_ROOM)
        (added,) = set(change.postures) - set(before.postures)
        np.testing.assert_array_equal(added.angles, start)


def test_key_that_moves_goes_away_from_where_it_is_and_rest_stays_rest():
    room = Asked()
    before = course(key(0.0), key(1.0, left=IN_FRONT, right=REST[RIGHT]), key(3.0))
    assert len(list(detour._with_a_key_away(before, 1, [tuple(LEFT), tuple(RIGHT)], room, LEAST))) == len(detour.AWAY)
    gap = DISTANCES.gaps(before.at(1.0)[None])[0].min()
    for more, (start, joints, spacing) in zip(detour.AWAY, room.near_to, strict=True):
        np.testing.assert_array_equal(start, before.at(1.0))
        assert joints == tuple(LEFT)
        assert spacing.least == pytest.approx(max(gap, LEAST) + more)
    assert list(detour._with_a_key_away(before, 0, [tuple(LEFT)], room, LEAST)) == []


def test_only_the_lively_keys_on_both_sides_of_a_time_are_calmed():
    def lively(time):
        return replace(key(time, left=IN_FRONT), passages=(KeyPassage(swing=1.0),) * len(REST))

    made = course(key(0.0), *map(lively, (0.5, 1.0, 2.0, 3.0, 4.0)), key(5.0))
    calm = made.calmed(2.5)
    assert [bool(each.passages) and each.passages[LEFT[0]].swing for each in calm.postures] == [
        False,
        1.0,
        1.0,
        0.0,
        0.0,
        1.0,
        False,
    ]
    assert all(calm.postures[3].passages[joint] == KeyPassage(swing=1.0) for joint in RIGHT)
