"""Faults of wires and servos during a performance.

Times are compared with the machine's own stalls.
"""

import time
from dataclasses import replace

import numpy as np
import pytest

from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.address import find_supervisor
from kinesic.hardware.supervisor.state_machine import Stage

from .conftest import SETTINGS, lateness

pytestmark = pytest.mark.realtime


def test_robot_holds_while_its_port_is_unplugged_and_continues_afterwards(rig):
    servos = rig.opened()
    rig.write(servos, 30.0)
    rig.moving(servos)
    rig.strike("unplug left 0.5")
    pulled = time.monotonic()
    rig.wait(lambda: rig.entered(Stage.HOLD, after=pulled))
    rig.wait(lambda: rig.goes_on(servos))
    released = time.monotonic()
    servos.release()
    servos.close()
    record = rig.record()
    away = record.times[(record.plugged[:, 0] == 0) & (record.times > pulled) & (record.times < released)]
    held = rig.entered(Stage.HOLD, after=away[-1])
    assert held is not None
    late = record.stall(away[-1], held) + lateness(servos.history(), away[-1], held)
    assert held - away[-1] < 0.25 + 2 * late
    assert (record.torque[(record.times >= pulled) & (record.times < released)] == 1).all()
    assert not record.torque[-1].any()


@pytest.mark.soak
def test_servo_that_reboots_rejoins_without_a_jump(rig):
    servos = rig.opened()
    rig.write(servos, 30.0)
    rig.moving(servos)
    struck = time.monotonic()
    rig.strike("reboot left 3 0.13")
    rig.wait(lambda: rig.entered(Stage.ARM, after=struck))
    rig.wait(lambda: rig.goes_on(servos))
    released = time.monotonic()
    servos.release()
    servos.close()
    record = rig.record()
    window = (record.times >= struck) & (record.times < released)
    torque, goals, places = (item[window][:, 2] for item in (record.torque, record.goals, record.places))
    back = int(np.flatnonzero(np.diff(torque) > 0)[0]) + 1
    assert abs(goals[back] - places[back]) <= 2
    assert np.abs(places[back : back + 10] - places[back - 1]).max() <= 2
    assert torque[-1] == 1


def test_failed_servo_is_named_as_reason_of_the_stop(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.moving(servos)
    rig.strike("alert left 3 32")
    rig.wait(lambda: not servos.running)
    assert servos.state().faulty
    with pytest.raises(BusError, match="released the servos and ended: l_flexion: shut down"):
        rig.write(servos, 0.0)
    servos.close()
    assert not rig.record().torque[-1].any()


@pytest.mark.soak
def test_robot_waits_for_a_resume_request_after_a_long_port_loss(rig):
    servos = rig.opened()
    rig.write(servos, 30.0)
    rig.moving(servos)
    pulled = time.monotonic()
    rig.strike("unplug left 1.2")
    rig.wait(lambda: servos.state().waits == "consent")
    assert time.monotonic() - pulled > 1.1
    time.sleep(0.5)
    assert servos.state().waits == "consent"
    assert not servos.state().stage.runs
    assert any(note.kind == "paused" and "a port is gone" in note.text for note in servos.events())
    servos.resume()
    rig.wait(lambda: servos.state().stage is Stage.ACTIVE)
    servos.release()
    servos.close()
    assert not rig.record().torque[-1].any()


def test_limb_that_cannot_move_to_rest_is_held_until_a_person_confirms(rig):
    servos = rig.opened(replace(SETTINGS, patience=0.5))
    rig.write(servos, 20.0)
    rig.moving(servos)
    rig.wait(lambda: servos.state().time > 0.8)
    rig.strike("alert left 3 8")  # an encoder error takes no torque
    with pytest.raises(BusError, match=r"cannot fold: l_flexion: shut down.*lets it fall: l_flexion at"):
        servos.close()
    assert servos.running
    with pytest.raises(BusError, match="holds limbs that cannot fold"):
        rig.opened()
    holder = find_supervisor(rig.ports["left"], 4)
    assert holder is not None
    assert holder.status().energised == 5
    holder.set("confirm", 1)
    rig.wait(lambda: not servos.running)
    assert not rig.record().torque[-1].any()


def test_robot_in_an_emergency_stop_holds_with_torque_until_a_release_switches_torque_off(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.moving(servos)
    servos.stop()
    rig.wait(lambda: servos.state().stage is Stage.STOPPED)
    assert servos.state().energised == 5
    servos.release()
    servos.close()
    assert not rig.record().torque[-1].any()
