"""Emergency-stop connections of simulated clients: replies, and when they are closed."""

import json
import socket
import threading
from collections.abc import AsyncIterator, Callable, Iterator

import pytest

from kinesic.serve import stop_lines
from kinesic.serve.clients import CLOSE_NORMAL, CLOSE_POLICY_VIOLATION, CLOSE_TRY_LATER
from kinesic.serve.stop_lines import StopLines
from kinesic.serve.wire.quotas import Quotas
from kinesic.serve.wire.transport import HalfError

PATIENCE = 20.0  # [s] longest wait for a condition that a test expects
RULES = Quotas(rate=1e-6, burst=4)  # quotas that allow only the messages of the first burst


class PlayedWire:
    """Connection with prepared messages that ends, fails or stays open."""

    def __init__(self, *messages: bytes, fault: Exception | None = None, stays_open: bool = False) -> None:
        self._messages, self._fault, self._stays_open = messages, fault, stays_open
        self.sent: list[dict] = []
        self.result: tuple[int, str] | None = None
        self.line = None
        self.is_open, self.ended = threading.Event(), threading.Event()

    def move(self, line) -> None:
        self.line = line

    async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        assert not hurry()
        for message in self._messages:
            yield message
        if self._fault is not None:
            raise self._fault
        while self._stays_open:
            self.is_open.set()
            await stop_lines.sleep(0.005)

    def release(self) -> None:
        self._stays_open = False

    async def send(self, message: str) -> None:
        self.sent.append(json.loads(message))

    async def close(self, code: int, why: str) -> None:
        self.result = code, why
        self.ended.set()


class Robot:
    """Robot that counts emergency stops, and may fail."""

    def __init__(self) -> None:
        self.stops = 0
        self.threads: set[str] = set()
        self.fault: Exception | None = None

    def stop(self) -> None:
        self.threads.add(threading.current_thread().name)
        if self.fault is not None:
            raise self.fault
        self.stops += 1


@pytest.fixture
def robot() -> Robot:
    return Robot()


@pytest.fixture
def lines(robot: Robot) -> Iterator[StopLines]:
    opened = StopLines(robot.stop, RULES)
    opened.open()
    yield opened
    opened.close()


def take(lines: StopLines, wire: PlayedWire) -> socket.socket:
    """Make a connection an emergency-stop line, and return the client's end."""
    here, client = socket.socketpair()
    here.setblocking(False)
    client.settimeout(PATIENCE)
    lines.take(here, wire)
    return client


def talk(lines: StopLines, wire: PlayedWire) -> PlayedWire:
    """Wait until a conversation is over and its connection is closed."""
    with take(lines, wire) as client:
        assert client.recv(1) == b""
    return wire


def test_emergency_stop_is_executed_by_the_stop_connection_thread(lines: StopLines, robot: Robot) -> None:
    wire = talk(lines, PlayedWire(b'{"do": "stop"}', b'{"do": "stop"}'))
    assert wire.sent == [{"told": "stop_line"}, {"told": "stopped"}, {"told": "stopped"}]
    assert wire.result == (CLOSE_NORMAL, "")
    assert robot.stops == 2
    assert robot.threads == {"stop lines"}
    assert wire.line is not None


def test_stop_connection_answers_pings_and_refuses_other_messages(lines: StopLines, robot: Robot) -> None:
    wire = talk(lines, PlayedWire(b'{"do": "ping", "id": "x"}', b"<bml/>", b'{"do": "nonsense"}'))
    _, pong, document, nonsense = wire.sent
    assert pong == {"told": "pong", "id": "x"}
    assert document["told"] == nonsense["told"] == "refused"
    assert "only stops the robot" in document["why"]
    assert "nonsense" in nonsense["why"]
    assert robot.stops == 0


@pytest.mark.parametrize("fault", [OSError("no wire"), EOFError(), RuntimeError("gone"), ValueError("bad")])
def test_failed_emergency_stop_is_reported_to_client_and_log(
    lines: StopLines, robot: Robot, fault: Exception, caplog: pytest.LogCaptureFixture
) -> None:
    robot.fault = fault
    wire = talk(lines, PlayedWire(b'{"do": "stop"}', b'{"do": "ping"}'))
    assert wire.sent[1]["told"] != "stopped"
    assert wire.sent[2]["told"] == "pong", "the line still works"
    assert "an emergency stop failed" in caplog.text


