"""Limits, bursts and times of connections, on played sockets."""

import asyncio
import errno
import socket
from contextlib import suppress
from types import SimpleNamespace

import pytest

from kinesic.body.config import ConfigError
from kinesic.serve import conversation, reception, stop_lines
from kinesic.serve.reception import Reception
from kinesic.serve.stop_lines import StopLines
from kinesic.serve.wire import transport, websocket
from kinesic.serve.wire.quotas import Quotas, TokenBucket
from kinesic.serve.wire.transport import Transport
from kinesic.serve.wire.websocket import WebSocket

from .played_door import PlayedStopLines, opened
from .played_registry import TOKEN_ACCESS, Registry


class PlayedListener:
    """Listener that accepts a number of connections, and then fails."""

    def __init__(self, count: int, error: OSError) -> None:
        self.count, self.error = count, error
        self.accepted: list[socket.socket] = []
        self._clients: list[socket.socket] = []

    def accept(self):
        if len(self.accepted) == self.count:
            raise self.error
        here, client = socket.socketpair()
        self.accepted.append(here)
        self._clients.append(client)
        return here, ("192.0.2.1", 5000, 0, 0)

    def close(self) -> None:
        for connection in (*self.accepted, *self._clients):
            connection.close()


class PlayedLoop:
    """Event loop that only records its callbacks."""

    def __init__(self) -> None:
        self.calls: list[tuple] = []

    def __getattr__(self, name):
        def record(*given):
            self.calls.append((name, *given))
            return SimpleNamespace(cancel=lambda: None)

        return record

    def of(self, name: str) -> list[tuple]:
        return [call[1:] for call in self.calls if call[0] == name]


@pytest.fixture
def loop(monkeypatch) -> PlayedLoop:
    played = PlayedLoop()
    monkeypatch.setattr(reception, "get_running_loop", lambda: played)
    return played


@pytest.fixture
def door(loop) -> Reception:
    return Reception(Registry(rules=Quotas(patience=3.0)), PlayedStopLines())


@pytest.mark.parametrize(("count", "accepted"), [(31, 31), (99, 32)])
def test_other_tasks_run_after_thirty_two_accepted_connections(door, loop, count, accepted):
    listener = PlayedListener(count, BlockingIOError())
    door._accept(listener)
    assert len(listener.accepted) == len(door._pending) == accepted
    assert loop.of("call_later")[0][0] == 3.0
    assert {pending.address for pending in door._pending} == {"192.0.2.1:5000"}
    assert not any(connection.getblocking() for connection in listener.accepted)
    assert loop.of("remove_reader") == []
    listener.close()


@pytest.mark.parametrize("error", [BlockingIOError(), ConnectionAbortedError()])
def test_listener_goes_on_after_a_lost_connection(door, loop, error):
    door._accept(PlayedListener(0, error))
    assert loop.calls == []


def test_listener_pauses_at_the_limit_of_open_files(door, loop):
    listener = PlayedListener(2, OSError(errno.EMFILE, "Too many open files"))
    door._listeners.append(listener)
    door._accept(listener)
    assert [pending.socket for pending in door._pending] == listener.accepted[1:]
    ((delay, again, its),) = [call for call in loop.of("call_later") if call[0] != 3.0]
    assert (delay, its) == (0.1, listener)
    assert loop.of("remove_reader")[-1] == (listener,)
    assert listener.accepted[0].fileno() == -1
    loop.calls.clear()
    again(listener)
    assert loop.of("add_reader")[0][0] is listener
    door._listeners.clear()
    loop.calls.clear()
    again(listener)
    assert loop.calls == []
    listener.close()


def test_oldest_connections_are_dropped_until_there_is_room(door):
    listener = PlayedListener(6, BlockingIOError())
    door._max_pending = 4
    door._accept(listener)
    assert [pending.socket for pending in door._pending] == listener.accepted[2:]
    door._drop_pending(min_count=3)
    assert [pending.socket for pending in door._pending] == listener.accepted[5:]
    door._drop_pending(min_count=0)
    assert len(door._pending) == 1
    door._drop_pending(min_count=9)
    assert len(door._pending) == 0
    assert {connection.fileno() for connection in listener.accepted} == {-1}
    listener.close()


