"""Verb `kinesic servos release` on virtual servos, alone and with a supervisor."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.cli.servos import release
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.physics import FirstOrder
from kinesic.hardware.virtual.wiring import build_bus, describe_cables

REST_POSTURE = Manifest.of(Robot.load()).rest
CYCLE_PERIOD = 0.01  # [s] cycle period of the supervisor


class Supervisor:
    """Test double of a supervisor that folds the arms after a confirmation."""

    def __init__(self, table, *, fold: float, dies: bool = False) -> None:
        self.table, self.fold, self.dies = table, fold, dies
        self.now, self.confirmed_at = 100.0, None
        self.naps: list[float] = []
        self.angles = REST_POSTURE.copy()
        self.angles[Robot.load().skeleton.joint("l_elbow_flexion")] += np.radians(50.0)

    def set(self, name: str, value: int) -> None:
        assert (name, value) == ("confirm", 1)
        self.confirmed_at = self.now

    def word(self, name: str) -> int:
        assert name == "cycles"
        return round((0.0 if self.dies else self.now) / CYCLE_PERIOD)

    def status(self) -> Status:
        if self.confirmed_at is None:
            return replace(Status(Stage.ACTIVE), angles=self.angles)
        return Status(Stage.CLOSED if self.now - self.confirmed_at >= self.fold else Stage.FOLD)

    def sleep(self, seconds: float) -> None:
        assert self.table.energised == 23, "servos keep their torque until the supervisor has ended"
        self.naps.append(seconds)
        self.now += seconds


@pytest.fixture
def supervise(table, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Supervisor]:
    """Return a function that starts a supervisor for the virtual servos."""

    def make(**given) -> Supervisor:
        supervisor = Supervisor(table, **given)
        supervisors = {Path("table"): supervisor}
        monkeypatch.setattr(
            release, "find_supervisor", lambda path, joints: supervisors[path] if joints == 22 else None
        )
        monkeypatch.setattr(release, "time", SimpleNamespace(monotonic=lambda: supervisor.now, sleep=supervisor.sleep))
        table.energise()
        return supervisor

    return make


def test_release_verb_switches_torque_off_on_all_servos(kinesic, table):
    table.energise()
    ended = kinesic("servos", "release", "--yes", "--port", table.port)
    assert (ended.code, ended.out) == (0, "all 23 servos have no torque\n")
    assert table.energised == 0


def test_release_verb_lists_joints_that_will_fall(kinesic, table):
    raised = next(member for member in table.members if member.hinge == "l_elbow_flexion")
    k = [fitting.servo for fitting in table.cable.fittings].index(raised.id)
    rest = np.degrees(Robot.load().skeleton.rest[raised.joint])
    table.physics.turn(k, table.physics.shafts()[k].angle + raised.turns * np.radians(70.0))
    table.plant.advance(0.01)
    table.set(raised.id, Register.GOAL_POSITION, table.plant.servos[k].electronics.present_position())
    table.energise()
    ended = kinesic("servos", "release", "--port", table.port, stdin=b"n\n")
    assert ended.code == 130
    assert table.energised == 23
    (line,) = [line for line in ended.err.splitlines() if line.startswith("will fall: ")]
    ticks = np.full(23, table.plant.servos[k].electronics.present_position())
    angle = np.degrees(Manifest.of(Robot.load()).scale.angles(ticks)[table.members.index(raised)])
    assert line == f"will fall: l_elbow_flexion at {angle:.0f} deg (rest: {rest:.0f})"


def test_release_verb_keeps_torque_on_if_the_user_declines(kinesic, table):
    table.energise()
    ended = kinesic("servos", "release", "--port", table.port, stdin=b"n\n")
    assert ended.code == 130
    assert table.energised == 23


def test_release_verb_in_the_rest_posture_prints_that_no_joint_will_fall(kinesic, table):
    ended = kinesic("servos", "release", "--port", table.port, stdin=b"y\n")
    assert ended.code == 0
    assert "no joint with torque is more than 5 deg from rest\n" in ended.err
    assert "will fall" not in ended.err


def test_release_verb_reports_a_silent_servo_and_exits_with_3(kinesic, table):
    table.energise()
    table.plant.servos[4].mute = True
    ended = kinesic("servos", "release", "--yes", "--port", table.port)
    assert (ended.code, ended.out) == (3, "")
    problem = f"servo {table.plant.servos[4].id}: does not answer, and may still have torque; switch the power off"
    assert ended.err.splitlines()[-1] == f"kinesic: table: {problem}"
    assert "(silent)" in ended.err.splitlines()[0]


def test_release_verb_waits_for_the_supervisor_to_fold_the_arms(kinesic, table, supervise):
    supervisor = supervise(fold=5.0)
    ended = kinesic("servos", "release", "--yes", "--port", table.port)
    assert (ended.code, ended.out) == (0, "all 23 servos have no torque\n")
    (line,) = ended.err.splitlines()
    assert line.startswith("will fall: l_elbow_flexion at ")
    assert 5.0 <= supervisor.now - supervisor.confirmed_at < 5.2
    assert max(supervisor.naps) <= 0.1
    assert table.energised == 0


def test_release_verb_without_confirmation_does_not_stop_the_supervisor(kinesic, table, supervise):
    supervisor = supervise(fold=5.0)
    ended = kinesic("servos", "release", "--port", table.port, stdin=b"n\n")
    assert ended.code == 130
    assert supervisor.confirmed_at is None
    assert table.energised == 23


def test_release_verb_switches_torque_off_after_the_supervisor_was_killed(kinesic, table, supervise):
    supervisor = supervise(fold=1000.0, dies=True)
    ended = kinesic("servos", "release", "--yes", "--port", table.port)
    assert (ended.code, table.energised) == (0, 0)
    assert 1.0 < supervisor.now - supervisor.confirmed_at < 1.5


def test_release_verb_gives_up_after_60_s_if_the_supervisor_does_not_end(kinesic, table, supervise):
    supervisor = supervise(fold=1000.0)
    ended = kinesic("servos", "release", "--yes", "--port", table.port)
    assert ended.code == 2
    assert "the supervisor has not ended in 60 s (fold); switch the power off" in ended.err
    assert 60.0 <= supervisor.now - supervisor.confirmed_at < 61.0
    assert table.energised == 23


def test_release_verb_switches_torque_off_on_every_bus_whose_port_opens(kinesic, monkeypatch: pytest.MonkeyPatch):
    robot = Robot.load("upper36")
    manifest, cables = Manifest.of(robot), describe_cables(robot)
    broken, *others = (cable.name for cable in cables)
    fittings = [fitting for cable in cables for fitting in cable.fittings]
    scale = Register.PRESENT_POSITION.field.scale
    physics = FirstOrder([fitting.motor for fitting in fittings], [fitting.ticks * scale for fitting in fittings])
    plant, buses = build_bus(cables, physics)
    for servo in plant.servos:
        servo.write(Register.TORQUE_ENABLE.field.address, b"\1")
    opened: list[MemoryWire] = []
    closed: list[str] = []

    class Wire(MemoryWire):
        def close(self) -> None:
            closed.append(self.name)
            super().close()

    def connect(path: Path, baud: int) -> MemoryWire:
        if path.name == broken:
            raise BusError(f"{path}: no such port")
        assert baud == manifest.bauds[path.name]
        opened.append(Wire(buses[path.name], name=str(path)))
        return opened[-1]

    monkeypatch.setattr(release, "SerialWire", connect)
    ports = [option for bus in manifest.bauds for option in ("--port", f"{bus}={bus}")]
    ended = kinesic("servos", "release", "--robot", "upper36", "--yes", *ports)
    assert (ended.code, ended.out) == (3, "")
    problems = [line for line in ended.err.splitlines() if line.startswith("kinesic: ")]
    assert problems == [f"kinesic: {broken}: no such port; the servos of bus {broken} may still have torque"]
    torque = [servo.memory[Register.TORQUE_ENABLE] for servo in plant.servos]
    assert sum(torque) == sum(member.bus == broken for member in manifest.members)
    assert closed == others
