"""Death of planner or supervisor during a performance.

Times are compared with the machine's own stalls.
"""

import time

import numpy as np
import pytest

from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.state_machine import Stage

from .conftest import lateness

pytestmark = pytest.mark.realtime

PATIENCE = 60.0  # [s] longest wait for any event on a loaded machine
WATCHDOG = 0.2  # [s] watchdog time on a punctual machine
WATCHDOG_UNIT = 0.02  # [s] watchdog time per register count


def test_killed_supervisor_leaves_servos_stopped_with_torque_and_the_next_supervisor_adopts_them(rig):
    servos = rig.opened()
    rig.write(servos, 20.0)
    rig.freeze(servos)
    killed = rig.kill(servos.pid)
    rig.wait(lambda: not servos.running)
    with pytest.raises(BusError, match="have stopped with torque on"):
        rig.write(servos, 0.0)
    rig.wait(lambda: rig.record().stopped)
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
    armed = WATCHDOG_UNIT * record.watchdogs[record.times <= killed][-1].max()  # [s], more where this machine is late
    after = killed + max(armed, WATCHDOG) + 0.02 + 2 * record.stall(killed, killed + 0.5)
    stopped = (record.times >= after) & (record.times < released)
    assert (record.watchdogs[stopped][0] == -1).all()
    assert np.ptp(record.places[stopped], axis=0).max() <= 2
    assert (record.torque[(record.times >= killed) & (record.times < released)] == 1).all()
    assert not record.torque[-1].any()


@pytest.mark.parametrize(
    "handed_over", [pytest.param((), id="0.7 s"), pytest.param(("60",), id="all", marks=pytest.mark.soak)]
)
def test_robot_holds_then_moves_to_rest_and_switches_torque_off_after_its_planner_is_killed(
    rig, handed_over: tuple[str, ...]
):
    planner, supervisor = rig.planner(*handed_over), rig.supervisor()
    rig.wait(rig.raised)
    killed = rig.kill(planner.pid)
    planner.wait(PATIENCE)
    rig.wait(lambda: rig.entered(Stage.CLOSED, after=killed))
    record, history = rig.record(), supervisor.history()
    held, folded = rig.entered(Stage.HOLD, after=killed), rig.entered(Stage.FOLD, after=killed)
    assert held is not None
    assert folded is not None
    assert held - killed < 0.1 + 2 * (record.stall(killed, held) + lateness(history, killed, held))
    between = (record.times > held + 0.01 + record.stall(held, folded)) & (record.times < folded)
    assert not between.any() or np.ptp(record.goals[between], axis=0).max() <= 1
    rig.ends_at_rest()
    assert np.abs(record.goals[-1] - record.places[-1]).max() <= 3
