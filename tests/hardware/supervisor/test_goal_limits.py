import numpy as np
import pytest

from kinesic.hardware.supervisor.goal_limits import GoalBounds, GoalCourse, limit_goals

TIME_STEP = 0.01  # [s] duration of a control step
LIMITS = (np.array([100.0]), np.array([4000.0]), np.array([2000.0]), np.array([300.0]))
BOUNDS = GoalBounds(*LIMITS)
UNKNOWN_POSITION = np.array([np.nan])


def follow(start: float, wanted: list[float]) -> tuple[list[float], list[bool]]:
    course, goals, refusals = GoalCourse.still(np.array([start])), [start], []
    for goal in wanted:
        course, refused = limit_goals(course, np.array([goal]), UNKNOWN_POSITION, TIME_STEP, BOUNDS)
        goals.append(float(course.goals[0]))
        refusals.append(bool(refused[0]))
    return goals, refusals


def test_servo_goals_within_their_limits_are_unchanged():
    wanted = [2048 + 150 * np.sin(3 * k * TIME_STEP) for k in range(300)]
    goals, refusals = follow(2048.0, wanted)
    assert goals[1:] == pytest.approx(wanted)
    assert not any(refusals)


def test_jump_of_a_servo_goal_becomes_the_fastest_motion_without_overshoot():
    goals, refusals = follow(1000.0, [3000.0] * 200)
    assert max(np.diff(goals)) == pytest.approx(2000 * TIME_STEP)
    assert max(goals) <= 3000.0 + 1e-6
    assert goals[-1] == pytest.approx(3000.0, abs=0.5)
    assert refusals[0]
    assert not refusals[-1]


def test_servo_goals_stay_in_their_position_range():
    goals, _ = follow(3900.0, [9000.0] * 50)
    assert max(goals) <= 4000.0
    goals, _ = follow(200.0, [-9000.0] * 50)
    assert min(goals) >= 100.0


def test_servo_goal_stays_near_the_position_of_a_blocked_servo():
    course = GoalCourse.still(np.array([2000.0]))
    for k in range(200):
        course, _ = limit_goals(course, np.array([2000.0 + 10 * k]), np.array([2000.0]), TIME_STEP, BOUNDS)
    assert course.goals[0] <= 2300.0


def test_servo_goal_stays_unchanged_if_the_servo_is_pushed_away():
    course, _ = limit_goals(
        GoalCourse.still(np.array([2000.0])), np.array([2000.0]), np.array([1000.0]), TIME_STEP, BOUNDS
    )
    assert course.goals[0] == 2000.0


def test_limits_of_servo_goals_apply_to_each_servo_separately():
    """One servo away from its goal, or without a record, must not change the other goals."""
    rng, two = np.random.default_rng(1), GoalBounds(*(np.repeat(limit, 2) for limit in LIMITS))
    for _ in range(400):
        goals, speeds = rng.uniform(100, 4000, 2), rng.uniform(-2000, 2000, 2)
        wanted = goals + rng.normal(0, rng.choice([10.0, 60.0, 1000.0], 2))
        present = np.where(rng.random(2) < 0.2, np.nan, goals + rng.normal(0, 200, 2))
        both, refusals = limit_goals(GoalCourse(goals, speeds), wanted, present, TIME_STEP, two)
        for k in range(2):
            own = slice(k, k + 1)
            alone, refused = limit_goals(
                GoalCourse(goals[own], speeds[own]), wanted[own], present[own], TIME_STEP, BOUNDS
            )
            assert both.goals[k] == alone.goals[0]
            assert refusals[k] == refused[0]


FINE_STEP = 0.001  # [s] duration of a step in which a goal may gain 200 ticks/s


def next_of(
    goal: float, desired: float, *, speed: float = 0.0, present: float = np.nan, seconds: float = FINE_STEP
) -> tuple[float, float, bool]:
    """Return the next goal, its velocity, and whether it was limited."""
    course, refused = limit_goals(
        GoalCourse(np.array([goal]), np.array([speed])), np.array([desired]), np.array([present]), seconds, BOUNDS
    )
    return float(course.goals[0]), float(course.velocities[0]), bool(refused[0])


def test_servo_goal_reaches_its_full_velocity_after_ten_milliseconds():
    course, speeds, goals = GoalCourse.still(np.array([1000.0])), [], []
    for _ in range(12):
        course, refused = limit_goals(course, np.array([3000.0]), UNKNOWN_POSITION, FINE_STEP, BOUNDS)
        assert refused.all()
        speeds.append(float(course.velocities[0]))
        goals.append(float(course.goals[0]))
    assert speeds == pytest.approx([*range(200, 2001, 200), 2000, 2000])
    assert goals[:4] == pytest.approx([1000.2, 1000.6, 1001.2, 1002.0])


