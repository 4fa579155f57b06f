import numpy as np
import pytest

from kinesic.hardware.supervisor.player import Player
from kinesic.hardware.supervisor.settings import SupervisorSettings

STEP = 0.01


def player_with(times) -> Player:
    player = Player(SupervisorSettings())
    for time in times:
        assert player.take(float(time), np.array([np.sin(time)]))
    return player


def play(player: Player, seconds: float, *, wanted: float = 1.0) -> float:
    angles = None
    for _ in range(round(seconds / STEP)):
        angles = player.advance(STEP, wanted=wanted, slow=0.4)
    assert angles is not None
    return float(angles[0])


def test_from_its_first_command_time_runs_at_once():
    player = player_with(np.arange(2.0, 4.0, STEP))
    assert (player.begun, player.still) == (True, True)
    assert player.left == pytest.approx(1.99)
    player.follow()
    assert play(player, 1.0) == pytest.approx(np.sin(3.0), abs=1e-6)
    assert player.tempo.time == pytest.approx(3.0)


def test_after_a_pause_it_goes_on_softly_where_it_was():
    player = player_with(np.arange(0.0, 4.0, STEP))
    player.follow()
    play(player, 1.0)
    player.hold()
    assert player.still
    assert player.advance(STEP, wanted=1.0, slow=0.4) is None
    player.follow()
    play(player, STEP)
    assert player.tempo.scale == pytest.approx(STEP / 0.4)
    assert player.tempo.time == pytest.approx(1.0, abs=1e-3)


def test_a_way_ends_where_it_should():
    player = player_with(np.arange(0.0, 1.0, STEP))
    player.approach(np.array([0.8]))
    assert not player.reached
    assert play(player, 5.0) == pytest.approx(0.0)
    assert player.reached
    assert player.tempo.time == 0.0


def test_what_is_late_or_no_number_is_refused():
    player = player_with(np.arange(0.0, 2.0, STEP))
    player.follow()
    play(player, 1.0)
    assert not player.take(0.5, np.zeros(1))
    assert not player.take(5.0, np.array([np.inf]))
    assert player.take(1.5, np.zeros(1))
    assert player.left == pytest.approx(0.5)


def test_a_new_performance_begins_with_its_own_time():
    for begin in (0.0, 100.0):
        player = player_with(np.arange(0.0, 1.0, STEP))
        player.follow()
        play(player, 3.0)
        assert player.still
        assert player.take(begin, np.zeros(1))
        assert player.tempo.time == begin
