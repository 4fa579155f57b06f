"""Reactions of the supervisor to failing servos, wires and processes."""

from collections.abc import Callable

import numpy as np
import pytest

from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.faults import PlannedFault

from ..conftest import Desk

Make = Callable  # of a desk, see conftest
PERIOD = 0.01
TORQUE, GOAL, WATCHDOG = Register.TORQUE_ENABLE, Register.GOAL_POSITION, Register.BUS_WATCHDOG


def test_robot_holds_within_100_ms_of_the_death_of_its_planner_then_rests_and_switches_torque_off(desk: Make):
    made = desk().active()
    made.alive = False
    made.run(0.1)
    held = made.true(GOAL)
    made.run(0.01)
    assert (made.true(GOAL) == held).all() or made.stage is Stage.FOLD
    assert made.stage in (Stage.HOLD, Stage.FOLD)
    made.until(Stage.CLOSED)
    assert not made.true(TORQUE).any()
    rest = made.manifest.scale.ticks(made.manifest.rest[made.manifest.joints])
    assert np.abs(made.present_position - rest).max() <= 3


def test_torque_off_stop_request_reaches_all_servos_although_one_is_silent(desk: Make):
    made = desk(settings=SupervisorSettings(hopeless=1.0, pace=3.0)).active()
    made.plant.servos[2].mute = True
    made.channel.set("estop", 2)
    made.run(0.2)
    assert made.true(TORQUE).tolist() == [0, 0, 0, 0, 0]
    assert made.stage is Stage.RELEASE
    made.until(Stage.CLOSED)
    assert any("may still have torque" in line and "l_flexion" in line for line in made.kinds())


def test_servo_that_reboots_rejoins_without_a_jump_and_the_performance_goes_on(desk: Make):
    made = desk().active(4.0)
    made.jumps.clear()
    made.expose(PlannedFault("reboot", (3,)))
    made.run(0.3)
    assert made.stage in (Stage.DEGRADED, Stage.HOLD, Stage.ARM)
    made.until(Stage.ACTIVE, within=3.0)
    assert len(made.jumps) == 1
    assert made.jumps[0] <= 2
    assert made.true(TORQUE).all()
    assert (made.true(WATCHDOG) == 5).all()
    assert made.true(Register.PROFILE_VELOCITY).all()
    time = made.status.time
    made.run(0.5)
    assert made.status.time > time


def test_performance_continues_after_a_reboot_of_all_servos_at_once(desk: Make):
    made = desk().active(4.0)
    made.jumps.clear()
    made.expose(PlannedFault("reboot"))
    made.expose(PlannedFault("reboot"), bus="right")
    made.run(0.3)
    made.until(Stage.ACTIVE, within=5.0)
    assert len(made.jumps) == 5
    assert max(made.jumps) <= 2


def test_remaining_servos_move_to_rest_when_an_overloaded_servo_switches_its_torque_off(desk: Make):
    made = desk().active()
    made.run(0.6)
    assert made.raised.all()
    made.expose(PlannedFault("alert", (3,), value=HardwareError.OVERLOAD.value))
    made.cycle()
    made.cycle()
    assert made.stage is Stage.DEGRADED
    made.until(Stage.RELEASE)
    assert not made.raised[[0, 1, 3, 4]].any()
    made.until(Stage.CLOSED)
    assert not made.true(TORQUE).any()
    assert made.status.faulty


def test_low_supply_voltage_alone_makes_the_robot_move_to_rest_without_counting_as_failure(desk: Make):
    made = desk().active()
    made.run(0.6)
    made.expose(PlannedFault("alert", value=HardwareError.VOLTAGE.value))
    made.until(Stage.RELEASE)
    assert not made.raised.any()
    made.until(Stage.CLOSED)
    assert not made.status.faulty
    assert any(line.startswith("supply: ") for line in made.kinds())


def jammed(desk: Make) -> Desk:
    """Make a waiting robot with a raised limb and a blocked servo."""
    made = desk()
    made.open()
    made.perform(4.0, amplitude=0.9)
    made.until(Stage.ACTIVE)
    made.run(0.6)
    made.plant.physics.jammed[2] = True
    made.until(Stage.WAITING)
    return made


def test_stuck_servo_is_not_driven_into_its_overload_shutdown(desk: Make):
    made = jammed(desk)
    assert made.status.faulty
    assert made.status.waits == "confirmation"
    assert not made.true(Register.HARDWARE_ERROR_STATUS).any()
    assert made.true(TORQUE).all()
    assert not made.raised[[0, 1, 4]].any()
    made.alive = False
    made.channel.set("release", 1)
    made.run(1.5 * made.settings.patience)
    assert made.stage is Stage.WAITING
    made.channel.set("confirm", 1)
    made.until(Stage.CLOSED, within=1.0)
    assert not made.true(TORQUE).any()


def test_jammed_limb_that_is_freed_moves_to_rest_only_after_its_servo_reboots(desk: Make):
    made = jammed(desk)
    made.plant.physics.jammed[2] = False
    made.run(1.5 * made.settings.patience)
    assert made.stage is Stage.WAITING, "nobody knows that it is free"
    made.expose(PlannedFault("reboot", (3,)))
    made.until(Stage.ARM)
    made.until(Stage.HOLD)
    assert made.until(Stage.FOLD) > made.settings.patience - 0.1
    made.until(Stage.CLOSED)
    assert not made.raised.any()


