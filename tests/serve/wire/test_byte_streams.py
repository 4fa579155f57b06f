"""Transports over socket pairs, and messages over byte streams."""

import asyncio
import json
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import pytest

from kinesic.serve.wire import transport
from kinesic.serve.wire.transport import (
    CHUNK_SIZE,
    DISCARD_PERIOD,
    UNADMITTED_READ_LIMIT,
    HalfError,
    OverlongError,
    Stream,
    Transport,
)

SHORT_TIMEOUT = 0.03  # [s] timeout that is meant to expire
LONG_TIMEOUT = 30.0  # [s] timeout that is not meant to expire
LARGE_DATA = bytes(8_000_000)  # more than two sockets buffer


async def no_turn() -> None:
    """Turn of a connection without competitors."""


@asynccontextmanager
async def connected(
    patience: float = LONG_TIMEOUT, await_turn: Callable[[], Awaitable[None]] = no_turn
) -> AsyncIterator[tuple[Transport, socket.socket, socket.socket]]:
    """Transport to a client, the server's socket and the client's."""
    here, client = socket.socketpair()
    here.setblocking(False)
    with here, client:
        client.settimeout(LONG_TIMEOUT)
        yield Transport(here, patience, await_turn), here, client


async def receive_all(client: socket.socket) -> bytes:
    """Return all bytes that the server sends until it ends its side."""

    def receive() -> bytes:
        return b"".join(iter(lambda: client.recv(CHUNK_SIZE), b""))

    return await asyncio.to_thread(receive)


def test_reading_a_connection_returns_the_sent_bytes_and_then_its_end() -> None:
    async def read() -> list[bytes]:
        async with connected() as (line, _, client):
            client.sendall(b"some words")
            client.shutdown(socket.SHUT_WR)
            return [await line.read(hurry=True), await line.read(hurry=True)]

    assert asyncio.run(read()) == [b"some words", b""]


def test_read_from_a_silent_client_times_out() -> None:
    async def read() -> None:
        async with connected(SHORT_TIMEOUT) as (line, _, _):
            await line.read(hurry=True)

    with pytest.raises(HalfError, match=r"no data arrived for 0\.03 s"):
        asyncio.run(read())


def test_idle_client_without_time_limit_may_stay_silent() -> None:
    async def read() -> bytes:
        async with connected(SHORT_TIMEOUT) as (line, _, client):
            reading = asyncio.create_task(line.read(hurry=False))
            await asyncio.sleep(4 * SHORT_TIMEOUT)
            client.sendall(b"late")
            return await reading

    assert asyncio.run(read()) == b"late"


def test_each_transport_read_waits_for_its_turn_among_connections() -> None:
    turns: list[int] = []

    async def count_turn() -> None:
        turns.append(len(turns))

    async def read() -> None:
        async with connected(LONG_TIMEOUT, count_turn) as (line, _, client):
            client.sendall(b"x")
            await line.read(hurry=True)
            client.sendall(b"y")
            await line.read(hurry=False)

    asyncio.run(read())
    assert turns == [0, 1]


def test_waiting_for_a_read_turn_counts_towards_the_silence_timeout() -> None:
    async def read() -> None:
        async with connected(SHORT_TIMEOUT, asyncio.Event().wait) as (line, _, client):
            client.sendall(b"x")
            await line.read(hurry=True)

    with pytest.raises(HalfError):
        asyncio.run(read())


def test_number_of_bytes_read_from_a_client_is_limited_until_admission() -> None:
    async def read() -> tuple[list[int], int]:
        async with connected() as (line, _, client):
            client.sendall(bytes(1000))
            sizes = [len(await line.read(hurry=True))]
            client.sendall(bytes(3 * UNADMITTED_READ_LIMIT))
            while sum(sizes) < UNADMITTED_READ_LIMIT:
                sizes.append(len(await line.read(hurry=True)))
            with pytest.raises(OverlongError, match=f"at most {UNADMITTED_READ_LIMIT} bytes"):
                await line.read(hurry=True)
            line.admit()
            return sizes, len(await line.read(hurry=True))

    sizes, admitted = asyncio.run(read())
    assert sizes[0] == 1000
    assert sum(sizes) == UNADMITTED_READ_LIMIT
    assert admitted == min(1000 + 2 * UNADMITTED_READ_LIMIT, CHUNK_SIZE)


def test_one_read_of_a_connection_returns_at_most_one_chunk() -> None:
    async def read() -> int:
        async with connected() as (line, _, client):
            line.admit()
            sending = asyncio.create_task(asyncio.to_thread(client.sendall, bytes(3 * CHUNK_SIZE)))
            sizes = [0]
            while sum(sizes) < 3 * CHUNK_SIZE:
                sizes.append(len(await line.read(hurry=True)))
            await sending
            return max(sizes)

    assert asyncio.run(read()) <= CHUNK_SIZE


def test_data_written_concurrently_to_a_connection_are_not_interleaved() -> None:
    async def write() -> bytes:
        async with connected() as (line, here, client):
            hearing = asyncio.create_task(receive_all(client))
            await asyncio.gather(line.write([b"a" * 3_000_000, b"a"]), line.write([b"b" * 3_000_000, b"b"]))
            here.shutdown(socket.SHUT_WR)
            return await hearing

    received = asyncio.run(write())
    assert received in (b"a" * 3_000_001 + b"b" * 3_000_001, b"b" * 3_000_001 + b"a" * 3_000_001)


