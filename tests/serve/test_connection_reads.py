"""First bytes, closing and read limits of connections."""

import asyncio
import socket
from types import SimpleNamespace

import pytest

from kinesic.serve import conversation, reception, stop_lines
from kinesic.serve.stop_lines import StopLines
from kinesic.serve.wire import transport, websocket
from kinesic.serve.wire.quotas import Quotas
from kinesic.serve.wire.transport import Transport
from kinesic.serve.wire.websocket import WebSocket

from .played_registry import Registry


class PlayedLine:
    """Transport that returns prepared bytes."""

    def __init__(self, *chunks: bytes) -> None:
        self.chunks, self.hurries = list(chunks), []

    async def read(self, *, hurry: bool) -> bytes:
        self.hurries.append(hurry)
        return self.chunks.pop(0) if self.chunks else b""


@pytest.mark.parametrize(
    ("chunks", "first"),
    [
        ([b"G", b"E", b"T", b" ", b"/", b"x"], b"GET /"),
        ([b" \n", b"<", b"bml"], b" \n<"),
        ([b"GE", b"x", b"T"], b"GEx"),
        ([b"GE"], b"GE"),
        ([b" " * 8191, b" ", b"<"], b" " * 8192),
        ([], b""),
    ],
)
def test_first_bytes_of_a_connection_are_read_until_its_protocol_is_known(chunks, first):
    line = PlayedLine(*chunks)
    assert asyncio.run(reception._read_first(line)) == first
    assert set(line.hurries) == {True}


def test_at_most_eight_kibibytes_are_read_from_a_client_without_the_token() -> None:
    async def run() -> int:
        here, client = socket.socketpair()
        here.setblocking(False)

        async def no_turn() -> None: ...

        with here, client:
            line = Transport(here, 9.0, no_turn)
            client.sendall(bytes(8191))
            sizes = [len(await line.read(hurry=True))]
            client.sendall(bytes(9))
            sizes.append(len(await line.read(hurry=True)))
            return sum(sizes)

    assert asyncio.run(run()) == 8192


def test_closing_a_connection_waits_one_second_for_the_client_and_discards_its_data_slowly(monkeypatch) -> None:
    times, pauses, sizes = [], [], []

    class PlayedTimeout:
        def __init__(self, seconds: float) -> None:
            times.append(seconds)

        async def __aenter__(self) -> None: ...

        async def __aexit__(self, *_) -> None: ...

    async def note(seconds: float) -> None:
        pauses.append(seconds)

    async def receive(connection, size: int) -> bytes:
        sizes.append(size)
        return b"x" if len(sizes) == 1 else b""

    monkeypatch.setattr(transport, "timeout", PlayedTimeout)
    monkeypatch.setattr(transport, "sleep", note)

    async def run(patience: float) -> None:
        connection = SimpleNamespace(shutdown=times.append, close=lambda: times.append("closed"))
        line = Transport(connection, patience, None)
        line._loop = SimpleNamespace(sock_recv=receive)
        await line.close()

    asyncio.run(run(20.0))
    assert times == [socket.SHUT_WR, 1.0, "closed"]
    assert (pauses, sizes) == ([0.05], [65_536, 65_536])
    times.clear()
    asyncio.run(run(0.5))
    assert times[1] == 0.5


def test_websocket_parses_two_kibibytes_before_other_tasks_run(monkeypatch) -> None:
    pauses, parsed = [], []

    async def note(seconds: float) -> None:
        pauses.append(seconds)

    monkeypatch.setattr(websocket, "sleep", note)
    web = WebSocket(PlayedLine(bytes(2 * 2048 + 1)), b"", Quotas())
    web._protocol = SimpleNamespace(receive_data=lambda data: parsed.append(len(data)), receive_eof=lambda: None)

    async def run() -> list[bool]:
        return [await web._receive(hurry=False) for _ in range(4)]

    assert asyncio.run(run()) == [True, True, True, False]
    assert (parsed, pauses) == ([2048, 2048, 1], [0, 0])


def test_client_that_stopped_sending_is_checked_for_unfinished_blocks_twenty_times_a_second(monkeypatch) -> None:
    pauses = []

    async def note(seconds: float) -> None:
        pauses.append(seconds)

    class EndedWire:
        lingers = True

        async def messages(self, hurry):
            return
            yield

        async def close(self, code, why) -> None: ...

    monkeypatch.setattr(conversation, "sleep", note)
    registry = Registry()
    checks = iter([True, True, False])
    registry.session.has_unfinished_blocks = lambda number: next(checks)
    asyncio.run(conversation.serve_client(registry, EndedWire(), registry.join("a")))
    assert pauses == [0.05, 0.05]


def test_stop_connections_have_a_burst_of_twenty_reads_and_no_read_limit(monkeypatch) -> None:
    made, wires = [], []

    class PlayedTransport:
        def __init__(self, connection, patience, await_turn) -> None:
            made.append((connection, patience))

        def admit(self) -> None:
            made.append("admitted")

    monkeypatch.setattr(stop_lines, "TokenBucket", lambda rate, burst: made.append((rate, burst)))
    monkeypatch.setattr(stop_lines, "Transport", PlayedTransport)
    lines = StopLines(lambda: None, Quotas(rate=9.0, patience=3.0))
    lines._open = 64

    async def close(code: int, why: str) -> None:
        wires.append(why)

    wire = SimpleNamespace(move=wires.append, close=close)
    asyncio.run(lines._serve_connection("connection", wire))
    assert made == [(9.0, 20), ("connection", 3.0), "admitted"]
    assert isinstance(wires[0], PlayedTransport)
    assert wires[1] == "64 connections only stop already; send stop by any other"
    assert lines._open == 64


def test_stop_connection_is_served_while_63_others_are_open() -> None:
    lines = StopLines(lambda: None, Quotas())
    lines._open = 63
    sent = []

    class EndedWire:
        async def messages(self, hurry):
            return
            yield

        async def send(self, message) -> None:
            sent.append((message, lines._open))

    assert asyncio.run(lines._serve_client(EndedWire())) == (1000, "")
    assert sent == [('{"told":"stop_line"}', 64)]
    assert lines._open == 63
