import numpy as np
import pytest

from kinesic.hardware.supervisor.goal_limits import GoalBounds, GoalCourse, limit_goals

STEP = 0.01
LIMITS = (np.array([100.0]), np.array([4000.0]), np.array([2000.0]), np.array([300.0]))
BOUNDS = GoalBounds(*LIMITS)
UNKNOWN = np.array([np.nan])


def follow(start: float, wanted: list[float]) -> tuple[list[float], list[bool]]:
    course, goals, refusals = GoalCourse.still(np.array([start])), [start], []
    for goal in wanted:
        course, refused = limit_goals(course, np.array([goal]), UNKNOWN, STEP, BOUNDS)
        goals.append(float(course.goals[0]))
        refusals.append(bool(refused[0]))
    return goals, refusals


def test_what_keeps_the_limits_is_granted_to_the_tick():
    wanted = [2048 + 150 * np.sin(3 * k * STEP) for k in range(300)]
    goals, refusals = follow(2048.0, wanted)
    assert goals[1:] == pytest.approx(wanted)
    assert not any(refusals)


def test_a_jump_becomes_the_fastest_way_that_does_not_overshoot():
    goals, refusals = follow(1000.0, [3000.0] * 200)
    assert max(np.diff(goals)) == pytest.approx(2000 * STEP)
    assert max(goals) <= 3000.0 + 1e-6
    assert goals[-1] == pytest.approx(3000.0, abs=0.5)
    assert refusals[0]
    assert not refusals[-1]


def test_goals_stay_in_their_range():
    goals, _ = follow(3900.0, [9000.0] * 50)
    assert max(goals) <= 4000.0
    goals, _ = follow(200.0, [-9000.0] * 50)
    assert min(goals) >= 100.0


def test_a_goal_does_not_run_away_from_a_servo_that_stands():
    course = GoalCourse.still(np.array([2000.0]))
    for k in range(200):
        course, _ = limit_goals(course, np.array([2000.0 + 10 * k]), np.array([2000.0]), STEP, BOUNDS)
    assert course.goals[0] <= 2300.0


def test_a_servo_that_was_pushed_away_is_not_followed_by_a_jump():
    course, _ = limit_goals(GoalCourse.still(np.array([2000.0])), np.array([2000.0]), np.array([1000.0]), STEP, BOUNDS)
    assert course.goals[0] == 2000.0


def test_what_others_do_changes_nothing_for_a_servo():
    """A servo that nobody has heard makes the others be looked at more closely: with the same result."""
    rng, two = np.random.default_rng(1), GoalBounds(*(np.repeat(each, 2) for each in LIMITS))
    for _ in range(300):
        goal, speed = rng.uniform(100, 4000), rng.uniform(-2000, 2000)
        wanted, present = goal + rng.normal(0, 60), goal + rng.normal(0, 200)
        alone, refused = limit_goals(
            GoalCourse(np.array([goal]), np.array([speed])), np.array([wanted]), np.array([present]), STEP, BOUNDS
        )
        both, refusals = limit_goals(
            GoalCourse(np.array([goal, 2000.0]), np.array([speed, 0.0])),
            np.array([wanted, 2000.0]),
            np.array([present, np.nan]),
            STEP,
            two,
        )
        assert both.goals[0] == alone.goals[0]
        assert refusals[0] == refused[0]
