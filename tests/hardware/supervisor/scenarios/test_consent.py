"""Resume requests after emergency stops and long interruptions."""

from collections.abc import Callable
from itertools import product

import pytest

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import PlannedFault

from ..conftest import Desk

Make = Callable[..., Desk]  # see conftest
PERIOD = 0.01
TORQUE, GOAL, WATCHDOG = Register.TORQUE_ENABLE, Register.GOAL_POSITION, Register.BUS_WATCHDOG


def test_emergency_stop_holds_the_goals_within_100_ms_until_a_release(desk: Make):
    made = desk().active()
    made.channel.set("estop", 1)
    made.run(0.1)
    held = made.true(GOAL)
    made.run(1.0)
    assert (made.true(GOAL) == held).all()
    assert made.stage is Stage.STOPPED
    assert made.true(TORQUE).all()
    made.channel.set("release", 1)
    made.until(Stage.FOLD, within=0.1)
    made.until(Stage.CLOSED)
    assert not made.true(TORQUE).any()
    assert not made.raised.any()


def test_emergency_stop_cancels_an_earlier_release(desk: Make):
    made = desk().active()
    made.channel.set("release", 1)
    made.until(Stage.FOLD)
    made.channel.set("estop", 1)
    made.run(1.2 * made.settings.patience)
    assert made.stage is Stage.STOPPED
    assert made.status.waits == "consent"
    made.channel.set("release", 2)
    made.until(Stage.CLOSED)
    assert not made.raised.any()


def test_performance_resumes_after_an_emergency_stop_on_a_resume_request(desk: Make):
    made = desk().active(6.0)
    made.channel.set("estop", 1)
    made.run(1.2 * made.settings.patience)
    assert made.stage is Stage.STOPPED
    time = made.status.time
    made.consent()
    made.until(Stage.ACTIVE)
    made.run(0.5)
    assert made.status.time > time
    made.channel.set("estop", 1)
    made.run(0.1)
    assert made.stage is Stage.STOPPED


def test_simultaneous_emergency_stop_overrides_a_resume_request(desk: Make):
    made = desk().active(6.0)
    made.channel.set("estop", 1)
    made.run(0.5)
    made.consent()
    made.channel.set("estop", 1)
    made.run(1.0)
    assert made.stage is Stage.STOPPED


def test_torque_off_stop_request_switches_torque_off_within_30_ms(desk: Make):
    made = desk().active()
    made.channel.set("estop", 2)
    made.run(0.03)
    assert not made.true(TORQUE).any()


@pytest.mark.parametrize("ended", [False, pytest.param(True, marks=pytest.mark.soak)])
def test_robot_stopped_in_an_emergency_moves_to_rest_after_its_planner_dies(desk: Make, ended: bool):
    made = desk().active(4.0)
    made.run(0.5)
    made.channel.set("estop", 1)
    made.run(0.2)
    made.channel.set("ended", int(ended))
    made.run(1.0)
    assert made.stage is Stage.STOPPED
    assert made.raised.any()
    held = made.true(GOAL)
    made.alive = False
    made.run(made.settings.patience - 0.1)
    assert (made.true(GOAL) == held).all()
    assert made.true(TORQUE).all()
    made.until(Stage.FOLD, within=0.5)
    made.until(Stage.RELEASE)
    assert not made.raised.any()
    made.until(Stage.CLOSED, within=1.0)
    assert not made.true(TORQUE).any()


def test_torque_off_stop_request_after_an_emergency_stop_switches_torque_off(desk: Make):
    made = desk().active()
    made.channel.set("estop", 1)
    made.run(0.2)
    assert made.true(TORQUE).all()
    made.channel.set("estop", 2)
    made.run(0.05)
    assert not made.true(TORQUE).any()


