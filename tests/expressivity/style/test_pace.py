from dataclasses import replace
from math import log2

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.pace import CARRIED, COMFORT, FLOOR, FORCE, HASTE, WEAKNESS, Pace, fitts, hurry_time
from kinesic.expressivity.style.style import Expressivity

WAYS = np.linspace(0.0, 0.8, 33)
EXTENTS = (-1.0, 0.0, 0.5, 1.0)


@pytest.fixture(scope="module")
def sluggish(pace):
    """The same robot with servos that give a quarter of the speed, acceleration and jerk."""
    slow = {name: sealed(getattr(pace.limits, name) / 4) for name in ("speed", "acceleration", "jerk")}
    return Pace(pace.robot, replace(pace.limits, **slow))


def test_fitts_law_has_its_constants():
    assert fitts(0.10) == pytest.approx(0.1 + 0.15 * log2(3))
    assert fitts(0.40) == pytest.approx(0.575, abs=1e-3)


def test_a_short_way_takes_fitts_time(pace):
    assert pace.stroke_time(0.02) == fitts(0.02)
    assert pace.way_time(0.10) == fitts(0.10)


def test_the_default_robots_hands_do_40_cm_in_half_a_second_and_a_little_at_best(pace):
    assert 0.40 <= pace.least_hand_time(0.40) <= 0.60
    assert 0.55 <= pace.way_time(0.40) <= 0.80
    assert 0.90 <= pace.stroke_time(0.40) <= 1.40


def test_a_longer_way_takes_longer(pace, sluggish):
    for robot in (pace, sluggish):
        for extent in EXTENTS:
            assert np.all(np.diff([robot.stroke_time(way, Expressivity(temporal=extent)) for way in WAYS]) > 0)


def test_no_extent_asks_for_more_than_the_servos_can_do(pace, sluggish):
    turns = (Turn(tilt=0.1), Turn(torsion=0.6), Turn(0.2, -0.2, 0.1))
    for robot in (pace, sluggish):
        for extent in EXTENTS:
            assert all(
                robot.stroke_time(way, Expressivity(temporal=extent)) >= robot.least_hand_time(way) for way in WAYS
            )
            for turn in turns:
                assert robot.turn_time("neck", turn, extent) >= robot.least_turn_time("neck", turn)


def test_temporal_extent_scales_where_the_servos_allow(pace):
    for extent in EXTENTS:
        assert pace.way_time(0.1, Expressivity(temporal=extent)) == pytest.approx(
            max(fitts(0.1) / HASTE**extent, FLOOR)
        )
    assert pace.turn_time("neck", Turn(tilt=0.2), -1.0) > pace.turn_time("neck", Turn(tilt=0.2))


def test_slow_servos_take_their_time(pace, sluggish):
    assert sluggish.least_hand_time(0.4) > 1.5 * pace.least_hand_time(0.4)
    assert sluggish.way_time(0.4) == pytest.approx(COMFORT * sluggish.least_hand_time(0.4))
    assert sluggish.turn_time("torso", Turn(tilt=0.3)) > 1.5 * pace.turn_time("torso", Turn(tilt=0.3))


def test_the_slowest_axis_of_a_turn_decides(pace):
    both = pace.least_turn_time("neck", Turn(torsion=0.8, tilt=0.05))
    assert both == pace.least_turn_time("neck", Turn(torsion=0.8)) > pace.least_turn_time("neck", Turn(tilt=0.05))


def test_what_a_robot_lacks_takes_no_time(robot, limits):
    arms = replace(robot, chains={name: robot.chains[name] for name in ("l_arm", "r_arm")})
    assert Pace(arms, limits(arms)).turn_time("neck", Turn(tilt=0.3)) == 0.0


def test_a_time_falls_with_the_extent_as_long_as_there_is_room():
    assert [hurry_time(0.6, 0.1, extent, 2.0) for extent in (-1.0, 0.0, 1.0)] == pytest.approx([1.2, 0.6, 0.3])
    assert [hurry_time(0.6, 0.4, extent, 2.0) for extent in (-1.0, 0.0, 1.0)] == pytest.approx([1.2, 0.6, 0.4])
    assert [hurry_time(0.3, 0.4, extent, 2.0) for extent in (-1.0, -0.1, 0.0, 1.0)] == pytest.approx(
        [0.6, 0.4, 0.4, 0.4]
    )
    assert np.all(np.diff([hurry_time(0.6, 0.4, extent, 2.0) for extent in np.linspace(-1, 1, 21)]) < 0)


def test_power_more_than_halves_a_stroke_where_the_servos_allow(pace, sluggish):
    for way in (0.05, 0.1, 0.2):
        usual, forceful, weak = (pace.stroke_time(way, Expressivity(power=power)) for power in (0.0, 1.0, -1.0))
        assert forceful == pytest.approx(max(usual / FORCE, pace.least_hand_time(way)))
        assert weak == pytest.approx(usual * WEAKNESS)
    assert sluggish.stroke_time(0.2, Expressivity(power=1.0)) == pytest.approx(sluggish.least_hand_time(0.2))


def test_people_take_their_time_where_servos_are_quick(pace):
    small = Turn(tilt=0.01)
    assert pace.turn_time("neck", small, usual=0.4) == 0.4
    assert pace.turn_time("neck", small) == pytest.approx(COMFORT * pace.least_turn_time("neck", small))


def test_ways_to_and_from_a_stroke_have_a_share_of_its_power(pace):
    weak = pace.way_time(0.4, Expressivity(power=-0.5))
    assert weak == pytest.approx(pace.way_time(0.4) * WEAKNESS ** (0.5 * CARRIED))
    assert pace.way_time(0.0, Expressivity(temporal=1.0)) == FLOOR