@pytest.mark.parametrize("steps", [3, 4, 7, 10])
def test_servo_goal_decelerates_as_late_as_its_acceleration_limit_allows(steps: int):
    """Braking from 800 ticks/s takes 0.8 + 0.6 + 0.4 + 0.2 ticks."""
    speed, way = 200.0 * steps, 0.2 * steps * (steps + 1) / 2
    assert next_of(2000.0, 2000.0 + way, speed=speed)[:2] == pytest.approx((2000.0 + FINE_STEP * speed, speed))
    nearer = next_of(2000.0, 2000.0 + 0.95 * way, speed=speed)[1]
    assert speed - 200.0 <= nearer < speed


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_velocity_and_acceleration_of_a_servo_goal_reach_but_never_exceed_their_limits(way: float):
    for goal in np.linspace(1000.3, 3000.7, 23).tolist():
        assert next_of(goal, goal + way * 2.0, speed=way * 2000.0)[1:] == (pytest.approx(way * 2000.0), False)
        faster = next_of(goal, goal + way * 2.001, speed=way * 2000.0)[1:]
        assert faster == (pytest.approx(way * 1800.0), True)  # brakes, so as to stop there
        assert next_of(goal, goal + way * 0.2)[1:] == (pytest.approx(way * 200.0), False)
        assert next_of(goal, goal + way * 0.2001)[1:] == (pytest.approx(way * 200.0), True)


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_servo_goal_is_at_most_the_allowed_distance_ahead_of_its_servo(way: float):
    goal, present = 2000.0 + way * 290.0, 2000.0
    for more, granted, refused in ((10.0, 10.0, False), (10.4, 10.0, False), (10.6, 10.0, True), (50.0, 10.0, True)):
        result = next_of(goal, goal + way * more, present=present, seconds=TIME_STEP)
        assert result == (pytest.approx(goal + way * granted), pytest.approx(way * granted / TIME_STEP), refused)


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_servo_goal_far_from_its_servo_may_only_approach_the_servo(way: float):
    present = 2000.0 - way * 1000.0
    for desired, granted in ((-5.0, -5.0), (0.0, 0.0), (5.0, 0.0)):
        assert next_of(2000.0, 2000.0 + way * desired, present=present, seconds=TIME_STEP) == (
            pytest.approx(2000.0 + way * granted),
            pytest.approx(way * granted / TIME_STEP),
            granted != desired,
        )


@pytest.mark.parametrize(("edge", "way"), [(4000.0, 1.0), (100.0, -1.0)])
def test_servo_goal_outside_its_range_moves_to_the_nearest_edge_of_the_range(edge: float, way: float):
    """The nearest edge replaces a goal far outside its range."""
    for outside in (50.0, 900.0):
        result = next_of(edge + way * 5.0, edge - way * 400.0, present=edge + way * outside, seconds=TIME_STEP)
        assert result[1:] == (pytest.approx(-way * (2000.0 if outside < 300.0 else 500.0)), True)
    assert next_of(edge, edge, present=edge, seconds=TIME_STEP) == (edge, 0.0, False)
    assert next_of(edge, edge + way, present=edge, seconds=TIME_STEP) == (edge, 0.0, True)


def test_limits_of_servo_goals_are_equal_in_both_directions():
    rng = np.random.default_rng(2)
    for _ in range(500):
        goal, speed = rng.uniform(100, 4000), rng.uniform(-2000, 2000)
        desired, present = goal + rng.normal(0, 60), rng.choice([np.nan, goal + rng.normal(0, 400)])
        seconds = rng.choice([TIME_STEP, FINE_STEP])
        there, fast, refused = next_of(goal, desired, speed=speed, present=present, seconds=seconds)
        mirrored = next_of(4100.0 - goal, 4100.0 - desired, speed=-speed, present=4100.0 - present, seconds=seconds)
        assert mirrored == (pytest.approx(4100.0 - there, abs=1e-6), pytest.approx(-fast, abs=1e-3), refused)


def test_limited_goal_positions_and_velocities_are_read_only():
    before = np.array([2000.0])
    course, _ = limit_goals(GoalCourse.still(before), np.array([2001.0]), UNKNOWN_POSITION, TIME_STEP, BOUNDS)
    for values in (course.goals, course.velocities):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0.0
    before[0] = 0.0
    assert course.goals[0] == pytest.approx(2001.0)
