import pytest

from kinesic.controller.slow_moves import largest_move_ratio, settings_near_people
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
from kinesic.session.setup import set_up


def test_moves_of_the_supervisor_keep_their_velocity_without_a_policy():
    assert settings_near_people(set_up()) is DEFAULT_SETTINGS


def test_moves_of_the_supervisor_near_adults_need_not_be_slower():
    assert settings_near_people(set_up(near="adult")) == DEFAULT_SETTINGS


@pytest.mark.parametrize("robot", ["upper22", "upper36"])
def test_moves_of_the_supervisor_near_children_are_slowed_until_other_random_moves_keep_the_limits(robot: str):
    setup = set_up(robot, near="child")
    pace = settings_near_people(setup).pace
    assert largest_move_ratio(setup, pace=DEFAULT_SETTINGS.pace, seed=1) > 1.0
    assert 0.6 < largest_move_ratio(setup, pace=pace, seed=1) <= 1.0