@pytest.fixture
def addresses(monkeypatch):
    """Addresses that a name has, and the servers that are created."""
    found: list[tuple] = []
    created: list[tuple] = []
    monkeypatch.setattr(reception.socket, "getaddrinfo", lambda host, port, **_: found)

    def create(address, *, family, backlog):
        created.append((address, family, backlog))
        return SimpleNamespace(
            setblocking=created.append,
            getsockname=lambda: ("", 7007),
            close=lambda: None,
        )

    monkeypatch.setattr(reception.socket, "create_server", create)
    return found, created


def test_all_addresses_of_a_host_get_the_same_port(door, addresses):
    found, created = addresses
    found += [(socket.AF_INET, 1, 6, "", ("192.0.2.1", 0))] * 2
    found += [(socket.AF_INET6, 1, 6, "", ("2001:db8::1", 0, 0, 0))]
    assert door.listen("robot", 0) == 7007
    assert created == [
        (("192.0.2.1", 0), socket.AF_INET, 4096),
        False,
        (("2001:db8::1", 7007), socket.AF_INET6, 4096),
        False,
    ]


def test_refused_address_is_reported_without_details_of_the_system(door, monkeypatch):
    def fail(*_, **__):
        raise OSError(98, "Address already in use (while attempting to bind)")

    monkeypatch.setattr(reception.socket, "getaddrinfo", fail)
    with pytest.raises(ConfigError, match=r"--listen robot:80: address already in use; give another one, or port 0"):
        door.listen("robot", 80)


def test_connections_keep_alive_and_send_small_messages_at_once() -> None:
    async def run() -> list[int]:
        async with opened() as door:
            await door.connect(b'{"do": "stop_line"}\0')
            while not door.stop_lines.taken:
                await asyncio.sleep(0.005)
            with door.stop_lines.taken[0] as taken:
                return [
                    taken.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE),
                    taken.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY),
                    taken.getsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF),
                ]

    alive, prompt, size = asyncio.run(run())
    assert alive
    assert prompt
    assert size in (65_536, 131_072)  # Linux doubles the size


@pytest.mark.parametrize(("placed", "admitted"), [(False, False), (False, True), (True, False), (True, True)])
def test_limits_are_lifted_for_admitted_and_for_placed_clients(door, placed, admitted):
    calls: list[object] = []
    line = SimpleNamespace(admit=lambda: calls.append("admit"))
    reads = SimpleNamespace(widen=calls.append)
    door._pending["pending"] = None
    door._notice("pending", line, reads, SimpleNamespace(placed=placed, admitted=admitted))
    assert calls == ["admit"] * admitted + [20] * placed
    assert ("pending" in door._pending) is not placed


def test_first_reads_of_a_connection_have_a_burst_of_four(monkeypatch) -> None:
    bursts = []

    def make(rate: float, burst: int) -> TokenBucket:
        bursts.append((rate, burst))
        return TokenBucket(rate, burst)

    monkeypatch.setattr(reception, "TokenBucket", make)

    async def run() -> None:
        async with opened(TOKEN_ACCESS, Quotas(rate=9.0, patience=0.05)) as door:
            reader, _ = await door.connect(b"x")
            with suppress(OSError):
                await reader.read()

    asyncio.run(run())
    assert bursts == [(9.0, 4)]


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
def test_first_bytes_are_read_until_the_protocol_is_known(chunks, first):
    line = PlayedLine(*chunks)
    assert asyncio.run(reception._read_first(line)) == first
    assert set(line.hurries) == {True}


def test_client_without_the_token_is_read_to_eight_kibibytes() -> None:
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


def test_closing_waits_a_second_for_the_client_and_discards_data_slowly(monkeypatch) -> None:
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


def test_unfinished_blocks_of_a_client_are_checked_twenty_times_a_second(monkeypatch) -> None:
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


def test_sixty_fourth_stop_connection_is_served() -> None:
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