def test_exception_ends_only_the_stop_connection_that_caused_it(
    lines: StopLines, robot: Robot, caplog: pytest.LogCaptureFixture
) -> None:
    robot.fault = KeyError("defect")
    wire = talk(lines, PlayedWire(b'{"do": "stop"}'))
    robot.fault = None
    assert talk(lines, PlayedWire(b'{"do": "stop"}')).sent[-1] == {"told": "stopped"}
    assert wire.result is None
    assert "a stop line failed" in caplog.text


def test_stop_connection_above_its_message_rate_stops_the_robot_and_is_closed(lines: StopLines, robot: Robot) -> None:
    wire = talk(lines, PlayedWire(*[b'{"do": "stop"}'] * 10))
    assert robot.stops == RULES.burst + 1
    code, why = wire.result
    assert code == CLOSE_POLICY_VIOLATION
    assert "rule rate" in why


def test_overlong_message_closes_the_stop_connection_with_the_reason(lines: StopLines) -> None:
    assert talk(lines, PlayedWire(fault=ValueError("too long"))).result == (CLOSE_POLICY_VIOLATION, "too long")


@pytest.mark.parametrize("fault", [HalfError("the connection ended"), ConnectionResetError()])
def test_lost_stop_connection_is_not_logged_as_an_error(
    lines: StopLines, fault: Exception, caplog: pytest.LogCaptureFixture
) -> None:
    assert talk(lines, PlayedWire(fault=fault)).result is None
    assert caplog.text == ""


def test_number_of_stop_connections_is_limited(lines: StopLines, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stop_lines, "MAX_STOP_LINES", 2)
    held = [PlayedWire(stays_open=True) for _ in range(2)]
    clients = [take(lines, wire) for wire in held]
    assert all(wire.is_open.wait(PATIENCE) for wire in held)
    refused = talk(lines, PlayedWire(b'{"do": "stop"}'))
    assert refused.sent == []
    assert refused.result[0] == CLOSE_TRY_LATER
    assert "2 connections" in refused.result[1]
    held[0].release()
    assert clients[0].recv(1) == b""
    assert talk(lines, PlayedWire(b'{"do": "stop"}')).sent[-1] == {"told": "stopped"}
    for client in clients:
        client.close()


def count_threads() -> int:
    """Return the number of threads of stop lines, also of servers of other tests."""
    return sum(thread.name == "stop lines" for thread in threading.enumerate())


def test_closing_the_server_ends_all_stop_connections_and_accepts_no_new_ones(lines: StopLines, robot: Robot) -> None:
    wire = PlayedWire(stays_open=True)
    with take(lines, wire) as client:
        assert wire.is_open.wait(PATIENCE)
        before = count_threads()
        lines.close()
        assert client.recv(1) == b""
    assert count_threads() == before - 1
    assert talk(lines, PlayedWire(b'{"do": "stop"}')).sent == []
    assert robot.stops == 0
    lines.close()


def test_stop_connection_is_closed_if_its_thread_never_started(robot: Robot) -> None:
    closed = StopLines(robot.stop, RULES)
    assert talk(closed, PlayedWire(b'{"do": "stop"}')).sent == []
    closed.close()


def test_stop_connection_thread_that_ends_at_once_raises_an_error(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse() -> None:
        raise PermissionError("no priority")

    monkeypatch.setattr(stop_lines, "raise_priority", refuse)
    monkeypatch.setattr(threading, "excepthook", lambda _: None)
    with pytest.raises(RuntimeError, match="ended at once"):
        StopLines(robot.stop, RULES).open()


def test_stop_connection_is_read_in_a_burst_beyond_its_rate(robot: Robot) -> None:
    class ReadingWire(PlayedWire):
        async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
            for _ in range(20):
                await self.line.read(hurry=True)
            yield b'{"do": "stop"}'

    lines = StopLines(robot.stop, Quotas(rate=1e-6, burst=4, patience=0.5))
    lines.open()
    wire = ReadingWire()
    with take(lines, wire) as client:
        client.shutdown(socket.SHUT_WR)
        assert client.recv(1) == b""
    lines.close()
    assert wire.sent[-1] == {"told": "stopped"}
