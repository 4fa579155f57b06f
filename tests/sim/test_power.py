from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.servo import Drives
from kinesic.sim.power import DriveEffort, effort, power

ROBOT = Robot.load()
DRIVES = ROBOT.drives
NAMES = ROBOT.skeleton.names
COUNT = len(DRIVES)
IDLE = sum(drive.count * drive.servo.idle_a for drive in DRIVES)


def steady(duty, load, *, steps=6):
    """All servos doing the same on each step."""
    return DriveEffort(*(np.full((steps, COUNT), value) for value in (duty, np.clip(duty, -1, 1), load)), np.ones(1))


def taken(given, *, counts=(1, 3, 6), drives=DRIVES, span=0.004):
    spans = np.full(len(given.duties), span)
    spans[0] = 0.0  # no step led to the first posture
    return power(NAMES, drives, given, spans=spans, counts=list(counts))[0]


def test_a_stalled_servo_at_full_duty_draws_its_stall_current():
    drawn = taken(steady(1.0, 1.0))
    stall = sum(drive.count * drive.servo.stall_a for drive in DRIVES)
    assert drawn.peak == pytest.approx([stall + IDLE] * 3)
    assert drawn.mean == pytest.approx([stall + IDLE] * 3)
    assert drawn.energy == pytest.approx(12.0 * (stall + IDLE) * 5 * 0.004)


def test_holding_draws_the_motors_current_for_the_share_of_time_that_the_bridge_is_on():
    half = taken(steady(-0.5, -0.5)).mean[0] - IDLE
    whole = taken(steady(1.0, 1.0)).mean[0] - IDLE
    assert half == pytest.approx(whole / 4)


def test_what_braking_gives_back_is_not_counted():
    assert taken(steady(0.3, -0.2)).peak == pytest.approx([IDLE] * 3)


def test_the_law_of_the_servos():
    errors, speeds = np.array([[0.01] * COUNT, [5.0] * COUNT]), np.array([[0.2] * COUNT, [0.0] * COUNT])
    given = effort(DRIVES, errors, speeds)
    for k, drive in enumerate(DRIVES):
        duty = drive.gain * 0.01 - drive.rate_gain / drive.stall * 0.2
        assert given.duties[0, k] == pytest.approx(duty)
        assert given.loads[0, k] == pytest.approx(duty - 0.2 / drive.no_load)
        assert given.duties[1, k] > 1.0
        assert given.applied[1, k] == given.loads[1, k] == 1.0


def test_mean_and_peak_are_those_of_each_interval():
    given = steady(1.0, 0.0)
    given.loads[:, 0] = [0.0, 0.2, 0.4, 0.1, 0.3, 0.2]
    stall = DRIVES[0].count * DRIVES[0].servo.stall_a
    drawn = taken(given)
    assert drawn.mean - IDLE == pytest.approx([0.0, 0.3 * stall, 0.2 * stall])
    assert drawn.peak - IDLE == pytest.approx([0.0, 0.4 * stall, 0.3 * stall])


def test_an_interval_without_length_is_as_the_step_before():
    given = steady(1.0, 0.0)
    given.loads[:, 0] = [0.0, 0.2, 0.4, 0.1, 0.3, 0.2]
    stall = DRIVES[0].count * DRIVES[0].servo.stall_a
    drawn = taken(given, counts=(1, 1, 3, 3, 6))
    assert drawn.mean - IDLE == pytest.approx([0.0, 0.0, 0.3 * stall, 0.4 * stall, 0.2 * stall])


def test_no_servo_of_ours_has_thermal_figures_so_none_is_guessed():
    assert all(drive.servo.thermal is None for drive in DRIVES)
    assert taken(steady(1.0, 1.0)).warming == {}


def test_a_winding_warms_with_its_copper_losses_to_first_order():
    resistance, capacity, load = 5.0, 20.0, 0.5  # K/W, J/K: made up
    first = DRIVES[0]
    warm = replace(first, servo=replace(first.servo, thermal=(resistance, capacity)))
    given = steady(0.5, load, steps=2001)
    drawn = taken(given, counts=(1, 501, 2001), drives=Drives((warm, *DRIVES[1:])), span=0.1)
    loss = load**2 * first.servo.volt * first.servo.stall_a  # I^2 R with R = volt / stall current
    expected = loss * resistance * (1 - np.exp(-np.array([0.0, 50.0, 200.0]) / (resistance * capacity)))
    assert list(drawn.warming) == [NAMES[0]]
    assert drawn.warming[NAMES[0]] == pytest.approx(expected)


def test_each_servo_of_a_tandem_warms_by_its_own_losses():
    pair = next(k for k, drive in enumerate(DRIVES) if drive.count == 2)
    warm = replace(DRIVES[pair], servo=replace(DRIVES[pair].servo, thermal=(1.0, 1e-6)))
    drives = Drives(warm if k == pair else drive for k, drive in enumerate(DRIVES))
    servo = warm.servo
    rise = taken(steady(0.5, 0.5), drives=drives).warming[NAMES[pair]][-1]
    assert rise == pytest.approx(0.25 * servo.volt * servo.stall_a)


def test_the_default_robot_says_what_feeds_it():
    assert ROBOT.supply.volts == 12.0
    assert ROBOT.supply.amps > 2 * 4.0  # what a brisk gesture takes
