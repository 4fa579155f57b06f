"""Signals to planner and supervisor, and a full disk: with real processes, and the posture of the arms afterwards."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.state_machine import Stage

from .conftest import SETTINGS, Record

pytestmark = pytest.mark.realtime

PATIENCE = 60.0  # [s] that a loaded machine may take for anything
NEAR = 10  # [ticks] of rest: less than a degree


def at_rest_and_limp(robot: Robot, record: Record) -> bool:
    manifest = Manifest.of(robot)
    rest = manifest.scale.ticks(manifest.rest[manifest.joints])
    return not record.torque[-1].any() and bool((np.abs(record.places[-1] - rest) <= NEAR).all())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_a_planner_that_gets_a_signal_leaves_the_arms_at_rest(rig, robot: Robot, number: signal.Signals):
    planner = rig.planner()
    time.sleep(0.5)
    planner.send_signal(number)
    assert planner.wait(PATIENCE) != 0
    rig.wait(lambda: rig.entered(Stage.CLOSED))
    assert rig.entered(Stage.FOLD) is not None
    assert at_rest_and_limp(robot, rig.record())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_supervisor_that_gets_a_signal_leaves_the_arms_at_rest(rig, robot: Robot, number: signal.Signals):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.moving(servos)
    os.kill(servos.pid, number)
    rig.wait(lambda: not servos.running)
    servos.close()
    assert at_rest_and_limp(robot, rig.record())


def test_a_planner_that_is_stopped_is_held_and_goes_on_only_with_consent(rig, robot: Robot):
    planner = rig.planner()
    time.sleep(0.5)
    stopped = time.monotonic()
    planner.send_signal(signal.SIGSTOP)
    rig.wait(lambda: rig.entered(Stage.HOLD, after=stopped))
    time.sleep(2.0)
    planner.send_signal(signal.SIGCONT)
    resumed = time.monotonic()
    time.sleep(1.0)
    record = rig.record()
    assert record.torque[record.times >= stopped].all()
    assert np.ptp(record.places[record.times >= resumed], axis=0).max() <= 2, "it moves again, and nobody has consented"
    rig.kill(planner.pid)
    planner.wait(PATIENCE)
    rig.wait(lambda: rig.entered(Stage.CLOSED))
    assert at_rest_and_limp(robot, rig.record())


def test_servos_of_a_stopped_supervisor_stop_with_torque_and_go_on_only_with_consent(rig, robot: Robot):
    servos = rig.opened()
    rig.write(servos, 60.0)
    rig.moving(servos)
    os.kill(servos.pid, signal.SIGSTOP)
    time.sleep(2.0)
    asleep = rig.record()
    assert (asleep.watchdogs[-1] == -1).all()
    assert asleep.torque[-1].all()
    os.kill(servos.pid, signal.SIGCONT)
    resumed = time.monotonic()
    rig.wait(lambda: rig.entered(Stage.HOLD, after=resumed))
    time.sleep(1.0)
    record = rig.record()
    assert record.torque[record.times >= resumed].all()
    assert np.ptp(record.places[record.times >= resumed], axis=0).max() <= 5
    servos.release()
    servos.close()
    assert at_rest_and_limp(robot, rig.record())


def test_a_full_disk_stops_no_robot(rig, robot: Robot):
    """/dev/full opens, and refuses every byte."""
    servos = Servos(robot, rig.ports, settings=SETTINGS, log=Path("/dev/full"))
    rig.write(servos, 20.0)
    rig.moving(servos)
    servos.release()
    servos.close()
    assert at_rest_and_limp(robot, rig.record())
    said = [note.text for note in servos.events() if note.kind == "journal"]
    assert said == ["/dev/full: No space left on device; events are lost"]
