from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.servo import Drives

from ..reference.sim.driven_motion import DriveEffort, effort, power

ROBOT = Robot.load()
DRIVES = ROBOT.drives
HINGE_NAMES = ROBOT.skeleton.names
HINGE_COUNT = len(DRIVES)
IDLE_CURRENT = sum(drive.count * drive.servo.idle_a for drive in DRIVES)


def make_steady_steps(duty, load, *, steps=6):
    """Return steps with the same duty and load of all servos."""
    return DriveEffort(
        *(np.full((steps, HINGE_COUNT), value) for value in (duty, np.clip(duty, -1, 1), load)), np.ones(1)
    )


def taken(given, *, counts=(1, 3, 6), drives=DRIVES, span=0.004):
    spans = np.full(len(given.duties), span)
    spans[0] = 0.0  # the first posture follows no step
    return power(HINGE_NAMES, drives, given, spans=spans, counts=list(counts))[0]


def test_stalled_servo_at_full_duty_draws_its_stall_current():
    drawn = taken(make_steady_steps(1.0, 1.0))
    stall = sum(drive.count * drive.servo.stall_a for drive in DRIVES)
    assert drawn.peak == pytest.approx([stall + IDLE_CURRENT] * 3)
    assert drawn.mean == pytest.approx([stall + IDLE_CURRENT] * 3)
    assert drawn.energy == pytest.approx(12.0 * (stall + IDLE_CURRENT) * 5 * 0.004)


def test_holding_servo_draws_motor_current_times_duty():
    half = taken(make_steady_steps(-0.5, -0.5)).mean[0] - IDLE_CURRENT
    whole = taken(make_steady_steps(1.0, 1.0)).mean[0] - IDLE_CURRENT
    assert half == pytest.approx(whole / 4)


def test_servo_current_excludes_regenerated_current():
    assert taken(make_steady_steps(0.3, -0.2)).peak == pytest.approx([IDLE_CURRENT] * 3)


def test_servo_power_follows_the_dc_motor_model():
    errors, speeds = (
        np.array([[0.01] * HINGE_COUNT, [5.0] * HINGE_COUNT]),
        np.array([[0.2] * HINGE_COUNT, [0.0] * HINGE_COUNT]),
    )
    given = effort(DRIVES, errors, speeds)
    for k, drive in enumerate(DRIVES):
        duty = drive.gain * 0.01 - drive.rate_gain / drive.stall * 0.2
        assert given.duties[0, k] == pytest.approx(duty)
        assert given.loads[0, k] == pytest.approx(duty - 0.2 / drive.no_load)
        assert given.duties[1, k] > 1.0
        assert given.applied[1, k] == given.loads[1, k] == 1.0


def test_mean_and_peak_current_are_per_command_interval():
    given = make_steady_steps(1.0, 0.0)
    given.loads[:, 0] = [0.0, 0.2, 0.4, 0.1, 0.3, 0.2]
    stall = DRIVES[0].count * DRIVES[0].servo.stall_a
    drawn = taken(given)
    assert drawn.mean - IDLE_CURRENT == pytest.approx([0.0, 0.3 * stall, 0.2 * stall])
    assert drawn.peak - IDLE_CURRENT == pytest.approx([0.0, 0.4 * stall, 0.3 * stall])


def test_command_interval_without_steps_has_the_previous_current():
    given = make_steady_steps(1.0, 0.0)
    given.loads[:, 0] = [0.0, 0.2, 0.4, 0.1, 0.3, 0.2]
    stall = DRIVES[0].count * DRIVES[0].servo.stall_a
    drawn = taken(given, counts=(1, 1, 3, 3, 6))
    assert drawn.mean - IDLE_CURRENT == pytest.approx([0.0, 0.0, 0.3 * stall, 0.4 * stall, 0.2 * stall])


def test_servos_without_thermal_data_report_no_temperature():
    assert all(drive.servo.thermal is None for drive in DRIVES)
    assert taken(make_steady_steps(1.0, 1.0)).warming == {}


def test_winding_warms_with_copper_losses_as_first_order_lag():
    resistance, capacity, load = 5.0, 20.0, 0.5  # K/W, J/K and load ratio: arbitrary values
    first = DRIVES[0]
    warm = replace(first, servo=replace(first.servo, thermal=(resistance, capacity)))
    given = make_steady_steps(0.5, load, steps=2001)
    drawn = taken(given, counts=(1, 501, 2001), drives=Drives((warm, *DRIVES[1:])), span=0.1)
    loss = load**2 * first.servo.volt * first.servo.stall_a  # I^2 R with R = volt / stall current
    expected = loss * resistance * (1 - np.exp(-np.array([0.0, 50.0, 200.0]) / (resistance * capacity)))
    assert list(drawn.warming) == [HINGE_NAMES[0]]
    assert drawn.warming[HINGE_NAMES[0]] == pytest.approx(expected)


def test_each_servo_of_a_tandem_warms_by_its_own_losses():
    pair = next(k for k, drive in enumerate(DRIVES) if drive.count == 2)
    warm = replace(DRIVES[pair], servo=replace(DRIVES[pair].servo, thermal=(1.0, 1e-6)))
    drives = Drives(warm if k == pair else drive for k, drive in enumerate(DRIVES))
    servo = warm.servo
    rise = taken(make_steady_steps(0.5, 0.5), drives=drives).warming[HINGE_NAMES[pair]][-1]
    assert rise == pytest.approx(0.25 * servo.volt * servo.stall_a)


def test_default_robot_defines_its_power_supply():
    assert ROBOT.supply.volts == 12.0
    assert ROBOT.supply.amps > 2 * 4.0  # current of a fast gesture
