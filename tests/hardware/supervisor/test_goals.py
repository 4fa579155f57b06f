"""Goals on the wire, compared with profiled servo positions at the same time."""

from math import inf

import numpy as np
import pytest

from kinesic.hardware.supervisor.goal_limits import GoalCourse
from kinesic.hardware.supervisor.goals import GoalSteering
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
from kinesic.hardware.virtual.set_point import velocity_profile

PERIOD = DEFAULT_SETTINGS.period
START_CYCLES = 3  # number of cycles in which the motion starts


@pytest.fixture
def manifest(robot) -> Manifest:
    return Manifest.of(robot)


@pytest.fixture
def steering(manifest) -> GoalSteering:
    """Return a goal writer with all joints at zero."""
    made = GoalSteering(manifest, DEFAULT_SETTINGS)
    made.put(range(len(manifest.members)), manifest.scale.nearest(np.zeros(len(manifest.members))))
    return made


@pytest.mark.parametrize("share", [-0.8, 0.2, 0.5, 0.8])
def test_mean_profile_position_of_moving_servos_equals_their_goal(manifest, steering, share):
    limit = manifest.velocities[0]  # [ticks/s] of the profile
    speed = share * manifest.members[0].speed / abs(manifest.scale.turns[0])
    for k in range(40):
        assert steering.player.take(k * PERIOD, np.full(len(manifest.rest), k * PERIOD * speed))
    steering.player.follow()
    place, off = float(steering.goals[0]), []
    for _ in range(10):
        steering.move(PERIOD, steering.goals, target=1.0, slow=0.4)
        profile = velocity_profile(place, 0.0, float(steering.ticks()[0]), limit=limit, acceleration=inf)
        places = [profile.at(time)[0] for time in np.arange(0.5, 100) * PERIOD / 100]
        off.append(np.mean(places) - steering.goals[0])
        place = profile.at(PERIOD)[0]
    assert np.abs(off[START_CYCLES:]).max() < 1.5


def test_goal_ticks_at_standstill_are_rounded_goals_without_lag_compensation(steering):
    assert steering.ticks().tolist() == np.rint(steering.goals).tolist()


HALF_A_TURN = 2048


def run(steering: GoalSteering, present: np.ndarray | None = None, *, cycles: int) -> np.ndarray:
    """Run some cycles, and return which servos had limited goals."""
    refused = np.zeros(len(steering.goals), dtype=bool)
    for _ in range(cycles):
        refused |= steering.move(
            PERIOD, steering.goals if present is None else present, target=1.0, slow=DEFAULT_SETTINGS.slow
        )
    return refused


def test_goal_control_without_goals_returns_no_ticks_and_nan_angles(manifest):
    steering = GoalSteering(manifest, DEFAULT_SETTINGS)
    assert steering.goals is None
    assert steering.ticks() is None
    assert np.isnan(steering.angles).tolist() == [True] * len(manifest.rest)
    assert not steering.arrived
    steering.hold()
    refused = steering.move(PERIOD, np.full(5, np.nan), target=1.0, slow=0.4)
    assert refused.tolist() == [False] * len(manifest.members)
    assert steering.goals is None


def test_goals_set_without_a_motion_stay_constant_over_later_cycles(manifest, steering):
    before = steering.goals.copy()
    steering.put([1, 4], np.array([1500.0, 2600.0]))
    assert steering.goals.tolist() == [before[0], 1500.0, before[2], before[3], 2600.0]
    assert steering.arrived
    assert steering.ticks().tolist() == np.rint(steering.goals).tolist()
    there = steering.goals.copy()
    assert not run(steering, cycles=3).any()
    assert steering.goals.tolist() == there.tolist()


def test_move_to_rest_moves_all_but_holding_joints(manifest, steering):
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


def test_approach_command_moves_servo_goals_to_the_start_of_the_performance(manifest, steering):
    begin = np.array([0.1, 0.4, -0.2, 0.3])
    for k in range(3):
        assert steering.player.take(k * PERIOD, begin)
    steering.approach()
    run(steering, cycles=400)
    assert steering.angles == pytest.approx(begin, abs=2e-3)


