"""Entry point of the supervisor process, with a simulated supervisor."""

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import msgspec
import pytest

from kinesic.hardware.supervisor import __main__ as process
from kinesic.hardware.supervisor.__main__ import PlannerPipe, main, supervise
from kinesic.hardware.supervisor.channel import Channel, map_memory, memory_file, memory_size
from kinesic.hardware.supervisor.settings import SupervisorOrder, SupervisorSettings
from kinesic.host import ENDING_SIGNALS

JOINTS = 4
SETTINGS = SupervisorSettings(period=0.02, watchdog=0.1, patient_watchdog=0.3)
ROBOT = Path(__file__).with_name("little.toml")


class PlayedSupervisor:
    """Supervisor that ends after some cycles and counts its delays."""

    cycles = 3
    delays: tuple[float, ...] = ()  # [s] delays of the first cycles

    def __init__(self, manifest, context, settings, *, watchdog: float) -> None:
        self.manifest, self.context, self.settings, self.watchdog = manifest, context, settings, watchdog
        self.clock, self.late, self.steps, self.opened = 7.0, 0, 0, False
        self.sleeps: list[float] = []

    def open(self) -> None:
        self.opened = True

    @property
    def done(self) -> bool:
        return self.steps >= self.cycles

    def now(self) -> float:
        return self.clock

    def step(self) -> None:
        self.clock += self.delays[self.steps] if self.steps < len(self.delays) else 0.001
        self.steps += 1

    def sleep(self, until: float) -> None:
        self.sleeps.append(until)
        self.clock = max(self.clock, until)


class Host:
    """Process with a simulated supervisor, host and published files."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
        self.folder = folder
        self.is_real_time, self.priorities = True, list[int]()
        self.published: list[tuple] = []
        self.files = (folder / "first", folder / "second")
        self.frozen: list[str] = []
        self.made: list[PlayedSupervisor] = []
        self.memory = memory_file(memory_size(JOINTS))
        self.channel = Channel(map_memory(self.memory, memory_size(JOINTS)), JOINTS)
        monkeypatch.setattr(process, "Supervisor", self._make)
        monkeypatch.setattr(process, "request_real_time", self._request)
        monkeypatch.setattr(process, "publish", self._publish)
        freezing = SimpleNamespace(
            collect=lambda: self.frozen.append("collect"), freeze=lambda: self.frozen.append("freeze")
        )
        monkeypatch.setattr(process, "gc", freezing)

    def _make(self, *arguments: object, **options: object) -> PlayedSupervisor:
        self.made.append(PlayedSupervisor(*arguments, **options))
        return self.made[-1]

    def _request(self, priority: int) -> bool:
        self.priorities.append(priority)
        return self.is_real_time

    def _publish(self, *arguments: object) -> tuple[Path, ...]:
        self.published.append(arguments)
        for file in self.files:
            file.write_text("address")
        return self.files

    def order(self, **options: object) -> SupervisorOrder:
        ports = {"left": "/dev/left", "right": "/dev/right"}
        return SupervisorOrder(
            **{"robot": str(ROBOT), "ports": ports, "memory": self.memory, "settings": SETTINGS} | options
        )

    def supervise(self, ended: Callable[[], bool] = lambda: False, **options: object) -> tuple[int, PlayedSupervisor]:
        code = supervise(self.order(**options), lambda: True, ended)
        return code, self.made[-1]


@pytest.fixture
def host(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Host]:
    made = Host(monkeypatch, tmp_path)
    yield made
    os.close(made.memory)


def test_supervisor_runs_one_cycle_per_period_until_it_has_ended(host: Host) -> None:
    code, supervisor = host.supervise()
    assert code == 0
    assert (supervisor.opened, supervisor.steps, supervisor.late) == (True, 3, 0)
    assert supervisor.sleeps == pytest.approx([7.02, 7.04, 7.06])
    assert supervisor.settings is SETTINGS
    assert host.channel.word("release") == 0
    assert host.frozen == ["collect", "freeze"]


def test_cycle_more_than_a_period_late_is_counted_and_not_repeated(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(PlayedSupervisor, "delays", (0.039, 0.05, 0.001))
    _, supervisor = host.supervise()
    assert supervisor.late == 1  # the first is late by less than a period
    assert supervisor.sleeps == pytest.approx([7.02, 7.089, 7.109])


def test_supervisor_process_exits_with_2_if_it_refuses_the_servos(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(PlayedSupervisor, "cycles", 0)
    code, supervisor = host.supervise()
    assert (code, supervisor.steps) == (2, 0)


@pytest.mark.parametrize(("granted", "watchdog"), [(True, 0.1), (False, 0.3)])
def test_watchdog_is_longer_without_real_time_scheduling(host: Host, granted: bool, watchdog: float) -> None:
    host.is_real_time = granted
    _, supervisor = host.supervise()
    assert supervisor.watchdog == watchdog
    assert 1 <= host.priorities[0] <= 99


def test_each_process_signal_requests_one_release_of_the_servos(host: Host) -> None:
    signals = [False, True, True]
    host.supervise(lambda: signals.pop(0))
    assert host.channel.word("release") == 2


def test_ports_are_opened_with_the_baud_rate_of_their_bus(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "SerialWire", lambda path, baud: (path, baud))
    _, supervisor = host.supervise()
    bauds = supervisor.manifest.bauds
    for name in ("left", "right"):
        assert supervisor.context.opens(name) == (f"/dev/{name}", bauds[name])


def test_published_addresses_are_removed_at_the_end(host: Host) -> None:
    seen: list[bool] = []

    def ended() -> bool:
        if not host.published:
            host.made[0].context.announce()
            host.files[0].unlink()  # another process may have removed it
        seen.append(host.files[1].exists())
        return False

    host.supervise(ended)
    ((ports, memory, joints),) = host.published
    assert (list(ports), memory, joints) == (["/dev/left", "/dev/right"], host.memory, JOINTS)
    assert seen == [True] * 3
    assert not host.files[1].exists()


def test_supervisor_opens_the_event_log_of_its_startup_order_and_closes_it_at_the_end(
    host: Host, tmp_path: Path
) -> None:
    log = tmp_path / "events"
    _, supervisor = host.supervise(log=str(log))
    assert log.exists()
    assert supervisor.context.journal._file.closed
    assert supervisor.context.planner()


@pytest.fixture
def pipe(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[int, int, list[str]]]:
    """Ends of the planner's pipe, and a list of closed outputs."""
    closed: list[str] = []
    monkeypatch.setattr(process, "_close_output", lambda: closed.append("closed"))
    reader, writer = os.pipe()
    yield reader, writer, closed
    os.close(reader)


