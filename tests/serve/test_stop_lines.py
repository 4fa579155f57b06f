"""Stop lines of a real server whose client thread is blocked."""

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

from .conftest import MAX_WAIT, Running

pytestmark = pytest.mark.realtime


@contextmanager
def held_up(tasks: asyncio.AbstractEventLoop) -> Iterator[None]:
    """Block the thread of an asyncio loop within the context."""
    stands, advance_scene = threading.Event(), threading.Event()

    def stand() -> None:
        stands.set()
        advance_scene.wait(MAX_WAIT)

    tasks.call_soon_threadsafe(stand)
    assert stands.wait(MAX_WAIT)
    try:
        yield
    finally:
        advance_scene.set()


@pytest.fixture(autouse=True)
def resumed(server: Running, becomes) -> Iterator[None]:
    yield
    with server.client() as client:
        client.do("resume")
        client.do("ping")
        assert client.receive(MAX_WAIT)
    assert becomes(lambda: not server.open.clients.session.loop.is_stopped)


def test_emergency_stop_is_executed_while_the_thread_of_other_clients_is_blocked(server, becomes):
    loop = server.open.clients.session.loop
    stops = loop.stop_count
    with StopLine(port=server.port) as line, held_up(server.tasks):
        line.stop(MAX_WAIT)
        assert loop.stop_count == stops + 1
        assert becomes(lambda: loop.is_stopped)
    with server.client() as client:
        client.send('<bml id="late"><head lexeme="NOD"/></bml>')
        assert "rule stopped" in client.receive(MAX_WAIT)


def test_websocket_becomes_a_stop_connection_without_losing_a_buffered_stop(server):
    loop = server.open.clients.session.loop
    stops = loop.stop_count
    with connect(f"ws://127.0.0.1:{server.port}") as web:
        web.socket.sendall(b"".join(_frame(item) for item in ('{"do": "stop_line"}', '{"do": "stop"}')))
        assert [json.loads(web.recv(MAX_WAIT))["told"] for _ in range(2)] == ["stop_line", "stopped"]
        assert loop.stop_count == stops + 1
        with held_up(server.tasks):
            web.send('{"do": "stop"}')
            assert json.loads(web.recv(MAX_WAIT)) == {"told": "stopped"}
            assert loop.stop_count == stops + 2


def test_tcp_stop_sent_together_with_the_stop_connection_request_is_not_lost(server):
    stops = server.open.clients.session.loop.stop_count
    with socket.create_connection(("127.0.0.1", server.port), MAX_WAIT) as client, client.makefile("rb") as answers:
        client.sendall(b'{"do": "stop_line"}\0{"do": "stop"}\0{"do": "st')
        assert [json.loads(answers.readline().strip(b"\0"))["told"] for _ in range(2)] == ["stop_line", "stopped"]
        client.sendall(b'op"}\0')
        assert json.loads(answers.readline().strip(b"\0")) == {"told": "stopped"}
    assert server.open.clients.session.loop.stop_count == stops + 2


def test_stop_connection_refuses_documents_and_occupies_no_client_slot(server, becomes):
    clients = server.open.clients
    assert becomes(lambda: not clients._clients)
    with server.client() as client:
        client.do("stop_line")
        assert json.loads(client.receive(MAX_WAIT)) == {"told": "stop_line"}
        assert becomes(lambda: not clients._clients)
        assert clients._taken == 0
        for message, result in (
            ('<bml><head lexeme="NOD"/></bml>', "refused"),
            ('{"do": "resume"}', "refused"),
            ('{"do": "nonsense"}', "refused"),
            ('{"do": "ping", "id": "x"}', "pong"),
        ):
            client.send(message)
            assert json.loads(client.receive(MAX_WAIT))["told"] == result


def test_stop_connection_that_floods_the_server_is_disconnected(guarded):
    loop = guarded.open.clients.session.loop
    with guarded.client(token="open sesame") as client:
        client.do("stop_line")
        assert json.loads(client.receive(MAX_WAIT)) == {"told": "stop_line"}
        client.send_bytes(b'{"do": "stop"}\0' * 200)
        results = []
        while not results or results[-1]["told"] != "closed":
            results.append(json.loads(client.receive(MAX_WAIT)))
    assert results[-1]["why"].startswith("rule rate")
    assert 10 <= len(results) < 200
    assert loop.stop_count >= 10


def test_stop_connection_without_the_right_token_is_refused(guarded):
    with pytest.raises(PermissionError, match="token"):
        StopLine(port=guarded.port, token="wrong")
    with pytest.raises(ConnectionError, match="a token is needed"):
        StopLine(port=guarded.port)


