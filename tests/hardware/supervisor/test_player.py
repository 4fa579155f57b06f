import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.supervisor.player import MAX_MOVE_ACCELERATION, Player, TimedMove, TimeScale, advance_time
from kinesic.hardware.supervisor.settings import SupervisorSettings

TIME_STEP = 0.01  # [s] duration of a control step


def run(
    time_scale: TimeScale, steps: int, *, target: float = 1.0, end: float = 100.0, slow: float = 0.4
) -> list[TimeScale]:
    scales = [time_scale]
    for _ in range(steps):
        scales.append(advance_time(scales[-1], TIME_STEP, target=target, end=end, slow=slow))
    return scales


def test_performance_time_accelerates_evenly_to_its_full_rate():
    scales = run(TimeScale(), 100)
    assert np.allclose(np.diff([scale.scale for scale in scales[:41]]), TIME_STEP / 0.4)
    assert scales[-1].scale == 1.0
    assert np.isclose(scales[-1].time - scales[-2].time, TIME_STEP)


def test_time_scale_of_a_performance_reaches_zero_within_the_slowdown_time():
    scales = run(TimeScale(1.0, 1.0), 41, target=0.0)
    assert scales[39].scale > 0.0
    assert scales[41].still


def test_performance_time_stops_smoothly_at_the_end_of_commands():
    scales = run(TimeScale(0.0, 1.0), 400, end=1.0)
    assert scales[-1] == TimeScale(1.0, 0.0)
    assert max(np.abs(np.diff([scale.scale for scale in scales]))) <= TIME_STEP / 0.4 + 1e-9


@given(
    st.floats(0, 1),
    st.floats(0.02, 1),
    st.lists(st.tuples(st.floats(0, 1), st.floats(-0.2, 3)), min_size=1, max_size=50),
)
def test_performance_time_never_decreases_or_passes_the_end(
    scale: float, slow: float, story: list[tuple[float, float]]
):
    time_scale, end = TimeScale(0.0, scale), 0.0
    for target, more in story:
        end = max(end, time_scale.time + more)
        after = advance_time(time_scale, TIME_STEP, target=target, end=end, slow=slow)
        assert time_scale.time <= after.time <= max(end, time_scale.time)
        assert after.time - time_scale.time <= TIME_STEP + 1e-12
        assert 0.0 <= after.scale <= 1.0
        time_scale = after


def test_servo_move_starts_and_ends_with_zero_velocity_within_the_velocity_limit():
    way = TimedMove.between(np.array([0.0, 1.0]), np.array([0.5, -1.0]), pace=0.7)
    times = np.linspace(0.0, way.duration, 2001)
    places = np.array([way.at(float(time)) for time in times])
    speeds = np.gradient(places, times, axis=0)
    assert np.abs(speeds).max() == pytest.approx(0.7, rel=1e-3)
    assert np.abs(speeds[[0, -1]]).max() < 1e-3
    assert places[0].tolist() == [0.0, 1.0]
    assert places[-1].tolist() == [0.5, -1.0]


def test_short_servo_move_reaches_the_acceleration_limit_and_zero_move_lasts_zero_seconds():
    way = TimedMove.between(np.zeros(2), np.full(2, 0.01), pace=1.0)
    times = np.linspace(0.0, way.duration, 2001)
    places = np.array([way.at(time)[0] for time in times])
    speeds = np.gradient(places, times)
    assert np.abs(np.gradient(speeds, times)).max() == pytest.approx(MAX_MOVE_ACCELERATION, rel=1e-2)
    assert speeds.max() < 0.5
    still = TimedMove.between(np.ones(2), np.ones(2), pace=1.0)
    assert still.duration == 0.0
    assert still.at(0.0).tolist() == [1.0, 1.0]


def player_with(times) -> Player:
    player = Player(SupervisorSettings())
    for time in times:
        assert player.take(float(time), np.array([np.sin(time)]))
    return player


def play(player: Player, seconds: float, *, target: float = 1.0) -> float:
    angles = None
    for _ in range(round(seconds / TIME_STEP)):
        angles = player.advance(TIME_STEP, target=target, slow=0.4)
    assert angles is not None
    return float(angles[0])


def test_performance_starts_at_the_time_of_its_first_command_and_runs_at_full_rate():
    player = player_with(np.arange(2.0, 4.0, TIME_STEP))
    assert (player.begun, player.still) == (True, True)
    assert player.left == pytest.approx(1.99)
    player.follow()
    assert play(player, 1.0) == pytest.approx(np.sin(3.0), abs=1e-6)
    assert player.time_scale.time == pytest.approx(3.0)


def test_performance_time_resumes_smoothly_after_a_pause():
    player = player_with(np.arange(0.0, 4.0, TIME_STEP))
    player.follow()
    play(player, 1.0)
    player.hold()
    assert player.still
    assert player.advance(TIME_STEP, target=1.0, slow=0.4) is None
    player.follow()
    play(player, TIME_STEP)
    assert player.time_scale.scale == pytest.approx(TIME_STEP / 0.4)
    assert player.time_scale.time == pytest.approx(1.0, abs=1e-3)


def test_approach_motion_of_the_servos_ends_at_the_first_setpoint():
    player = player_with(np.arange(0.0, 1.0, TIME_STEP))
    player.approach(np.array([0.8]))
    assert not player.reached
    assert play(player, 5.0) == pytest.approx(0.0)
    assert player.reached
    assert player.time_scale.time == 0.0


def test_command_before_the_current_time_or_with_infinite_angles_is_refused():
    player = player_with(np.arange(0.0, 2.0, TIME_STEP))
    player.follow()
    play(player, 1.0)
    assert not player.take(0.5, np.zeros(1))
    assert not player.take(5.0, np.array([np.inf]))
    assert player.take(1.5, np.zeros(1))
    assert player.left == pytest.approx(0.5)


def test_performance_time_restarts_at_the_first_command_of_a_new_performance():
    for begin in (0.0, 100.0):
        player = player_with(np.arange(0.0, 1.0, TIME_STEP))
        player.follow()
        play(player, 3.0)
        assert player.still
        assert player.take(begin, np.zeros(1))
        assert player.time_scale.time == begin


def test_command_with_an_earlier_time_is_refused_and_starts_no_new_performance_before_the_end():
    player = player_with(np.arange(0.0, 2.0, TIME_STEP))
    player.follow()
    play(player, 1.5)
    assert not player.take(0.2, np.zeros(1))
    assert player.performances == 1


def test_servo_move_counts_as_ended_up_to_rounding_but_not_10_ms_earlier():
    player = player_with(np.arange(0.0, 1.0, TIME_STEP))
    player.approach(np.array([0.8]))
    duration = player._move.duration
    for time, reached in ((duration, True), (duration - 1e-9, True), (duration - 0.01, False)):
        player._move_time = TimeScale(time)
        assert player.reached is reached
