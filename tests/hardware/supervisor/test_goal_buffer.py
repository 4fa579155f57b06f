import numpy as np
import pytest

from kinesic.hardware.supervisor.goal_buffer import GoalBuffer


def score_of(times, goals) -> GoalBuffer:
    score = GoalBuffer()
    for time, goal in zip(times, goals, strict=True):
        score.add(float(time), np.atleast_1d(np.asarray(goal, dtype=float)))
    return score


def test_interpolated_goal_curve_passes_each_setpoint():
    times, goals = np.arange(10) * 0.01, np.random.default_rng(0).normal(size=(10, 3))
    score = score_of(times, goals)
    for time, goal in zip(times, goals, strict=True):
        assert score.at(float(time)) == pytest.approx(goal, abs=1e-12)


def test_interpolation_between_setpoints_is_exact_for_parabolas():
    times = np.arange(20) * 0.01
    score = score_of(times, 3 * times**2 - times)
    for time in np.linspace(0.02, 0.16, 57):
        assert score.at(float(time))[0] == pytest.approx(3 * time**2 - time, abs=1e-9)


def test_interpolated_goal_curve_has_continuous_velocity():
    rng = np.random.default_rng(1)
    times = np.cumsum(rng.uniform(0.005, 0.03, 30))
    score = score_of(times, np.cumsum(rng.normal(size=30)))
    for time in times[1:-1]:
        before, here, after = (score.at(float(time) + step)[0] for step in (-1e-7, 0.0, 1e-7))
        assert (after - here) == pytest.approx(here - before, abs=1e-8)


def test_times_outside_the_goal_buffer_get_the_nearest_setpoints():
    score = score_of([1.0, 2.0], [3.0, 5.0])
    assert score.at(0.0) == 3.0
    assert score.at(9.0) == 5.0
    with pytest.raises(LookupError, match="no setpoints"):
        GoalBuffer().at(0.0)


def test_dropping_past_commands_does_not_change_later_interpolated_goals():
    times = np.arange(50) * 0.01
    score, kept = (score_of(times, np.sin(9 * times)) for _ in range(2))
    score.forget(0.305)
    assert len(score) == 50 - 29
    for time in np.linspace(0.305, 0.48, 40):
        assert score.at(float(time)) == pytest.approx(kept.at(float(time)), abs=1e-12)


def test_command_with_an_earlier_time_replaces_later_buffered_commands():
    score = score_of([0.0, 0.1, 0.2, 0.3], [0.0, 1.0, 2.0, 3.0])
    score.add(0.15, np.array([7.0]))
    assert (score.begin, score.end, len(score)) == (0.0, 0.15, 3)
    assert score.at(0.15) == 7.0


def test_velocity_feedforward_shrinks_with_time_scale():
    score = GoalBuffer()
    for k in range(10):
        score.add(k * 0.01, np.array([1.0 + 0.1 * k]), np.array([0.2 * k]))
    for time, lead in ((0.0, 0.0), (0.035, 0.7), (0.09, 1.8), (0.5, 1.8)):
        led = score.at(time)[0]
        assert score.at_scale(time, 1.0)[0] == led
        assert score.at_scale(time, 0.25)[0] == pytest.approx(led - 0.75 * lead)
        assert score.at_scale(time, 0.0)[0] == pytest.approx(led - lead)


def test_setpoints_without_feedforward_ignore_the_time_scale():
    score = score_of([0.0, 0.1], [1.0, 2.0])
    assert score.at_scale(0.05, 0.1) == score.at(0.05)
    score = GoalBuffer()
    for k in range(10):
        score.add(k * 0.01, np.array([1.0]), np.array([float(k)]))
    score.forget(0.055)
    score.add(0.08, np.array([1.0]), np.array([0.5]))  # in the place of the last two
    assert score.at_scale(0.055, 0.0)[0] == pytest.approx(1.0 - 5.5)
    assert score.at_scale(0.08, 0.0)[0] == pytest.approx(0.5)
