from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.pace import COMFORT, FORCE, HASTE, WEAKNESS, Pace, hurry_time, natural_time
from kinesic.expressivity.turns import MERGE, add_turns, scale_turn, turn_angles


@pytest.fixture(scope="module")
def sluggish(pace):
    """The same robot with servos that give a quarter of the speed, acceleration and jerk."""
    slow = {name: sealed(getattr(pace.limits, name) / 4) for name in ("speed", "acceleration", "jerk")}
    return Pace(pace.robot, replace(pace.limits, **slow))


def test_the_default_robots_hands_do_40_cm_in_half_a_second(pace):
    assert 0.40 <= pace.least_hand_time(0.40) <= 0.60
    assert np.all(np.diff([pace.least_hand_time(way) for way in np.linspace(0.0, 0.8, 33)]) > 0)


def test_slow_servos_take_their_time(pace, sluggish):
    assert sluggish.least_hand_time(0.4) > 1.5 * pace.least_hand_time(0.4)
    assert sluggish.turn_time("torso", Turn(tilt=0.3)) > 1.5 * pace.turn_time("torso", Turn(tilt=0.3))


def test_no_extent_asks_for_more_than_the_servos_can_do(pace, sluggish):
    for robot in (pace, sluggish):
        for extent in (-1.0, 0.0, 0.5, 1.0):
            for turn in (Turn(tilt=0.1), Turn(torsion=0.6), Turn(0.2, -0.2, 0.1)):
                assert robot.turn_time("neck", turn, extent) >= robot.least_turn_time("neck", turn)
    assert pace.turn_time("neck", Turn(tilt=0.2), -1.0) > pace.turn_time("neck", Turn(tilt=0.2))


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


def test_power_divides_a_time_where_the_servos_allow_and_weakness_multiplies_it():
    assert natural_time(1.0, 0.1, 0.0, 1.0) == pytest.approx(1.0 / FORCE)
    assert natural_time(1.0, 0.6, 0.0, 1.0) == pytest.approx(0.6)
    assert natural_time(1.0, 0.1, 0.0, -1.0) == pytest.approx(WEAKNESS)
    assert natural_time(1.0, 0.1, 1.0, -0.5) == pytest.approx(WEAKNESS**0.5 / HASTE)
    assert natural_time(1.0, 0.6, 0.0, 1.0, room=1.2) == pytest.approx(0.72)
    assert natural_time(1.0, 0.6, 1.0, 1.0, room=1.2) == natural_time(1.0, 0.6, 1.0, 0.0, room=1.2)
    for least in (0.1, 0.6, 1.2):
        assert np.all(np.diff([natural_time(1.0, least, 0.0, power) for power in np.linspace(-1, 0.99, 21)]) <= 0.0)


def test_people_take_their_time_where_servos_are_quick(pace):
    small = Turn(tilt=0.01)
    assert pace.turn_time("neck", small, usual=0.4) == 0.4
    assert pace.turn_time("neck", small) == pytest.approx(COMFORT * pace.least_turn_time("neck", small))


@given(
    st.tuples(*3 * [st.floats(-0.5, 0.5)]),
    st.tuples(*3 * [st.floats(-0.5, 0.5)]),
    st.floats(0.01, 2.0),
    st.floats(0.2, 1.0),
)
def test_a_manageable_turn_fits_its_time_and_is_whole_where_there_is_enough(pace, before, desired, seconds, haste):
    start, end = Turn(*before), Turn(*desired)
    change = add_turns(end, scale_turn(start, -1.0))
    found = pace.manageable_turn("neck", start, end, seconds, haste)
    done = add_turns(found, scale_turn(start, -1.0))
    assert pace.least_turn_time("neck", done) <= max(haste * seconds, MERGE) * (1 + 1e-9)
    if pace.least_turn_time("neck", change) <= haste * seconds:
        assert turn_angles(found) == pytest.approx(turn_angles(end), abs=1e-12)
    part = np.array(turn_angles(done)) @ np.array(turn_angles(change))
    assert part >= 0.0
    np.testing.assert_allclose(np.cross(turn_angles(done), turn_angles(change)), 0.0, atol=1e-12)