def test_writing_an_empty_chunk_ends_sending_but_not_receiving() -> None:
    async def write() -> tuple[bytes, bytes]:
        async with connected() as (line, _, client):
            await line.write([b"one ", b"two", b""])
            heard = await receive_all(client)
            client.sendall(b"answer")
            return heard, await line.read(hurry=True)

    assert asyncio.run(write()) == (b"one two", b"answer")


def test_writing_to_a_client_that_does_not_read_times_out() -> None:
    async def write() -> None:
        async with connected(SHORT_TIMEOUT) as (line, _, _):
            await line.write([LARGE_DATA])

    with pytest.raises(TimeoutError):
        asyncio.run(write())


def test_closing_connection_reads_and_discards_data_slowly_so_that_no_reset_is_sent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without this delay, a connection reset would discard the last message."""
    pauses: list[float] = []

    async def note_pause(seconds: float) -> None:
        pauses.append(seconds)

    monkeypatch.setattr(transport, "sleep", note_pause)

    async def close() -> tuple[bytes, int]:
        async with connected() as (line, here, client):
            client.sendall(bytes(2 * UNADMITTED_READ_LIMIT))
            client.shutdown(socket.SHUT_WR)
            await line.write([b"goodbye"])
            await line.close()
            return await receive_all(client), here.fileno()

    assert asyncio.run(close()) == (b"goodbye", -1)
    assert pauses
    assert set(pauses) == {DISCARD_PERIOD}


@pytest.mark.parametrize(("patience", "linger"), [(SHORT_TIMEOUT, LONG_TIMEOUT), (LONG_TIMEOUT, SHORT_TIMEOUT)])
def test_closing_a_connection_waits_for_the_client_only_up_to_a_timeout(
    monkeypatch: pytest.MonkeyPatch, patience: float, linger: float
) -> None:
    monkeypatch.setattr(transport, "LINGER_TIMEOUT", linger)

    async def close() -> int:
        async with connected(patience) as (line, here, _):
            async with asyncio.timeout(LONG_TIMEOUT / 2):
                await line.close()
            return here.fileno()

    assert asyncio.run(close()) == -1


def test_closing_a_lost_connection_does_not_fail() -> None:
    async def close() -> int:
        async with connected() as (line, here, client):
            client.sendall(b"unread")
            client.close()
            await line.close()
            return here.fileno()

    assert asyncio.run(close()) == -1


class ScriptedLine:
    """Transport that returns prepared bytes and records what is written."""

    def __init__(self, *chunks: bytes) -> None:
        self.chunks, self.hurries = list(chunks), list[bool]()
        self.written, self.closed = b"", False

    async def read(self, *, hurry: bool) -> bytes:
        self.hurries.append(hurry)
        return self.chunks.pop(0) if self.chunks else b""

    async def write(self, pieces) -> None:
        self.written += b"".join(pieces)

    async def close(self) -> None:
        self.closed = True


async def collect(messages: AsyncIterator[bytes]) -> list[bytes]:
    return [message async for message in messages]


def test_stream_messages_are_complete_and_in_order() -> None:
    line = ScriptedLine(b"st\0", b"two\0thr", b"ee\0")
    stream = Stream(line, b"fir", 100)
    assert asyncio.run(collect(stream.messages(lambda: False))) == [b"first", b"two", b"three"]


def test_stream_read_is_urgent_only_while_a_message_is_incomplete() -> None:
    line = ScriptedLine(b"o", b"ne\0", b"two\0")
    asyncio.run(collect(Stream(line, b"", 100).messages(lambda: False)))
    assert line.hurries == [False, True, False, False]
    line = ScriptedLine(b"one\0")
    asyncio.run(collect(Stream(line, b"", 100).messages(lambda: True)))
    assert line.hurries == [True, True]


def test_connection_that_ends_within_a_message_is_reported() -> None:
    with pytest.raises(HalfError, match="the connection ended"):
        asyncio.run(collect(Stream(ScriptedLine(b"whole\0ha"), b"", 100).messages(lambda: False)))


def test_stream_message_may_be_as_long_as_the_limit_and_no_longer() -> None:
    assert asyncio.run(collect(Stream(ScriptedLine(b"12345\0"), b"", 5).messages(lambda: False))) == [b"12345"]
    with pytest.raises(ValueError, match="at most 5 are read"):
        asyncio.run(collect(Stream(ScriptedLine(b"123456\0"), b"", 5).messages(lambda: False)))


def test_message_stream_moved_to_another_transport_keeps_buffered_messages() -> None:
    async def move() -> tuple[list[bytes], ScriptedLine]:
        old, new = ScriptedLine(b"one\0two\0thr"), ScriptedLine(b"ee\0")
        stream = Stream(old, b"", 100)
        first = await anext(stream.messages(lambda: False))
        stream.move(new)
        rest = await collect(stream.messages(lambda: False))
        await stream.send("answer")
        return [first, *rest], new

    messages, new = asyncio.run(move())
    assert messages == [b"one", b"two", b"three"]
    assert new.written == b"answer\n\0"


@pytest.mark.parametrize("why", ["", "too many"])
def test_closing_a_stream_sends_the_reason_if_there_is_one(why: str) -> None:
    line = ScriptedLine()
    asyncio.run(Stream(line, b"", 100).close(1013, why))
    assert line.closed
    if why:
        assert line.written.endswith(b"\n\0")
        assert json.loads(line.written.rstrip(b"\n\0")) == {"told": "closed", "code": 1013, "why": "too many"}
    else:
        assert line.written == b""


def test_byte_stream_client_may_still_receive_after_it_ended_sending() -> None:
    assert Stream(ScriptedLine(), b"", 100).lingers
