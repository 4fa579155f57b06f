"""Stop command during a performance of another program in real time."""

import os
import signal
import time

import numpy as np
import pytest

from kinesic.cli.servos import stop
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.address import find_supervisor
from kinesic.hardware.supervisor.channel import Channel
from kinesic.hardware.supervisor.state_machine import Stage

pytestmark = pytest.mark.realtime

WATCH_DURATION = 0.3  # [s] time during which the goals must not move
JOINTS = 4


@pytest.fixture
def moving(rig, monkeypatch: pytest.MonkeyPatch) -> Servos:
    """Start a performance, shielded from the robots of other tests."""

    def of_this_test() -> tuple[Channel, ...]:
        channel = find_supervisor(next(iter(rig.ports.values())), JOINTS)
        return () if channel is None else (channel,)

    monkeypatch.setattr(stop, "find_supervisors", of_this_test)
    servos = rig.opened()
    rig.write(servos, 30.0)
    rig.moving(servos)
    return servos


def test_stop_by_another_program_holds_the_robot_until_a_resume_request(rig, moving: Servos):
    assert stop.stop_robots() == 0
    stopped = time.monotonic()
    time.sleep(WATCH_DURATION)
    record = rig.record()
    after = record.times > stopped
    assert after.any()
    assert not np.ptp(record.goals[after], axis=0).any()
    assert record.torque[after].all()
    assert (moving.state().stage, moving.state().waits) == (Stage.STOPPED, "consent")
    moving.resume()
    rig.wait(lambda: moving.state().stage is Stage.ACTIVE)
    moving.release()
    moving.close()
    assert not rig.record().torque[-1].any()
    with pytest.raises(BusError, match=r"none of your programs drives servos from this machine.*switch the power off"):
        stop.stop_robots()


def test_error_reports_a_supervisor_that_does_not_stop_in_time(rig, moving: Servos, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(stop, "STANDSTILL_TIMEOUT", WATCH_DURATION)
    rig.freeze(moving)
    with pytest.raises(BusError, match=r"1 of 1 robots have not stopped in 0.3 s \(active\); switch the power off"):
        stop.stop_robots()
    os.kill(moving.pid, signal.SIGCONT)
    rig.wait(lambda: moving.state().stage is Stage.STOPPED)
    moving.release()
    moving.close()
