"""Twin behind a pseudo-terminal, driven by kinesic and the Dynamixel SDK."""

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from dynamixel_sdk import COMM_SUCCESS, GroupSyncRead, GroupSyncWrite, PacketHandler, PortHandler

from kinesic.body.arrays import Floats
from kinesic.body.config import CONFIGS
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.play import commands
from kinesic.controller.servo_performance import BUS_DELAY
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.metrics.servo_run import FULL_TIME_SCALE
from kinesic.planning.plan import Plan
from kinesic.session.plan import plan

pytestmark = pytest.mark.realtime

COMMAND_COUNT = 240  # number of sent commands, which contain most of the first wave
MAX_COMMAND_DELAY = 0.002  # [s] delay of a command above which all later commands are postponed, too
MAX_CYCLE_GAP = 0.015  # [s] time between two cycles above which the machine was too busy for a comparison
RECOVERY_TIME = 0.15  # [s] time after a long gap until the robot follows the plan again
ERROR_LIMITS = (1.0, 2.5, 5.0)  # [deg] limits of RMSE, 95th percentile and largest tracking error


@pytest.fixture(scope="module")
def planned() -> Plan:
    return plan((CONFIGS / "bml" / "welcome.bml").read_bytes())


@pytest.fixture(scope="module")
def port(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("ports")
    command = [sys.executable, "-m", "kinesic", "servos", "simulate", "--physics", "twin", "--folder", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("body: ")
        yield folder / "body"
        process.terminate()


def followed(planned: Plan, clocks: Floats, times: Floats, angles: Floats) -> None:
    """Assert that measured angles match the plan while the driver had CPU time.

    Args:
        planned: plan.
        clocks: (k,) [s] of the cycles.
        times: (k,) [s] performance time.
        angles: (k, n) [rad] measured.
    """
    stalled = np.diff(clocks) > MAX_CYCLE_GAP
    begins, ends = clocks[:-1][stalled], clocks[1:][stalled]  # a stall spoils the date of the cycle that it began in
    calm = ~((begins <= clocks[:, None]) & (clocks[:, None] < ends + RECOVERY_TIME)).any(axis=1)
    sampled = [planned.trajectory.sample(column) for column in times.T]
    wanted, speeds = (np.transpose([each[k][:, hinge] for hinge, each in enumerate(sampled)]) for k in range(2))
    moving = (np.abs(speeds) > 0.05 * planned.setup.robot.velocity_limits) & calm[:, None]
    if moving.sum() < 500:
        pytest.skip("the machine was too busy for real time")
    off = np.degrees(np.abs(angles - wanted))[moving]
    results = (float(np.sqrt(np.mean(off**2))), float(np.percentile(off, 95)), float(off.max()))
    assert all(error <= goal for error, goal in zip(results, ERROR_LIMITS, strict=True)), results


def test_twin_behind_a_port_follows_the_plan_sent_by_the_kinesic_driver(planned: Plan, port: Path):
    robot, times = planned.setup.robot, planned.command_times[:COMMAND_COUNT]
    setpoints = FeedForward(robot, planned.setup.dynamics, delay=BUS_DELAY).compute_setpoints(planned.trajectory, times)
    servos = Servos(robot, {"body": port}, settings=SupervisorSettings(pace=2.0, patience=0.1))
    for command in commands(planned.trajectory, times, setpoints):
        servos.write(command)
    servos.close()
    ran = [item for item in servos.history() if item.stage is Stage.ACTIVE and item.scale > FULL_TIME_SCALE]
    rows = [item for item in ran if np.isfinite(item.taken).all()]
    clocks, reached = np.array([row.clock for row in rows]), np.array([row.time for row in rows])
    at = np.transpose([np.interp(taken, clocks, reached) for taken in np.transpose([row.taken for row in rows])])
    followed(planned, clocks, at, np.array([row.angles for row in rows]))


@pytest.mark.soak
def test_twin_behind_a_port_follows_the_plan_sent_by_the_dynamixel_sdk(planned: Plan, port: Path):
    robot, times = planned.setup.robot, planned.command_times[:COMMAND_COUNT]
    wiring = ServoMap.of(robot)
    setpoints = FeedForward(robot, planned.setup.dynamics, delay=BUS_DELAY).compute_setpoints(planned.trajectory, times)
    hinges = {servo: k for k, servos in enumerate(wiring.servos) for servo in servos.ids}
    handler, protocol = PortHandler(str(port)), PacketHandler(2.0)
    assert handler.openPort()
    assert handler.setBaudRate(1_000_000)
    read, write = GroupSyncRead(handler, protocol, 132, 4), GroupSyncWrite(handler, protocol, 116, 4)
    for servo in hinges:
        protocol.write1ByteTxRx(handler, servo, 64, 1)
        read.addParam(servo)
    began, rows = time.monotonic() + 0.1, list[tuple[float, float, float, Floats]]()
    for command in commands(planned.trajectory, times, setpoints):
        time.sleep(max(0.0, began + command.time - time.monotonic()))
        now = time.monotonic()
        began = max(began, now - command.time - MAX_COMMAND_DELAY)  # hurried goals are another motion
        goals = wiring.scale.ticks(command.setpoints)
        write.clearParam()
        for servo, hinge in hinges.items():
            write.addParam(servo, list(int(goals[hinge]).to_bytes(4, "little")))
        write.txPacket()
        asked = time.monotonic()
        if read.fastSyncRead() == COMM_SUCCESS:
            seen = np.zeros(len(wiring.servos))
            for servo, hinge in hinges.items():
                seen[hinge] = read.getData(servo, 132, 4)
            taken = asked + (14 + 6 * len(hinges)) * 10e-6
            rows.append((now, taken, command.time, wiring.scale.angles(seen)))
    handler.closePort()
    clocks, taken, reached, angles = (np.array(column) for column in zip(*rows, strict=True))
    at = np.broadcast_to(np.interp(taken, clocks, reached)[:, None], angles.shape)
    followed(planned, clocks, at, angles)