def test_planner_is_alive_while_its_pipe_is_open(pipe) -> None:
    reader, writer, closed = pipe
    planner = PlannerPipe(reader)
    assert planner()
    os.write(writer, b"ignored")
    assert planner()
    assert planner()
    assert closed == []
    os.close(writer)
    assert not planner()
    assert not planner()
    assert closed == ["closed"]


def test_planner_counts_as_dead_once_the_supervisor_has_another_parent(pipe, monkeypatch: pytest.MonkeyPatch) -> None:
    reader, writer, closed = pipe
    planner = PlannerPipe(reader)
    parent = os.getppid()
    monkeypatch.setattr(process.os, "getppid", lambda: 1)
    assert not planner()
    monkeypatch.setattr(process.os, "getppid", lambda: parent)
    assert not planner(), "it never comes back"
    assert closed == ["closed"]
    os.close(writer)


def test_closed_standard_output_of_the_supervisor_discards_later_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = [(tmp_path / name).open("w") for name in ("out", "err")]
    monkeypatch.setattr(sys, "stdout", files[0])
    monkeypatch.setattr(sys, "stderr", files[1])
    for file in files:
        file.write("before")
    process._close_output()
    for file in files:
        file.write("after")
        file.close()
    assert [(tmp_path / name).read_text() for name in ("out", "err")] == ["before", "before"]


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[bytes], tuple[int, list, dict]]]:
    """Function that runs `main` with bytes on its standard input."""
    handlers: dict[int, Callable] = {}
    calls: list[tuple] = []
    files: list[int] = []

    def run(data: bytes) -> tuple[int, list, dict]:
        reader, writer = os.pipe()
        files.append(reader)
        os.write(writer, data)
        os.close(writer)
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(fileno=lambda: reader))
        return main(), calls, handlers

    def record(order, planner, ended) -> int:
        assert not ended()
        handlers[ENDING_SIGNALS[0]](15, None)
        calls.append((order, os.read(planner._descriptor, 99), [ended(), ended()]))
        return 5

    monkeypatch.setattr(process.signal, "signal", handlers.__setitem__)
    monkeypatch.setattr(process, "supervise", record)
    yield run
    for file in files:
        os.close(file)


def test_supervisor_process_reads_its_startup_order_and_leaves_later_bytes_in_the_pipe(started, host: Host) -> None:
    code, ((order, rest, ended),), handlers = started(msgspec.json.encode(host.order()) + b"\nrest")
    assert code == 5
    assert msgspec.to_builtins(order) == msgspec.to_builtins(host.order())
    assert rest == b"rest"
    assert ended == [True, False]
    assert set(handlers) == set(ENDING_SIGNALS)


@pytest.mark.parametrize("line", [b"", b"nonsense\n", b'{"robot": 1}\n'])
def test_unreadable_startup_order_of_a_supervisor_is_refused_on_standard_error(started, line: bytes, capsys) -> None:
    code, calls, _ = started(line)
    assert (code, calls) == (2, [])
    assert capsys.readouterr().err.startswith("kinesic.hardware.supervisor: ")


def test_supervisor_of_an_unknown_robot_is_refused(
    started, host: Host, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.setattr(process, "supervise", supervise)
    code, _, _ = started(msgspec.json.encode(host.order(robot="/no/such.toml")) + b"\n")
    assert code == 2
    assert "/no/such.toml" in capsys.readouterr().err
