from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.pace import (
    COMFORT_MARGIN,
    POWER_FACTOR,
    TEMPORAL_FACTOR,
    WEAKNESS_FACTOR,
    Pace,
    natural_time,
    scale_time,
)
from kinesic.expressivity.turns import MIN_KEY_SPACING, add_turns, scale_turn, turn_angles


@pytest.fixture(scope="module")
def sluggish(pace):
    """Return the robot with a quarter of the velocity, acceleration and jerk limits."""
    slow = {name: sealed(getattr(pace.limits, name) / 4) for name in ("speed", "acceleration", "jerk")}
    return Pace(pace.robot, replace(pace.limits, **slow))


def test_default_robot_moves_a_hand_by_40_cm_in_0_4_to_0_6_s(pace):
    assert 0.40 <= pace.least_hand_time(0.40) <= 0.60
    assert np.all(np.diff([pace.least_hand_time(way) for way in np.linspace(0.0, 0.8, 33)]) > 0)


def test_slower_servos_need_more_time_for_hand_travel_and_trunk_rotation(pace, sluggish):
    assert sluggish.least_hand_time(0.4) > 1.5 * pace.least_hand_time(0.4)
    assert sluggish.turn_time("torso", Turn(tilt=0.3)) > 1.5 * pace.turn_time("torso", Turn(tilt=0.3))


def test_neck_rotation_keeps_its_minimum_servo_time_at_any_temporal_extent(pace, sluggish):
    for robot in (pace, sluggish):
        for extent in (-1.0, 0.0, 0.5, 1.0):
            for turn in (Turn(tilt=0.1), Turn(torsion=0.6), Turn(0.2, -0.2, 0.1)):
                assert robot.turn_time("neck", turn, extent) >= robot.least_turn_time("neck", turn)
    assert pace.turn_time("neck", Turn(tilt=0.2), -1.0) > pace.turn_time("neck", Turn(tilt=0.2))


def test_slowest_joint_axis_determines_the_time_of_a_trunk_or_head_rotation(pace):
    both = pace.least_turn_time("neck", Turn(torsion=0.8, tilt=0.05))
    assert both == pace.least_turn_time("neck", Turn(torsion=0.8)) > pace.least_turn_time("neck", Turn(tilt=0.05))


def test_rotation_of_a_missing_joint_chain_takes_no_time(robot, limits):
    arms = replace(robot, chains={name: robot.chains[name] for name in ("l_arm", "r_arm")})
    assert Pace(arms, limits(arms)).turn_time("neck", Turn(tilt=0.3)) == 0.0


def test_movement_duration_decreases_with_temporal_extent_down_to_the_minimum():
    assert [scale_time(0.6, 0.1, extent, 2.0) for extent in (-1.0, 0.0, 1.0)] == pytest.approx([1.2, 0.6, 0.3])
    assert [scale_time(0.6, 0.4, extent, 2.0) for extent in (-1.0, 0.0, 1.0)] == pytest.approx([1.2, 0.6, 0.4])
    assert [scale_time(0.3, 0.4, extent, 2.0) for extent in (-1.0, -0.1, 0.0, 1.0)] == pytest.approx(
        [0.6, 0.4, 0.4, 0.4]
    )
    assert np.all(np.diff([scale_time(0.6, 0.4, extent, 2.0) for extent in np.linspace(-1, 1, 21)]) < 0)


def test_high_power_shortens_movement_durations_and_low_power_lengthens_them():
    assert natural_time(1.0, 0.1, 0.0, 1.0) == pytest.approx(1.0 / POWER_FACTOR)
    assert natural_time(1.0, 0.6, 0.0, 1.0) == pytest.approx(0.6)
    assert natural_time(1.0, 0.1, 0.0, -1.0) == pytest.approx(WEAKNESS_FACTOR)
    assert natural_time(1.0, 0.1, 1.0, -0.5) == pytest.approx(WEAKNESS_FACTOR**0.5 / TEMPORAL_FACTOR)
    assert natural_time(1.0, 0.6, 0.0, 1.0, margin=1.2) == pytest.approx(0.72)
    assert natural_time(1.0, 0.6, 1.0, 1.0, margin=1.2) == natural_time(1.0, 0.6, 1.0, 0.0, margin=1.2)
    for least in (0.1, 0.6, 1.2):
        assert np.all(np.diff([natural_time(1.0, least, 0.0, power) for power in np.linspace(-1, 0.99, 21)]) <= 0.0)


def test_neck_rotation_takes_at_least_the_usual_human_duration(pace):
    small = Turn(tilt=0.01)
    assert pace.turn_time("neck", small, usual=0.4) == 0.4
    assert pace.turn_time("neck", small) == pytest.approx(COMFORT_MARGIN * pace.least_turn_time("neck", small))


@given(
    st.tuples(*3 * [st.floats(-0.5, 0.5)]),
    st.tuples(*3 * [st.floats(-0.5, 0.5)]),
    st.floats(0.01, 2.0),
    st.floats(0.2, 1.0),
)
def test_trunk_or_head_rotation_is_reduced_to_fit_the_available_time(pace, before, desired, seconds, haste):
    start, end = Turn(*before), Turn(*desired)
    change = add_turns(end, scale_turn(start, -1.0))
    result = pace.manageable_turn("neck", start, end, seconds, haste)
    done = add_turns(result, scale_turn(start, -1.0))
    assert pace.least_turn_time("neck", done) <= max(haste * seconds, MIN_KEY_SPACING) * (1 + 1e-9)
    if pace.least_turn_time("neck", change) <= haste * seconds:
        assert turn_angles(result) == pytest.approx(turn_angles(end), abs=1e-12)
    part = np.array(turn_angles(done)) @ np.array(turn_angles(change))
    assert part >= 0.0
    np.testing.assert_allclose(np.cross(turn_angles(done), turn_angles(change)), 0.0, atol=1e-12)
