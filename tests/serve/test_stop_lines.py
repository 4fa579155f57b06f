"""Connections that only stop the robot, at a real server whose thread of clients is held up."""

import asyncio
import json
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from time import sleep

import pytest
from websockets.sync.client import connect

from kinesic.client import StopLine
from kinesic.serve import stop_lines
from kinesic.serve.stop_lines import StopLines
from kinesic.serve.wire.quotas import Quotas
from kinesic.serve.wire.transport import HalfError

from .conftest import PATIENCE, Running

pytestmark = pytest.mark.realtime


@contextmanager
def held_up(tasks: asyncio.AbstractEventLoop) -> Iterator[None]:
    """The thread of a loop stands still meanwhile."""
    stands, go_on = threading.Event(), threading.Event()

    def stand() -> None:
        stands.set()
        go_on.wait(PATIENCE)

    tasks.call_soon_threadsafe(stand)
    assert stands.wait(PATIENCE)
    try:
        yield
    finally:
        go_on.set()


@pytest.fixture(autouse=True)
def resumed(server: Running, becomes) -> Iterator[None]:
    yield
    with server.client() as client:
        client.do("resume")
        client.do("ping")
        assert client.receive(PATIENCE)
    assert becomes(lambda: not server.open.clients.session.loop.halted)


def test_a_stop_passes_whatever_holds_up_the_thread_of_clients(server, becomes):
    loop = server.open.clients.session.loop
    stops = loop.stops
    with StopLine(port=server.port) as line, held_up(server.tasks):
        line.stop(PATIENCE)
        assert loop.stops == stops + 1
        assert becomes(lambda: loop.halted)
    with server.client() as client:
        client.send('<bml id="late"><head lexeme="NOD"/></bml>')
        assert "rule stopped" in client.receive(PATIENCE)


def test_a_websocket_becomes_one_too_and_a_stop_that_came_along_is_not_lost(server):
    loop = server.open.clients.session.loop
    stops = loop.stops
    with connect(f"ws://127.0.0.1:{server.port}") as web:
        web.socket.sendall(b"".join(_frame(each) for each in ('{"do": "stop_line"}', '{"do": "stop"}')))
        assert [json.loads(web.recv(PATIENCE))["told"] for _ in range(2)] == ["stop_line", "stopped"]
        assert loop.stops == stops + 1
        with held_up(server.tasks):
            web.send('{"do": "stop"}')
            assert json.loads(web.recv(PATIENCE)) == {"told": "stopped"}
            assert loop.stops == stops + 2


def test_a_stop_that_came_along_by_tcp_is_not_lost(server):
    stops = server.open.clients.session.loop.stops
    with socket.create_connection(("127.0.0.1", server.port), PATIENCE) as client, client.makefile("rb") as answers:
        client.sendall(b'{"do": "stop_line"}\0{"do": "stop"}\0{"do": "st')
        assert [json.loads(answers.readline().strip(b"\0"))["told"] for _ in range(2)] == ["stop_line", "stopped"]
        client.sendall(b'op"}\0')
        assert json.loads(answers.readline().strip(b"\0")) == {"told": "stopped"}
    assert server.open.clients.session.loop.stops == stops + 2


def test_it_takes_nothing_else_and_no_place(server, becomes):
    clients = server.open.clients
    assert becomes(lambda: not clients._clients)
    with server.client() as client:
        client.do("stop_line")
        assert json.loads(client.receive(PATIENCE)) == {"told": "stop_line"}
        assert becomes(lambda: not clients._clients)
        assert clients._taken == 0
        for message, told in (
            ('<bml><head lexeme="NOD"/></bml>', "refused"),
            ('{"do": "resume"}', "refused"),
            ('{"do": "nonsense"}', "refused"),
            ('{"do": "ping", "id": "x"}', "pong"),
        ):
            client.send(message)
            assert json.loads(client.receive(PATIENCE))["told"] == told


def test_who_floods_its_line_is_stopped_and_sent_away(guarded):
    loop = guarded.open.clients.session.loop
    with guarded.client(token="open sesame") as client:
        client.do("stop_line")
        assert json.loads(client.receive(PATIENCE)) == {"told": "stop_line"}
        client.send_bytes(b'{"do": "stop"}\0' * 200)
        told = []
        while not told or told[-1]["told"] != "closed":
            told.append(json.loads(client.receive(PATIENCE)))
    assert told[-1]["why"].startswith("rule rate")
    assert 10 <= len(told) < 200
    assert loop.stops >= 10


def test_the_token_comes_first(guarded):
    with pytest.raises(PermissionError, match="token"):
        StopLine(port=guarded.port, token="wrong")
    with pytest.raises(ConnectionError, match="a token is needed"):
        StopLine(port=guarded.port)


