"""Servos with a simulated supervisor: commands, requests and reasons of an end."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.body.servo import tracking_lags
from kinesic.hardware import servos as servos_module
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import START_TIMEOUT, Servos, check_ports_free
from kinesic.hardware.supervisor.settings import SupervisorOrder, SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage

from .played_supervisor import JOINTS, PORTS, PlayedSupervisor, Rig

SETTINGS = SupervisorSettings(pace=0.5)
RAISED = np.array([0.0, 1.0, 0.0, 0.0])  # [rad] joint angles with one raised limb


@pytest.fixture
def played(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> Iterator[Rig]:
    rig = Rig(robot, monkeypatch)
    yield rig
    for supervisor in rig.supervisors:
        supervisor.stdin.close()
        supervisor.reader.close()


def test_supervisor_process_gets_its_startup_order_over_a_pipe_that_stays_open(played: Rig, tmp_path: Path) -> None:
    servos, supervisor = played.open(settings=SETTINGS, log=tmp_path / "x" / ".." / "log")
    assert supervisor.arguments[1:] == ["-m", "kinesic.hardware.supervisor"]
    assert supervisor.session is True
    order = msgspec.json.decode(supervisor.reader.readline(), type=SupervisorOrder)
    assert (order.robot, order.ports) == (str(played.robot.path), {"left": "/dev/left", "right": "/dev/right"})
    assert (order.settings, order.log) == (SETTINGS, str(tmp_path / "log"))
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(order.memory)  # closed here, as the supervisor has its own
    assert not supervisor.stdin.closed
    assert played.searched == [("/dev/left", JOINTS), (Path("/dev/right"), JOINTS)]
    assert (servos.pid, servos.running, len(servos.members)) == (4711, True, 5)
    supervisor.returncode = 0
    assert not servos.running


def test_startup_order_of_a_supervisor_without_an_event_log_names_no_log_file(played: Rig) -> None:
    _, supervisor = played.open()
    assert msgspec.json.decode(supervisor.reader.readline(), type=SupervisorOrder).log is None


def test_commands_reach_the_channel_with_their_feed_forward(played: Rig) -> None:
    servos, supervisor = played.open()
    servos.write(played.command(0.5, 0.25, 2.0))
    ((time, goals, offsets),) = supervisor.channel.commands(9)
    assert (time, goals.tolist()) == (0.5, [0.25] * JOINTS)
    np.testing.assert_allclose(offsets, 2.0 * tracking_lags(played.robot.drives), rtol=1e-12)


@pytest.mark.parametrize("setpoints", [np.zeros(JOINTS - 1), np.array([0.0, np.nan, 0.0, 0.0])])
def test_setpoints_of_wrong_length_or_with_nan_are_refused(played: Rig, setpoints: np.ndarray) -> None:
    servos, supervisor = played.open()
    still = np.zeros(JOINTS)
    with pytest.raises(BusError, match="must be 4 finite numbers"):
        servos.write(Command(0.0, still, still, still, setpoints))
    assert supervisor.channel.commands(9) == []


def test_commands_beyond_the_channel_capacity_are_kept_and_sent_later(played: Rig) -> None:
    servos, supervisor = played.open()
    supervisor.channel.set("written", supervisor.channel.capacity)  # full
    servos.write(played.command(1.0))
    servos.write(played.command(2.0))
    supervisor.channel.set("read", 1)
    supervisor.channel._taken = supervisor.channel.capacity
    assert len(servos._waiting) == 2
    servos.state()
    assert len(servos._waiting) == 1
    assert [time for time, *_ in supervisor.channel.commands(9)] == [1.0]
    servos.state()
    assert [time for time, *_ in supervisor.channel.commands(9)] == [2.0]


def test_status_and_events_of_the_supervisor_are_returned_once(played: Rig) -> None:
    servos, supervisor = played.open()
    supervisor.tell(Stage.ACTIVE, angles=RAISED)
    assert servos.state().stage is Stage.ACTIVE
    assert servos.positions().tolist() == RAISED.tolist()
    assert [status.stage for status in servos.history()] == [Stage.LIMP, Stage.ACTIVE]
    assert servos.history() == ()
    supervisor.note("fault", "hot")
    assert [note.text for note in servos.events()] == ["hot"]
    assert servos.events() == ()
    assert np.isnan(servos.telemetry().clock) or servos.telemetry().clock == 0.0


def test_stop_resume_release_and_slow_requests_reach_the_channel(played: Rig) -> None:
    servos, supervisor = played.open()
    word = supervisor.channel.word
    servos.stop()
    assert word("estop") == 1
    servos.stop("limp")
    assert word("estop") == 2
    servos.slow_to(0.5)
    assert word("pace") == 501
    for count in (1, 2):
        servos.stop()
        servos.resume()
        servos.release()
        assert (word("estop"), word("resume"), word("release")) == (0, count, count)


def test_closing_writes_the_remaining_commands_and_waits_until_the_supervisor_ends(played: Rig) -> None:
    servos, supervisor = played.open()
    supervisor.channel.set("written", supervisor.channel.capacity)
    servos.write(played.command(1.0))
    words: list[tuple[int, bool]] = []

    def see(_: PlayedSupervisor) -> None:
        words.append((supervisor.channel.word("ended"), supervisor.stdin.closed))

    def free(_: PlayedSupervisor) -> None:
        see(_)
        supervisor.channel.set("read", 1)

    supervisor.schedule = [free, see, lambda _: supervisor.end()]
    servos.close()
    assert words == [(0, False), (1, False)]
    assert supervisor.channel.word("written") == supervisor.channel.capacity + 1
    assert supervisor.channel.word("release") == 0
    assert supervisor.stdin.closed
    assert played.sleeps == [servos_module.POLL_INTERVAL] * 4


def test_closing_after_an_emergency_stop_or_a_release_drops_waiting_commands(played: Rig) -> None:
    for request in (Servos.stop, Servos.release):
        servos, supervisor = played.open()
        supervisor.channel.set("written", supervisor.channel.capacity)
        servos.write(played.command(1.0))
        request(servos)
        supervisor.schedule = [lambda it: it.end()]
        servos.close()
        assert (supervisor.channel.word("release"), supervisor.channel.word("ended")) == (1, 1)


def test_keyboard_interrupt_while_closing_releases_the_robot_and_waits_for_its_end(played: Rig) -> None:
    servos, supervisor = played.open()

    def interrupt(_: PlayedSupervisor) -> None:
        raise KeyboardInterrupt

    released: list[int] = []
    supervisor.schedule = [
        interrupt,
        lambda it: released.append(it.channel.word("release")),
        lambda it: it.end(),
    ]
    with pytest.raises(KeyboardInterrupt):
        servos.close()
    assert released == [1]
    assert supervisor.stdin.closed


def test_raised_limb_that_cannot_move_to_rest_is_reported_while_the_supervisor_holds_it(played: Rig) -> None:
    servos, supervisor = played.open()
    supervisor.note("failed", "servo 3 is silent")
    supervisor.schedule = [lambda it: it.tell(Stage.WAITING, waits="confirmation", angles=RAISED, energised=3)]
    with pytest.raises(BusError, match=r"cannot fold: servo 3 is silent; held until .*: .*l_flexion"):
        servos.close()
    assert servos.running
    assert supervisor.stdin.closed
    with pytest.raises(BusError, match="cannot fold"):
        servos.write(played.command(0.0))


def test_held_limb_with_all_joints_at_rest_names_a_silent_servo(played: Rig) -> None:
    servos, supervisor = played.open()
    supervisor.tell(Stage.WAITING, waits="confirmation", angles=played.robot.skeleton.rest)
    with pytest.raises(BusError, match=r"the robot cannot fold; held until .* lets it fall: a silent servo"):
        servos.close()


@pytest.mark.parametrize(
    ("code", "energised", "message"),
    [
        (-signal.SIGKILL, 4, r"the supervisor died \(exit code -9\); the servos have stopped with torque on"),
        (0, 4, "the servos hold where they stopped, and may have torque: no power; switch the power off"),
        (0, 0, "the supervisor has released the servos and ended: no power; open them again"),
    ],
)
def test_error_of_a_command_after_the_supervisor_ended_says_how_it_ended(
    played: Rig, code: int, energised: int, message: str
) -> None:
    servos, supervisor = played.open()
    supervisor.note("other", "no reason")
    supervisor.note("failed", "no power")
    supervisor.end(code, energised=energised)
    with pytest.raises(BusError, match=message):
        servos.write(played.command(0.0))


def test_torque_that_is_left_on_is_reported_after_closing(played: Rig) -> None:
    servos, supervisor = played.open()
    supervisor.end(energised=2)
    with pytest.raises(BusError, match="may have torque"):
        servos.close()
    assert supervisor.stdin.closed


@pytest.mark.parametrize(
    ("notes", "message"),
    [((), r"did not start \(exit code 2\)"), ((("refused", "a"), ("other", "x"), ("refused", "b")), "^a\nb$")],
)
def test_error_lists_each_reason_why_the_supervisor_refuses_the_servos(played: Rig, notes, message: str) -> None:
    def refuse(supervisor: PlayedSupervisor) -> None:
        for kind, text in notes:
            supervisor.note(kind, text)
        supervisor.end(2)

    played.start_schedule = [refuse]
    with pytest.raises(BusError, match=message):
        played.open()
    assert played.supervisor.stdin.closed
    assert played.supervisor.waits == 1


@pytest.mark.parametrize("stage", [Stage.LIMP, Stage.HOLD])
def test_opening_waits_until_the_supervisor_accepts_commands(played: Rig, stage: Stage) -> None:
    stages = (Stage.PROBE, Stage.CONFIGURE, stage)
    played.start_schedule = [lambda it, stage=stage: it.tell(stage) for stage in stages]
    played.open()
    assert played.sleeps == [servos_module.POLL_INTERVAL] * 3


def test_start_of_a_supervisor_that_does_not_become_ready_times_out(played: Rig) -> None:
    played.start_schedule = [lambda it: setattr(played, "clock", played.clock + START_TIMEOUT)]
    with pytest.raises(BusError, match="did not start"):
        played.open()
    assert len(played.sleeps) == 1
    assert START_TIMEOUT >= 10.0  # [s] of a start on a busy machine


def test_ports_that_another_supervisor_holds_are_named_with_a_remedy(played: Rig) -> None:
    _, first = played.open()
    first.tell(Stage.ACTIVE)
    played.found = {"/dev/left": first.channel}
    with pytest.raises(BusError, match=r"^/dev/left: another program uses this port: .*\(active\); end it, or use"):
        check_ports_free(PORTS.values(), JOINTS)
    first.tell(Stage.WAITING, waits="confirmation")
    played.found["/dev/right"] = first.channel
    with pytest.raises(BusError, match=r"limbs that cannot fold.*\n/dev/right: a supervisor holds limbs"):
        check_ports_free(PORTS.values(), JOINTS)
    played.found = {}
    check_ports_free(PORTS.values(), JOINTS)


@pytest.mark.parametrize("ports", [{"left": "/dev/left"}, PORTS | {"third": "/dev/third"}])
def test_missing_or_unknown_ports_are_refused_before_the_start(played: Rig, ports: dict) -> None:
    with pytest.raises(BusError, match="little needs left=PATH, right=PATH"):
        Servos(played.robot, ports)
    with pytest.raises(BusError, match="for no bus, but"):
        Servos(played.robot, {})
    assert played.supervisors == []