def test_stop_connections_beyond_the_limit_are_refused(server, monkeypatch):
    monkeypatch.setattr(stop_lines, "MAX_STOP_LINES", 1)
    with StopLine(port=server.port) as first:
        with server.client() as second:
            second.do("stop_line")
            assert "send stop by any other" in json.loads(second.receive(MAX_WAIT))["why"]
        first.stop(MAX_WAIT)


def test_opening_a_stop_connection_to_a_silent_server_raises_an_error():
    with socket.create_server(("127.0.0.1", 0)) as silent, pytest.raises(ConnectionError, match="no answer came"):
        StopLine(port=silent.getsockname()[1], timeout=0.05)


def test_late_acknowledgement_does_not_count_for_the_next_stop():
    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=_answer_once, args=(server,), daemon=True).start()
        with StopLine(port=server.getsockname()[1]) as line:
            with pytest.raises(ConnectionError, match="no answer came"):
                line.stop(0.0)
            with pytest.raises(ConnectionError):
                line.stop(0.5)


class Line:
    """Stub wire that stays silent."""

    def move(self, line) -> None:
        pass

    async def send(self, message: str) -> None:
        pass

    async def close(self, code: int, why: str) -> None:
        pass

    async def messages(self, hurry):
        await asyncio.sleep(MAX_WAIT)
        yield b""


@contextmanager
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    """Return both ends of a connection: client and server."""
    here, there = socket.socketpair()
    there.setblocking(False)
    with here, there:
        here.settimeout(MAX_WAIT)
        yield here, there


def test_failed_stop_is_reported_to_sender_and_operator(server, monkeypatch, caplog):
    for error in (BrokenPipeError("gone"), HalfError("half"), RuntimeError("closed"), ValueError("odd")):

        def fail(error=error) -> None:
            raise error

        monkeypatch.setattr(server.open.reception._stop_lines, "_emergency_stop", fail)
        with StopLine(port=server.port) as line:
            with pytest.raises(ConnectionError, match=f"may not stop .{error}.: use the switch"):
                line.stop(MAX_WAIT)
            monkeypatch.undo()
            line.stop(MAX_WAIT)  # the line is still one
        assert caplog.records[-1].exc_info[1] is error
        assert "an emergency stop failed" in caplog.text


def test_stop_connection_is_closed_and_an_error_logged_if_the_stop_fails(server, monkeypatch, caplog, becomes):
    monkeypatch.setattr(server.open.reception._stop_lines, "_emergency_stop", lambda: 1 / 0)
    with StopLine(port=server.port) as line, pytest.raises(ConnectionError, match="closed the connection"):
        line.stop(MAX_WAIT)
    assert becomes(lambda: "a stop line failed" in caplog.text)
    assert isinstance(caplog.records[-1].exc_info[1], ZeroDivisionError)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # the error is reported this way
def test_opening_stop_connections_fails_if_their_thread_ends_at_once(monkeypatch):
    def refuse():
        raise OSError("too many open files")

    monkeypatch.setattr(stop_lines, "raise_priority", refuse)
    lines = StopLines(lambda: None, Quotas())
    with pytest.raises(RuntimeError, match="stop lines has ended at once"):
        lines.open()
    lines.close()


def test_opening_stop_connections_fails_if_their_thread_cannot_start(monkeypatch):
    def refuse(_) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refuse)
    lines = StopLines(lambda: None, Quotas())
    with pytest.raises(RuntimeError, match="can't start new thread"):
        lines.open()
    lines.close()


def test_stop_connections_before_start_or_after_end_of_their_thread_are_closed():
    before, after = (StopLines(lambda: None, Quotas()) for _ in range(2))
    after.open()
    after.close()
    for lines in (before, after):
        with pair() as (here, there):
            lines.take(there, Line())
            assert here.recv(1) == b""


def test_stop_connection_opened_during_shutdown_is_closed():
    lines = StopLines(lambda: None, Quotas())
    lines.open()
    ending = threading.Thread(target=lines.close)
    with pair() as (here, there), pair() as (late, after):
        with held_up(lines._loop):
            lines.take(there, Line())
            ending.start()
            while lines._is_running:
                sleep(0.001)
            lines.take(after, Line())
            assert late.recv(1) == b""
        ending.join(MAX_WAIT)
        assert here.recv(1) == b""
    assert not lines._tasks


def _answer_once(server: socket.socket) -> None:
    """Answer a stop line request, and the first of two stops after the second."""
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
    """Return a masked text frame with a mask of zeros."""
    return bytes((0x81, 0x80 | len(text))) + bytes(4) + text.encode()
