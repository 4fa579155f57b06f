"""Limits, bursts and times of connections, on simulated sockets."""

import asyncio
import errno
import socket
from contextlib import suppress
from types import SimpleNamespace

import pytest

from kinesic.body.config import ConfigError
from kinesic.serve import reception
from kinesic.serve.reception import Reception
from kinesic.serve.wire.quotas import Quotas, TokenBucket

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
def test_at_most_32_connections_are_accepted_per_listener_event(door, loop, count, accepted):
    listener = PlayedListener(count, BlockingIOError())
    door._accept(listener)
    assert len(listener.accepted) == len(door._pending) == accepted
    assert loop.of("call_later")[0][0] == 3.0
    assert {pending.address for pending in door._pending} == {"192.0.2.1:5000"}
    assert not any(connection.getblocking() for connection in listener.accepted)
    assert loop.of("remove_reader") == []
    listener.close()


@pytest.mark.parametrize("error", [BlockingIOError(), ConnectionAbortedError()])
def test_lost_connection_does_not_pause_the_listener(door, loop, error):
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


def test_at_least_the_requested_number_of_oldest_pending_connections_is_dropped(door):
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
    """Record the addresses of a host name, and the created servers."""
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


def test_unusable_address_is_reported_with_its_reason_and_a_remedy(door, monkeypatch):
    def fail(*_, **__):
        raise OSError(98, "Address already in use (while attempting to bind)")

    monkeypatch.setattr(reception.socket, "getaddrinfo", fail)
    with pytest.raises(ConfigError, match=r"--listen robot:80: address already in use; give another one, or port 0"):
        door.listen("robot", 80)


def test_connections_use_tcp_keep_alive_and_send_small_messages_without_delay() -> None:
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
def test_admitted_client_has_no_read_limit_and_client_with_a_slot_has_a_larger_read_burst(door, placed, admitted):
    calls: list[object] = []
    line = SimpleNamespace(admit=lambda: calls.append("admit"))
    reads = SimpleNamespace(widen=calls.append)
    door._pending["pending"] = None
    door._notice("pending", line, reads, SimpleNamespace(placed=placed, admitted=admitted))
    assert calls == ["admit"] * admitted + [20] * placed
    assert ("pending" in door._pending) is not placed


def test_first_four_reads_of_a_connection_are_not_rate_limited(monkeypatch) -> None:
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
