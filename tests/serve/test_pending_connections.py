"""Connections that wait for admission, and the end of all connections."""

import asyncio
import errno
import json
import socket
from collections.abc import Iterator
from dataclasses import replace
from select import select

import pytest

from kinesic.serve import reception as reception_module
from kinesic.serve.reception import ADMITTED_READ_BURST, INITIAL_READ_BURST
from kinesic.serve.wire.origin import OPEN_ACCESS

from .played_door import PING, PONG, RULES, opened
from .played_registry import TOKEN_ACCESS


@pytest.fixture(autouse=True)
def no_loop_errors(caplog: pytest.LogCaptureFixture) -> Iterator[None]:
    """Callbacks of the event loop that fail are only logged."""
    yield
    assert [record.message for record in caplog.records if record.levelname == "ERROR"] == []


@pytest.mark.parametrize("first", [b"", b"<bml>"])
@pytest.mark.parametrize(("file_limit", "upper_bound"), [(7, 2048), (1_000_000, 3)])
def test_new_connections_replace_the_oldest_silent_ones(
    monkeypatch: pytest.MonkeyPatch, file_limit: int, upper_bound: int, first: bytes
) -> None:
    monkeypatch.setattr(reception_module, "max_open_files", lambda: file_limit)
    monkeypatch.setattr(reception_module, "MAX_PENDING_CONNECTIONS", upper_bound)

    async def run() -> None:
        async with opened(rules=replace(RULES, patience=0.5)) as door:
            present, _ = await door.connect(PING)
            await present.readuntil(b"\0")
            silent = [await door.connect(first) for _ in range(5)]
            assert await silent[0][0].read() == await silent[1][0].read() == b""
            assert len(door.reception._pending) == 3
            assert not any(reader.at_eof() for reader, _ in silent[2:])
            assert await door.ask(PING) == PONG
            await asyncio.sleep(0.6)  # until the replaced connections would have timed out
            assert not present.at_eof()

    asyncio.run(run())


def test_replaced_connection_that_has_begun_to_send_leaves_no_running_task(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reception_module, "MAX_PENDING_CONNECTIONS", 2)

    async def run() -> None:
        async with opened() as door:
            replaced, _ = await door.connect(b"<bml>")
            while not door.reception._tasks:
                await asyncio.sleep(0.005)
            task = next(iter(door.reception._tasks))
            for _ in range(2):
                await door.connect()
            assert await replaced.read() == b""
            await asyncio.wait([task], timeout=5.0)  # long before the patience ends
            assert task.cancelled()
            assert not door.reception._tasks

    asyncio.run(run())


@pytest.mark.parametrize("is_served", [False, True])
def test_dismissed_connection_leaves_neither_timer_nor_reader_behind(is_served: bool) -> None:
    async def run() -> None:
        loop, (near, far) = asyncio.get_running_loop(), socket.socketpair()
        with near, far:
            pending = reception_module.PendingConnection(near, "here")
            pending.watch = watch = loop.call_later(60.0, pending.dismiss)
            if is_served:
                pending.task = asyncio.create_task(asyncio.sleep(60.0))
            else:
                loop.add_reader(near, pending.dismiss)
            pending.dismiss()
            assert watch.cancelled()
            if pending.task is not None:
                await asyncio.wait([pending.task], timeout=5.0)
                assert pending.task.cancelled()
            else:
                assert near.fileno() == -1
                assert far.recv(1) == b""

    asyncio.run(run())


class FullListener(socket.socket):
    """Listener on a machine that can open only a few more files."""

    def __init__(self, free: int) -> None:
        super().__init__()
        self.free = free
        self.bind(("127.0.0.1", 0))
        self.listen()
        self.setblocking(False)

    def accept(self) -> tuple[socket.socket, object]:
        if self.free == 0 and select([self], [], [], 0.0)[0]:
            raise OSError(errno.EMFILE, "Too many open files")
        accepted = super().accept()
        self.free -= 1
        return accepted


def test_oldest_pending_connection_is_closed_when_the_server_runs_out_of_file_descriptors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(reception_module, "ACCEPT_RETRY_DELAY", 0.05)

    async def run() -> None:
        async with opened() as door:
            listener = FullListener(2)
            door.reception.close()
            door.reception._listeners.append(listener)
            door.port = listener.getsockname()[1]
            door.reception.open()
            silent = [await door.connect() for _ in range(2)]
            while len(door.reception._pending) < 2:
                await asyncio.sleep(0.005)
            waiting = asyncio.create_task(door.ask(PING))
            assert await silent[0][0].read() == b""
            assert len(door.reception._pending) == 1
            listener.free = 100
            assert await waiting == PONG

    asyncio.run(run())


@pytest.mark.parametrize(("placed", "burst"), [(False, INITIAL_READ_BURST), (True, ADMITTED_READ_BURST)])
def test_admitted_client_has_a_larger_read_burst_than_a_pending_connection(
    monkeypatch: pytest.MonkeyPatch, placed: bool, burst: int
) -> None:
    """A pending connection waits for its turn after only a few reads."""
    monkeypatch.setattr("kinesic.serve.wire.quotas.monotonic", lambda: 0.0)
    turns: list[int] = []

    class CountedPace:
        async def await_turn(self, bucket) -> None:
            turns.append(bucket.take())

    monkeypatch.setattr(reception_module, "ReadPace", CountedPace)

    async def run() -> None:
        async with opened(OPEN_ACCESS if placed else TOKEN_ACCESS) as door:
            _, writer = await door.connect(PING if placed else b"<")
            for count in range(1, 2 * ADMITTED_READ_BURST):
                while len(turns) < count:
                    await asyncio.sleep(0.001)
                writer.write(b"x")

    asyncio.run(run())
    assert sum(turns) == burst


def test_server_end_lets_clients_read_their_last_messages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reception_module, "CLOSING_TIMEOUT", 0.05)

    async def run() -> tuple[bytes, bytes, bytes]:
        async with opened() as door:
            silent, _ = await door.connect()
            talking, _ = await door.connect(PING)
            await talking.readuntil(b"\0")
            endless, _ = await door.connect(b"<bml>")
            while len(door.registry._clients) < 2:
                await asyncio.sleep(0.005)
            next(iter(door.registry._clients.values())).close(1001, "the server ends")
            door.reception.close()
            await door.reception.end()
            assert not door.reception._tasks
            return await silent.read(), await talking.read(), await endless.read()

    silent, talking, endless = asyncio.run(run())
    assert silent == endless == b""
    assert json.loads(talking.strip(b"\n\0")) == {"told": "closed", "code": 1001, "why": "the server ends"}


@pytest.mark.parametrize(("open_files", "pending"), [(100, 50), (4095, 2047), (1_000_000, 2048)])
def test_pending_connections_use_at_most_half_of_the_limit_of_open_files(
    monkeypatch: pytest.MonkeyPatch, open_files: int, pending: int
) -> None:
    monkeypatch.setattr(reception_module, "max_open_files", lambda: open_files)

    async def run() -> int:
        async with opened() as door:
            return door.reception._max_pending

    assert asyncio.run(run()) == pending
