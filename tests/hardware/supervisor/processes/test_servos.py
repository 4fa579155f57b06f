"""Real processes over pseudo-terminals. Times are compared with what the machine's own stalls allow at that moment."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.stages import Stage
from kinesic.hardware.wire import BusError

PATIENCE = 60.0  # [s] that a loaded machine may take for anything
WATCHDOG = 0.2
BUSES = ("left", "right")


def test_a_performance_ends_at_rest_and_no_servo_is_energised(rig):
    servos = rig.opened()
    assert servos.state().energised == 0
    rig.write(servos, 2.0)
    rig.moving(servos)
    assert np.isfinite(servos.positions()).all()
    time.sleep(0.5)
    history = servos.history()
    assert all(np.abs(told.angles - told.goals).max() < 0.2 for told in history if told.stage is Stage.ACTIVE)
    assert len({told.time for told in history}) > 30
    servos.close()
    assert not servos.running
    assert servos.state().stage is Stage.CLOSED
    record = rig.end()
    assert record.torque.max() == 1
    assert not record.torque[-1].any()
    came = (np.diff(record.torque, axis=0) > 0).nonzero()
    assert np.abs(record.goals[1:] - record.places[1:])[came].max() <= 2


def test_the_supervisor_killed_leaves_servos_stopped_with_torque_and_the_next_one_adopts_them(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.moving(servos)
    killed = rig.kill(servos.pid)
    rig.wait(lambda: not servos.running)
    with pytest.raises(BusError, match="have stopped with torque on"):
        rig.write(servos, 0.0)
    time.sleep(0.5)
    with pytest.raises(BusError, match="have stopped with torque on"):
        servos.close()
    heir = rig.opened()
    adopted = rig.entered(Stage.ADOPT, after=killed)
    assert adopted is not None
    rig.wait(lambda: heir.state().stage is Stage.HOLD)
    time.sleep(0.2)
    released = time.monotonic()
    heir.close()
    record = rig.end()
    slack = 2 * record.stall(killed, killed + 0.5)
    stopped = (record.times >= killed + WATCHDOG + 0.02 + slack) & (record.times < released)
    assert (record.watchdogs[stopped][0] == -1).all()
    assert np.ptp(record.places[stopped], axis=0).max() <= 2
    assert (record.torque[(record.times >= killed) & (record.times < released)] == 1).all()
    assert not record.torque[-1].any()


def test_the_planner_killed_is_held_and_then_folded_and_released(rig):
    planner = rig.planner()
    time.sleep(0.5)
    killed = rig.kill(planner.pid)
    planner.wait(PATIENCE)
    rig.wait(lambda: rig.entered(Stage.CLOSED))
    record = rig.end()
    held, folded = rig.entered(Stage.HOLD, after=killed), rig.entered(Stage.FOLD, after=killed)
    assert held is not None
    assert folded is not None
    assert held - killed < 0.1 + 2 * record.stall(killed, killed + 0.2)
    between = (record.times > held + 0.01) & (record.times < folded)
    assert not between.any() or np.ptp(record.goals[between], axis=0).max() <= 1
    assert not record.torque[-1].any()
    assert np.abs(record.goals[-1] - record.places[-1]).max() <= 3


def test_a_port_that_is_pulled_and_put_back_is_held_and_goes_on(rig):
    servos = rig.opened()
    rig.write(servos, 30.0)
    rig.moving(servos)
    rig.strike("unplug left 0.5")
    pulled = time.monotonic()
    rig.wait(lambda: rig.entered(Stage.HOLD, after=pulled))
    rig.wait(lambda: servos.state().stage is Stage.ACTIVE)
    released = time.monotonic()
    servos.release()
    servos.close()
    record = rig.end()
    away = record.times[(record.plugged[:, 0] == 0) & (record.times > pulled) & (record.times < released)]
    held = rig.entered(Stage.HOLD, after=away[-1])
    assert held is not None
    assert held - away[-1] < 0.25 + 2 * record.stall(away[-1], held)
    assert (record.torque[(record.times >= pulled) & (record.times < released)] == 1).all()
    assert not record.torque[-1].any()


def test_a_servo_that_reboots_rejoins_without_a_jump(rig):
    servos = rig.opened()
    rig.write(servos, 30.0)
    rig.moving(servos)
    struck = time.monotonic()
    rig.strike("reboot left 3 0.13")
    rig.wait(lambda: rig.entered(Stage.ARM, after=struck))
    rig.wait(lambda: servos.state().stage is Stage.ACTIVE)
    released = time.monotonic()
    servos.release()
    servos.close()
    record = rig.end()
    window = (record.times >= struck) & (record.times < released)
    torque, goals, places = (each[window][:, 2] for each in (record.torque, record.goals, record.places))
    back = int(np.flatnonzero(np.diff(torque) > 0)[0]) + 1
    assert abs(goals[back] - places[back]) <= 2
    assert np.abs(places[back : back + 10] - places[back - 1]).max() <= 2
    assert torque[-1] == 1


def test_ctrl_c_folds_at_once_whatever_was_still_to_be_performed(rig):
    planner = rig.planner("60")
    time.sleep(0.5)
    planner.send_signal(signal.SIGINT)
    assert planner.wait(PATIENCE) != 0
    rig.wait(lambda: rig.entered(Stage.CLOSED))
    assert rig.entered(Stage.FOLD) is not None
    assert not rig.end().torque[-1].any()


def test_a_supervisor_that_is_asked_to_end_folds_and_lets_go(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.moving(servos)
    os.kill(servos.pid, signal.SIGTERM)
    rig.wait(lambda: not servos.running)
    assert rig.entered(Stage.FOLD) is not None
    with pytest.raises(BusError, match="has released the servos and ended"):
        rig.write(servos, 0.0)
    servos.close()
    assert not rig.end().torque[-1].any()


def test_an_emergency_stop_holds_until_it_is_released(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.moving(servos)
    servos.stop()
    rig.wait(lambda: servos.state().stage is Stage.STOPPED)
    assert servos.state().energised == 5
    servos.release()
    servos.close()
    assert not rig.end().torque[-1].any()


def test_writing_never_waits_for_the_supervisor(rig):
    """Three times as many commands as fit, while nobody takes any."""
    servos = rig.opened()
    os.kill(servos.pid, signal.SIGSTOP)
    rig.write(servos, 250.0)
    os.kill(servos.pid, signal.SIGCONT)
    rig.moving(servos)
    servos.release()
    servos.close()
    assert not rig.end().torque[-1].any()


def test_a_port_is_for_one_supervisor_only(rig):
    servos = rig.opened()
    with pytest.raises(BusError, match="another program uses this port") as refused:
        rig.opened()
    assert len(str(refused.value).splitlines()) == len(BUSES)
    servos.close()


def test_ports_that_are_not_there_are_refused_in_one_line_each(robot: Robot, tmp_path: Path):
    with pytest.raises(BusError) as refused:
        Servos(robot, {name: tmp_path / name for name in BUSES})
    assert [line.split(";")[0] for line in str(refused.value).splitlines()] == [
        f"{tmp_path / name}: no such port" for name in BUSES
    ]


def test_a_servo_that_fails_is_the_reason_that_is_given(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.moving(servos)
    rig.strike("alert left 3 32")
    rig.wait(lambda: not servos.running)
    assert servos.state().faulty
    with pytest.raises(BusError, match="released the servos and ended: l_flexion: shut down"):
        rig.write(servos, 0.0)
    servos.close()
    assert not rig.end().torque[-1].any()


def test_every_bus_needs_a_port(robot: Robot, tmp_path: Path):
    with pytest.raises(BusError, match="little needs left=PATH, right=PATH"):
        Servos(robot, {"left": tmp_path})


def test_goals_that_are_no_numbers_are_refused(rig):
    servos = rig.opened()
    still = np.zeros(4)
    with pytest.raises(BusError, match="must be 4 finite numbers"):
        servos.write(Command(0.0, still, still, still, np.full(4, np.nan)))
    servos.close()
    assert not rig.end().torque.any()