def test_hold_command_stops_the_motion_of_servo_goals(steering, manifest):
    steering.put(range(5), manifest.scale.nearest(np.full(5, 0.5)))
    steering.fold(frozenset())
    run(steering, cycles=30)
    on_its_way = steering.goals.copy()
    steering.hold()
    assert steering.arrived
    run(steering, cycles=50)
    assert steering.goals == pytest.approx(on_its_way, abs=manifest.velocities.max() * PERIOD)


def test_goal_stops_at_twice_the_full_power_error_from_a_blocked_servo(steering, manifest):
    here = steering.goals.copy()
    assert steering.player.take(0.0, np.array([0.9, 0.0, 0.0, 0.0]))
    steering.player.follow()
    assert run(steering, here, cycles=60).tolist() == [True, True, False, False, False]
    assert steering.goals - here == pytest.approx([2.0 * 141.6, 2.0 * 141.6, 0.0, 0.0, 0.0])
    assert not steering.arrived


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_setpoints_beyond_a_joint_range_are_clipped_to_the_range_end_and_reported(steering, manifest, way):
    lower, upper = manifest.spans
    wanted = way * np.array([0.0, 9.0, 0.0, 0.0])
    assert steering.player.take(0.0, wanted)
    steering.player.follow()
    run(steering, cycles=200)
    assert run(steering, cycles=1).tolist() == [False, False, True, False, False]
    assert steering.arrived
    assert steering.goals[2] in (lower[2], upper[2])
    assert lower[2] <= steering.ticks()[2] <= upper[2]


def test_both_servos_of_a_tandem_joint_hold_when_one_is_stuck(steering, manifest):
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


def test_servo_goals_follow_the_positions_of_servos_without_torque(steering, manifest):
    limp = np.array([True, True, False, True, False])
    present = np.array([1900.0, 2 * HALF_A_TURN + 1905.0, 1000.0, np.nan, 1000.0])
    before = steering.goals.copy()
    steering.follow_without_torque(limp, present)
    assert steering.goals.tolist() == [1900.0, 1905.0, *before[2:]]
    steering.follow_without_torque(~limp & False, np.full(5, 7.0))
    assert steering.goals.tolist() == [1900.0, 1905.0, *before[2:]]


def test_move_to_rest_does_not_wait_for_a_servo_without_torque(steering, manifest):
    raised = manifest.scale.nearest((manifest.rest + 0.5)[manifest.joints])
    steering.put(range(5), raised)
    is_limp = np.arange(5) == 4
    steering.fold(frozenset())
    for _ in range(400):
        present = np.where(is_limp, raised, steering.goals)
        steering.follow_without_torque(is_limp, present)
        steering.move(PERIOD, present, target=1.0, slow=DEFAULT_SETTINGS.slow)
    lag = steering.goals - manifest.scale.nearest(manifest.rest[manifest.joints])
    assert (np.abs(lag) > 100.0).tolist() == is_limp.tolist()
    assert steering.arrived


def test_following_servos_without_torque_creates_no_goals_if_none_exist(manifest):
    steering = GoalSteering(manifest, DEFAULT_SETTINGS)
    steering.follow_without_torque(np.array([True, False, False, False, False]), np.full(5, 1900.0))
    assert steering.goals is None


def test_sent_goals_compensate_profile_lag_within_range(steering, manifest):
    lower, upper = manifest.spans
    for way, end in ((1.0, upper), (-1.0, lower)):
        steering.put(range(5), np.clip(end - way * manifest.velocities * PERIOD, lower, upper))
        assert steering.player.take(0.0, np.zeros(4))
        steering._course = GoalCourse(steering.goals, way * manifest.velocities)
        ahead = manifest.velocities * PERIOD / 2  # at full speed, half of what is moved in a period
        assert steering.ticks() == pytest.approx(np.rint(steering.goals + way * ahead), abs=1)
        steering._course = GoalCourse(end, way * manifest.velocities)
        assert steering.ticks().tolist() == end.tolist()
