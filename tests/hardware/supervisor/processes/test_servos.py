"""Performance on pseudo-terminals with the supervisor in a separate process."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.state_machine import Stage

pytestmark = pytest.mark.realtime

BUSES = ("left", "right")


def test_servos_follow_the_setpoints_of_a_performance_and_end_without_torque(rig):
    servos = rig.opened()
    assert servos.state().energised == 0
    rig.write(servos, 1.2)
    rig.moving(servos)
    assert np.isfinite(servos.positions()).all()
    time.sleep(0.2)
    history = servos.history()
    assert all(np.abs(item.angles - item.setpoints).max() < 0.2 for item in history if item.stage is Stage.ACTIVE)
    assert len({item.time for item in history}) > 30
    servos.close()
    assert not servos.running
    assert servos.state().stage is Stage.CLOSED
    record = rig.record()
    assert record.torque.max() == 1
    assert not record.torque[-1].any()
    came = (np.diff(record.torque, axis=0) > 0).nonzero()
    assert np.abs(record.goals[1:] - record.places[1:])[came].max() <= 2


def test_commands_are_written_without_waiting_for_a_suspended_supervisor(rig):
    """Write more commands than the channel holds, without any reader."""
    servos = rig.opened()
    os.kill(servos.pid, signal.SIGSTOP)
    rig.write(servos, 180.0)
    os.kill(servos.pid, signal.SIGCONT)
    rig.moving(servos)
    servos.release()
    servos.close()
    assert not rig.record().torque[-1].any()


def test_second_supervisor_on_a_port_in_use_is_refused(rig):
    servos = rig.opened()
    with pytest.raises(BusError, match="another program uses this port") as refused:
        rig.opened()
    assert len(str(refused.value).splitlines()) == len(BUSES)
    servos.close()


def test_missing_ports_are_refused_in_one_line_each(robot: Robot, tmp_path: Path):
    with pytest.raises(BusError) as refused:
        Servos(robot, {name: tmp_path / name for name in BUSES})
    assert [line.split(";")[0] for line in str(refused.value).splitlines()] == [
        f"{tmp_path / name}: no such port" for name in BUSES
    ]


def test_error_names_all_buses_if_one_has_no_port(robot: Robot, tmp_path: Path):
    with pytest.raises(BusError, match="little needs left=PATH, right=PATH"):
        Servos(robot, {"left": tmp_path})


def test_non_finite_servo_setpoints_are_refused(rig):
    servos = rig.opened()
    still = np.zeros(4)
    with pytest.raises(BusError, match="must be 4 finite numbers"):
        servos.write(Command(0.0, still, still, still, np.full(4, np.nan)))
    servos.close()
    assert not rig.record().torque.any()