def test_hot_servo_slows_the_performance_before_it_shuts_down(desk: Make):
    made = desk().active(10.0)
    made.plant.servos[2].electronics.celsius = 70.0
    made.expose(PlannedFault("overheat", (3,), value=3.0))
    scales = []
    while made.stage is Stage.ACTIVE:
        made.cycle()
        scales.append(made.status.scale)
    assert 0.0 < min(scales) < 0.5
    made.run(0.5)
    assert made.stage is Stage.HOLD
    assert made.status.hottest < 80
    assert not made.true(Register.HARDWARE_ERROR_STATUS).any()


@pytest.mark.parametrize("seconds", [0.05, pytest.param(0.4, marks=pytest.mark.soak), 1.2])
def test_robot_holds_or_resumes_within_250_ms_of_the_return_of_a_lost_port_and_keeps_torque(desk: Make, seconds: float):
    made = desk().active(4.0)
    made.expose(PlannedFault("unplug", seconds=seconds))
    made.until(Stage.LOST)
    lost = made.plant.time
    made.until(Stage.HOLD, Stage.APPROACH)
    assert made.plant.time - (lost + seconds) < 0.25
    assert made.true(TORQUE).all()
    assert (made.true(WATCHDOG) == 5).all()
    if seconds > 1.0:
        made.run(2 * made.settings.patience)
        assert made.stage is Stage.HOLD
        assert made.status.waits == "consent"
        assert not made.raised.any(), "it folds after its patience"
        made.consent()
    made.until(Stage.ACTIVE)
    assert made.true(TORQUE).all()


def test_servos_whose_port_is_lost_are_stopped_by_their_watchdog_with_torque_on(desk: Make):
    made = desk().active(4.0)
    made.expose(PlannedFault("unplug", seconds=1.0))
    made.run(0.16)
    here = made.present_position
    made.run(0.3)
    assert np.abs(made.present_position - here)[:4].max() <= 2
    assert (made.true(WATCHDOG)[:4] == -1).all()
    assert made.true(TORQUE).all()


def test_supervisor_ends_after_a_long_port_loss_and_leaves_torque_on(desk: Make):
    made = desk(settings=SupervisorSettings(hopeless=1.0)).active(4.0)
    made.expose(PlannedFault("unplug", seconds=100.0))
    made.until(Stage.CLOSED, within=5.0)
    assert made.true(TORQUE)[:4].all()


def test_servos_stopped_by_their_watchdog_are_adopted_and_continue(desk: Make):
    made = desk().active(4.0)
    made.pass_time(0.3)
    made.until(Stage.ADOPT)
    made.until(Stage.ACTIVE)
    assert made.true(TORQUE).all()
    assert not made.jumps or max(made.jumps) <= 2


def test_supervisor_that_is_killed_leaves_servos_stopped_and_the_next_supervisor_adopts_them(desk: Make):
    made = desk().active(4.0)
    made.pass_time(0.12)
    here = made.present_position
    made.pass_time(1.0)
    assert (made.true(WATCHDOG) == -1).all()
    assert np.abs(made.present_position - here).max() <= 1
    assert made.true(TORQUE).all()
    made.start()
    made.open()
    assert made.stage is Stage.ADOPT
    made.until(Stage.HOLD)
    assert made.true(TORQUE).all()
    assert np.abs(made.present_position - here).max() <= 2
    made.channel.set("ended", 1)
    made.until(Stage.CLOSED)
    assert not made.true(TORQUE).any()


def test_servos_with_torque_are_taken_over_and_servos_without_torque_get_torque(desk: Make):
    made = desk().active(4.0)
    made.pass_time(0.2)
    made.plant.servos[1].write(TORQUE.field.address, b"\0")
    made.start()
    made.jumps.clear()
    made.open()
    made.until(Stage.ARM)
    made.until(Stage.HOLD)
    made.run(0.1)
    assert made.true(TORQUE).all()
    assert len(made.jumps) == 1
    assert made.jumps[0] <= 2


def test_ending_robot_moves_to_rest_and_waits_for_a_silent_servo(desk: Make):
    made = desk(settings=SupervisorSettings(patience=0.5, consent=1.0, hopeless=1.0, pace=3.0)).active(4.0)
    made.run(0.4)
    made.plant.servos[2].mute = True
    made.channel.set("ended", 1)
    made.until(Stage.WAITING, within=15.0)
    assert made.true(TORQUE).all()
    made.plant.servos[2].mute = False
    made.until(Stage.CLOSED, within=5.0)
    assert not made.true(TORQUE).any()
    assert not made.raised.any()


def test_silent_servo_stops_the_performance_time_until_it_answers(desk: Make):
    made = desk().active(6.0)
    made.plant.servos[2].mute = True
    made.until(Stage.DEGRADED, within=0.2)
    made.run(0.5)
    stood = made.status.time
    assert made.status.scale == 0.0
    assert made.status.silent == 1
    made.run(0.2)
    assert made.status.time == stood
    made.plant.servos[2].mute = False
    made.until(Stage.ACTIVE, within=2.0)
    made.run(0.5)
    assert made.status.time > stood
    assert made.true(TORQUE).all()
