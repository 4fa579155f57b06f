"""Goals on the wire against where servos with profiles then are."""

from math import inf

import numpy as np
import pytest

from kinesic.hardware.supervisor.goal_limits import GoalCourse
from kinesic.hardware.supervisor.goals import GoalSteering
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import USUAL
from kinesic.hardware.virtual.set_point import by_speed

PERIOD = USUAL.period
STARTING = 3  # cycles


@pytest.fixture
def manifest(robot) -> Manifest:
    return Manifest.of(robot)


@pytest.fixture
def steering(manifest) -> GoalSteering:
    """All joints at zero."""
    made = GoalSteering(manifest, USUAL)
    made.put(range(len(manifest.members)), manifest.scale.nearest(np.zeros(len(manifest.members))))
    return made


@pytest.mark.parametrize("share", [-0.8, 0.2, 0.5, 0.8])
def test_set_points_of_moving_servos_are_at_their_goals_on_the_mean(manifest, steering, share):
    limit = manifest.speeds[0]  # [ticks/s] of the profile
    speed = share * manifest.members[0].speed / abs(manifest.scale.turns[0])
    for k in range(40):
        assert steering.player.take(k * PERIOD, np.full(len(manifest.rest), k * PERIOD * speed))
    steering.player.follow()
    place, off = float(steering.goals[0]), []
    for _ in range(10):
        steering.move(PERIOD, steering.goals, target=1.0, slow=0.4)
        profile = by_speed(place, 0.0, float(steering.ticks()[0]), limit=limit, acceleration=inf)
        places = [profile.at(time)[0] for time in np.arange(0.5, 100) * PERIOD / 100]
        off.append(np.mean(places) - steering.goals[0])
        place = profile.at(PERIOD)[0]
    assert np.abs(off[STARTING:]).max() < 1.5


def test_standing_servos_are_told_their_goals(steering):
    assert steering.ticks().tolist() == np.rint(steering.goals).tolist()


HALF_A_TURN = 2048


def run(steering: GoalSteering, present: np.ndarray | None = None, *, cycles: int) -> np.ndarray:
    """Whose goals were refused in any of the cycles; servos are where their goals are if nothing else is said."""
    refused = np.zeros(len(steering.goals), dtype=bool)
    for _ in range(cycles):
        refused |= steering.move(PERIOD, steering.goals if present is None else present, target=1.0, slow=USUAL.slow)
    return refused


def test_without_goals_there_is_nothing_to_tell(manifest):
    steering = GoalSteering(manifest, USUAL)
    assert steering.goals is None
    assert steering.ticks() is None
    assert np.isnan(steering.angles).tolist() == [True] * len(manifest.rest)
    assert not steering.arrived
    steering.hold()
    refused = steering.move(PERIOD, np.full(5, np.nan), target=1.0, slow=0.4)
    assert refused.tolist() == [False] * len(manifest.members)
    assert steering.goals is None


def test_goals_that_are_put_stand_where_they_are_put(manifest, steering):
    before = steering.goals.copy()
    steering.put([1, 4], np.array([1500.0, 2600.0]))
    assert steering.goals.tolist() == [before[0], 1500.0, before[2], before[3], 2600.0]
    assert steering.arrived
    assert steering.ticks().tolist() == np.rint(steering.goals).tolist()
    there = steering.goals.copy()
    assert not run(steering, cycles=3).any()
    assert steering.goals.tolist() == there.tolist()


def test_a_fold_brings_all_to_rest_but_who_must_not_move(manifest, steering):
    far = manifest.scale.nearest((manifest.rest + np.array([0.3, 0.6, -0.5, 0.4])).take(manifest.joints))
    steering.put(range(5), far)
    before = steering.angles
    steering.fold(frozenset({1, 3}))
    run(steering, cycles=1)
    assert steering.player.still is False
    run(steering, cycles=400)
    assert steering.player.reached
    assert steering.arrived
    expected = np.where([False, True, False, True], before, manifest.rest)
    assert steering.angles == pytest.approx(expected, abs=2e-3)