def test_other_robot_on_a_reopened_port_is_neither_moved_nor_released(desk: Make):
    made = desk().active(4.0)
    made.expose(PlannedFault("unplug", seconds=0.5))
    made.until(Stage.LOST)
    left = made.plant.servos[:4]
    goals = made.true(GOAL)[:4]
    for servo in left:
        servo.memory[Register.MAX_VOLTAGE_LIMIT] -= 1
    made.run(1.5)
    assert made.stage in (Stage.LOST, Stage.IDENTIFY)
    assert made.status.waits in ("port", "nothing")
    assert any("another robot is behind this port" in line for line in made.kinds())
    assert (made.true(GOAL)[:4] == goals).all()
    assert (made.true(WATCHDOG)[:4] == -1).all()
    for servo in left:
        servo.memory[Register.MAX_VOLTAGE_LIMIT] += 1
    made.until(Stage.HOLD)
    made.run(1.0)
    assert made.status.waits == "consent"


def test_performance_of_a_process_suspended_for_long_needs_a_resume_request(desk: Make):
    made = desk().active(4.0)
    made.run(0.5)
    made.pass_time(12.0)
    made.run(2.5 * made.settings.patience)
    assert made.stage is Stage.HOLD
    assert made.status.waits == "consent"
    assert any(line.startswith("paused: ") for line in made.kinds())
    made.consent()
    made.until(Stage.ACTIVE)


def without_commands(desk: Make) -> Desk:
    """Make a robot whose commands end in the middle of a performance of 4 s."""
    made = desk()
    made.open()
    for k in range(100):
        made.channel.write(k * PERIOD, made.goals(k * PERIOD, 4.0))
    made.until(Stage.ACTIVE)
    made.until(Stage.HOLD)
    return made


def test_commands_after_a_long_gap_need_a_resume_request(desk: Make):
    made = without_commands(desk)
    made.run(1.5)
    for k in range(100, 400):
        made.channel.write(k * PERIOD, made.goals(k * PERIOD, 4.0))
    made.run(1.0)
    assert made.stage is Stage.HOLD
    assert made.status.waits == "consent"
    made.consent()
    made.until(Stage.ACTIVE)


@pytest.mark.parametrize(("slowly", "waits"), [(0.9, False), pytest.param(3.0, True, marks=pytest.mark.soak)])
def test_commands_slower_than_real_time_after_a_standstill_need_a_resume_request(
    desk: Make, slowly: float, waits: bool
):
    made = without_commands(desk)
    for k in range(100, 160):  # time runs again when there are 0.5 s of them
        made.channel.write(k * PERIOD, made.goals(k * PERIOD, 4.0))
        made.run(slowly * PERIOD)
    for k in range(160, 400):
        made.channel.write(k * PERIOD, made.goals(k * PERIOD, 4.0))
    made.run(1.0)
    assert (made.status.waits == "consent") == waits
    assert made.stage is (Stage.HOLD if waits else Stage.ACTIVE)
    made.consent()
    made.until(Stage.ACTIVE)


SAMPLED_OUTAGES = {(0.6, False), (1.05, True)}  # duration [s] and frozen flag of outages tested in every run
OUTAGE_DURATIONS = (0.1, 0.3, 0.6, 1.05, 2.0, 5.0, 10.0)  # [s] durations of port outages


@pytest.mark.parametrize(
    ("seconds", "frozen"),
    [
        pytest.param(*outage, marks=[pytest.mark.soak] * (outage not in SAMPLED_OUTAGES))
        for outage in product(OUTAGE_DURATIONS, (False, True))
    ],
)
def test_bus_outage_does_not_count_as_a_stuck_servo(desk: Make, seconds: float, frozen: bool):
    made = desk().active(4.0)
    if frozen:
        made.expose(PlannedFault("lost", seconds=seconds), PlannedFault("lost", seconds=seconds, way="request"))
    else:
        made.expose(PlannedFault("silent", seconds=seconds))
    made.run(seconds + 1.0)
    assert not made.status.faulty, made.kinds()[-12:]
    assert (made.status.waits == "consent") == (seconds > 1.0)
    made.consent()
    made.until(Stage.ACTIVE, Stage.HOLD)
    assert not made.status.faulty
