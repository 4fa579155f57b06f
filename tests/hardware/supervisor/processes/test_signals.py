"""Signals to planner and supervisor, and a full disk, with real processes."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from kinesic.hardware.bus.host import WATCHDOG_FACTORS
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.state_machine import Stage

from .conftest import PATIENCE, SETTINGS, WATCHDOG

pytestmark = pytest.mark.realtime

LONG_INTERRUPTION = 1.2  # [s] interruption after which a person must consent to motion
WATCH_DURATION = 0.5  # [s] time in which the robot would move again without a stop
MAX_LAG = 20  # [ticks] largest distance of a moving servo behind the goal, which it covers after a resume
LONGEST_WATCHDOG = WATCHDOG_FACTORS[-1] * WATCHDOG


@pytest.mark.parametrize(
    ("number", "handed_over"),
    [
        pytest.param(signal.SIGINT, (), id="SIGINT", marks=pytest.mark.soak),
        pytest.param(signal.SIGINT, ("60",), id="SIGINT, all handed over"),
        pytest.param(signal.SIGTERM, (), id="SIGTERM", marks=pytest.mark.soak),
        pytest.param(signal.SIGHUP, (), id="SIGHUP"),
    ],
)
def test_planner_ended_by_a_signal_leaves_the_arms_at_rest(rig, number: signal.Signals, handed_over: tuple[str, ...]):
    planner = rig.planner(*handed_over)
    rig.wait(rig.raised)
    planner.send_signal(number)
    assert planner.wait(PATIENCE) != 0
    rig.wait(lambda: rig.entered(Stage.CLOSED))
    assert rig.entered(Stage.FOLD) is not None
    rig.ends_at_rest()


def test_supervisor_ended_by_a_signal_leaves_the_arms_at_rest(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.moving(servos)
    os.kill(servos.pid, signal.SIGTERM)
    rig.wait(lambda: not servos.running)
    assert rig.entered(Stage.FOLD) is not None
    with pytest.raises(BusError, match="has released the servos and ended"):
        rig.write(servos, 0.0)
    servos.close()
    rig.ends_at_rest()


@pytest.mark.parametrize(
    "number", [signal.SIGTERM, *(pytest.param(item, marks=pytest.mark.soak) for item in (signal.SIGINT, signal.SIGHUP))]
)
def test_signal_to_an_idle_supervisor_releases_the_servos_before_it_ends(rig, number: signal.Signals):
    servos = rig.opened()
    os.kill(servos.pid, number)
    rig.wait(lambda: not servos.running)
    with pytest.raises(BusError, match="has released the servos and ended"):  # it has not died
        rig.write(servos, 0.0)
    servos.close()
    assert rig.entered(Stage.CLOSED)


@pytest.mark.soak
def test_robot_with_a_suspended_planner_holds_until_a_resume_request(rig):
    planner = rig.planner()
    rig.wait(rig.raised)
    stopped = time.monotonic()
    planner.send_signal(signal.SIGSTOP)
    for stage in (Stage.HOLD, Stage.FOLD, Stage.HOLD):  # which takes longer than goes on by itself
        rig.wait(lambda stage=stage, after=stopped: rig.entered(stage, after=after))
        stopped = rig.entered(stage, after=stopped)
    supervisor, resumed = rig.supervisor(), time.monotonic()
    planner.send_signal(signal.SIGCONT)
    rig.wait(lambda: supervisor.status().waits == "consent")
    time.sleep(WATCH_DURATION)
    record = rig.record()
    assert record.torque[record.times >= stopped].all()
    assert np.ptp(record.places[record.times >= resumed], axis=0).max() <= 2, "it moves again, and nobody has consented"
    rig.kill(planner.pid)
    planner.wait(PATIENCE)
    rig.wait(lambda: rig.entered(Stage.CLOSED))
    rig.ends_at_rest()


def test_servos_of_a_suspended_supervisor_hold_with_torque_until_a_resume_request(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    stopped = rig.freeze(servos)
    rig.wait(lambda: rig.record().stopped)
    time.sleep(LONG_INTERRUPTION)
    asleep = rig.record()
    tripped = asleep.times[(asleep.watchdogs == -1).all(axis=1) & (asleep.times > stopped)][0]
    assert tripped - stopped < LONGEST_WATCHDOG + 0.1 + 2 * asleep.stall(stopped, tripped)
    assert asleep.torque[-1].all()
    os.kill(servos.pid, signal.SIGCONT)
    resumed = time.monotonic()
    rig.wait(lambda: rig.entered(Stage.HOLD, after=resumed))
    time.sleep(WATCH_DURATION)
    record = rig.record()
    assert record.torque[record.times >= resumed].all()
    assert np.ptp(record.places[record.times >= resumed], axis=0).max() <= MAX_LAG
    assert servos.state().waits == "consent"
    servos.release()
    servos.close()
    rig.ends_at_rest()


@pytest.mark.soak
def test_full_disk_for_the_event_log_does_not_interrupt_the_servo_performance(rig):
    """/dev/full can be opened, but each write to it fails."""
    servos = Servos(rig.robot, rig.ports, settings=SETTINGS, log=Path("/dev/full"))
    rig.write(servos, 20.0)
    rig.moving(servos)
    servos.release()
    servos.close()
    rig.ends_at_rest()
    said = [note.text for note in servos.events() if note.kind == "journal"]
    assert said == ["/dev/full: No space left on device; events are lost"]