def test_one_more_than_there_may_be_is_refused_and_those_there_remain(server, monkeypatch):
    monkeypatch.setattr(stop_lines, "MOST_LINES", 1)
    with StopLine(port=server.port) as first:
        with server.client() as second:
            second.do("stop_line")
            assert "send stop by any other" in json.loads(second.receive(PATIENCE))["why"]
        first.stop(PATIENCE)


def test_a_server_that_does_not_answer_is_an_error():
    with socket.create_server(("127.0.0.1", 0)) as silent, pytest.raises(ConnectionError, match="no answer came"):
        StopLine(port=silent.getsockname()[1], timeout=0.05)


def test_a_late_answer_is_none_to_the_next_stop():
    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=_answer_once, args=(server,), daemon=True).start()
        with StopLine(port=server.getsockname()[1]) as line:
            with pytest.raises(ConnectionError, match="no answer came"):
                line.stop(0.0)
            with pytest.raises(ConnectionError):
                line.stop(0.5)


class Line:
    """A wire that says nothing."""

    def move(self, line) -> None:
        pass

    async def send(self, message: str) -> None:
        pass

    async def close(self, code: int, why: str) -> None:
        pass

    async def messages(self, hurry):
        await asyncio.sleep(PATIENCE)
        yield b""


@contextmanager
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    """A client's end of a connection, and the server's."""
    here, there = socket.socketpair()
    there.setblocking(False)
    with here, there:
        here.settimeout(PATIENCE)
        yield here, there


def test_a_stop_that_fails_is_told_to_whoever_sent_it_and_to_whoever_runs_the_server(server, monkeypatch, caplog):
    for error in (BrokenPipeError("gone"), HalfError("half"), RuntimeError("closed"), ValueError("odd")):

        def fail(error=error) -> None:
            raise error

        monkeypatch.setattr(server.open.reception._stop_lines, "_halt", fail)
        with StopLine(port=server.port) as line:
            with pytest.raises(ConnectionError, match=f"may not stop .{error}.: use the switch"):
                line.stop(PATIENCE)
            monkeypatch.undo()
            line.stop(PATIENCE)  # the line is still one
        assert caplog.records[-1].exc_info[1] is error
        assert "an emergency stop failed" in caplog.text


def test_a_line_that_fails_ends_and_is_told_of(server, monkeypatch, caplog, becomes):
    monkeypatch.setattr(server.open.reception._stop_lines, "_halt", lambda: 1 / 0)
    with StopLine(port=server.port) as line, pytest.raises(ConnectionError, match="closed the connection"):
        line.stop(PATIENCE)
    assert becomes(lambda: "a stop line failed" in caplog.text)
    assert isinstance(caplog.records[-1].exc_info[1], ZeroDivisionError)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # how it is said here
def test_a_thread_that_ends_at_once_lets_no_server_open(monkeypatch):
    def refuse():
        raise OSError("too many open files")

    monkeypatch.setattr(stop_lines, "urgent", refuse)
    lines = StopLines(lambda: None, Quotas())
    with pytest.raises(RuntimeError, match="stop lines has ended at once"):
        lines.open()
    lines.close()


def test_a_thread_that_the_system_does_not_grant_lets_no_server_open(monkeypatch):
    def refuse(_) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refuse)
    lines = StopLines(lambda: None, Quotas())
    with pytest.raises(RuntimeError, match="can't start new thread"):
        lines.open()
    lines.close()


def test_who_comes_before_or_after_lines_are_read_is_sent_away_at_once():
    before, after = (StopLines(lambda: None, Quotas()) for _ in range(2))
    after.open()
    after.close()
    for lines in (before, after):
        with pair() as (here, there):
            lines.take(there, Line())
            assert here.recv(1) == b""


def test_who_comes_while_all_lines_end_is_not_left_waiting():
    lines = StopLines(lambda: None, Quotas())
    lines.open()
    ending = threading.Thread(target=lines.close)
    with pair() as (here, there), pair() as (late, after):
        with held_up(lines._loop):
            lines.take(there, Line())
            ending.start()
            while lines._taking:
                sleep(0.001)
            lines.take(after, Line())
            assert late.recv(1) == b""
        ending.join(PATIENCE)
        assert here.recv(1) == b""
    assert not lines._tasks


def _answer_once(server: socket.socket) -> None:
    """Answers the request for a stop line, and of two stops the first alone, when the second has come."""
    connection, _ = server.accept()
    with connection:
        connection.recv(1000)
        connection.sendall(b'{"told": "stop_line"}\0')
        heard = b""
        while heard.count(b"\0") < 2 and (data := connection.recv(1000)):
            heard += data
        connection.sendall(b'{"told": "stopped"}\0')
        connection.recv(1000)


def _frame(text: str) -> bytes:
    """A masked text frame, with a mask of zeros."""
    return bytes((0x81, 0x80 | len(text))) + bytes(4) + text.encode()
