"""Planner or supervisor end while servos perform. Times are compared with what the machine's own stalls allow."""

import os
import signal
import time

import numpy as np
import pytest

from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.state_machine import Stage

pytestmark = pytest.mark.realtime

PATIENCE = 60.0  # [s] that a loaded machine may take for anything
WATCHDOG = 0.2


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
    record = rig.record()
    slack = 2 * record.stall(killed, killed + 0.5)
    stopped = (record.times >= killed + WATCHDOG + 0.02 + slack) & (record.times < released)
    assert (record.watchdogs[stopped][0] == -1).all()
    assert np.ptp(record.places[stopped], axis=0).max() <= 2
    assert (record.torque[(record.times >= killed) & (record.times < released)] == 1).all()
    assert not record.torque[-1].any()


@pytest.mark.parametrize("handed_over", [(), ("60",)], ids=["0.7 s", "all"])
def test_the_planner_killed_is_held_and_then_folded_and_released(rig, handed_over: tuple[str, ...]):
    planner = rig.planner(*handed_over)
    time.sleep(0.5)
    killed = rig.kill(planner.pid)
    planner.wait(PATIENCE)
    rig.wait(lambda: rig.entered(Stage.CLOSED))
    record = rig.record()
    held, folded = rig.entered(Stage.HOLD, after=killed), rig.entered(Stage.FOLD, after=killed)
    assert held is not None
    assert folded is not None
    assert held - killed < 0.1 + 2 * record.stall(killed, killed + 0.2)
    between = (record.times > held + 0.01) & (record.times < folded)
    assert not between.any() or np.ptp(record.goals[between], axis=0).max() <= 1
    assert not record.torque[-1].any()
    assert np.abs(record.goals[-1] - record.places[-1]).max() <= 3


def test_ctrl_c_folds_at_once_whatever_was_still_to_be_performed(rig):
    planner = rig.planner("60")
    time.sleep(0.5)
    planner.send_signal(signal.SIGINT)
    assert planner.wait(PATIENCE) != 0
    rig.wait(lambda: rig.entered(Stage.CLOSED))
    assert rig.entered(Stage.FOLD) is not None
    assert not rig.record().torque[-1].any()


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
    assert not rig.record().torque[-1].any()