def test_an_approach_leads_to_where_the_performance_begins(manifest, steering):
    begin = np.array([0.1, 0.4, -0.2, 0.3])
    for k in range(3):
        assert steering.player.take(k * PERIOD, begin)
    steering.approach()
    run(steering, cycles=400)
    assert steering.angles == pytest.approx(begin, abs=2e-3)


def test_a_hold_stops_goals_on_their_way(steering, manifest):
    steering.put(range(5), manifest.scale.nearest(np.full(5, 0.5)))
    steering.fold(frozenset())
    run(steering, cycles=30)
    on_its_way = steering.goals.copy()
    steering.hold()
    assert steering.arrived
    run(steering, cycles=50)
    assert steering.goals == pytest.approx(on_its_way, abs=manifest.speeds.max() * PERIOD)


def test_a_goal_is_ahead_of_a_servo_that_stands_by_twice_its_error_of_full_power(steering, manifest):
    here = steering.goals.copy()
    assert steering.player.take(0.0, np.array([0.9, 0.0, 0.0, 0.0]))
    steering.player.follow()
    assert run(steering, here, cycles=60).tolist() == [True, True, False, False, False]
    assert steering.goals - here == pytest.approx([2.0 * 141.6, 2.0 * 141.6, 0.0, 0.0, 0.0])
    assert not steering.arrived


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_what_lies_outside_a_range_is_refused_and_the_end_of_the_range_taken(steering, manifest, way):
    lower, upper = manifest.spans
    wanted = way * np.array([0.0, 9.0, 0.0, 0.0])
    assert steering.player.take(0.0, wanted)
    steering.player.follow()
    run(steering, cycles=200)
    assert run(steering, cycles=1).tolist() == [False, False, True, False, False]
    assert steering.arrived
    assert steering.goals[2] in (lower[2], upper[2])
    assert lower[2] <= steering.ticks()[2] <= upper[2]


def test_who_is_given_up_holds_with_the_servo_beside_it_and_the_others_go_on(steering, manifest):
    stuck = np.array([True, False, False, False, False])
    present = steering.goals + 40.0
    present[3] = np.nan
    steering.give_up(stuck | [False, False, False, True, False], present)
    held = [present[0], present[1]]
    assert steering.goals[:2].tolist() == held
    assert steering.player.take(0.0, np.full(4, 0.3))
    steering.player.follow()
    steering.give_up(stuck, present + 40.0)  # that they have been moved since changes nothing
    run(steering, cycles=300)
    assert steering.goals[:2].tolist() == held
    others = manifest.scale.nearest(np.full(5, 0.3))[2:]  # the fourth was not to be found, and is driven
    assert steering.goals[2:] == pytest.approx(others)


def test_limp_servos_are_followed_where_they_are(steering, manifest):
    limp = np.array([True, True, False, True, False])
    present = np.array([1900.0, 2 * HALF_A_TURN + 1905.0, 1000.0, np.nan, 1000.0])
    before = steering.goals.copy()
    steering.follow_limp(limp, present)
    assert steering.goals.tolist() == [1900.0, 1905.0, *before[2:]]
    steering.follow_limp(~limp & False, np.full(5, 7.0))
    assert steering.goals.tolist() == [1900.0, 1905.0, *before[2:]]


def test_where_servos_are_makes_no_goals_while_none_are_known(manifest):
    steering = GoalSteering(manifest, USUAL)
    steering.follow_limp(np.array([True, False, False, False, False]), np.full(5, 1900.0))
    assert steering.goals is None


def test_goals_are_told_ahead_by_what_the_profile_costs_and_never_outside_the_range(steering, manifest):
    lower, upper = manifest.spans
    for way, end in ((1.0, upper), (-1.0, lower)):
        steering.put(range(5), np.clip(end - way * manifest.speeds * PERIOD, lower, upper))
        assert steering.player.take(0.0, np.zeros(4))
        steering._course = GoalCourse(steering.goals, way * manifest.speeds)
        ahead = manifest.speeds * PERIOD / 2  # at full speed, half of what is moved in a period
        assert steering.ticks() == pytest.approx(np.rint(steering.goals + way * ahead), abs=1)
        steering._course = GoalCourse(end, way * manifest.speeds)
        assert steering.ticks().tolist() == end.tolist()
