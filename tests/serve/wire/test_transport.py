import asyncio
import socket
from contextlib import suppress

import pytest

from kinesic.serve.wire.transport import CHUNK_SIZE, UNADMITTED_READ_LIMIT, OverlongError, Transport

pytestmark = pytest.mark.realtime

LARGE_DATA = bytes(8_000_000)  # more than socket buffers hold
ANSWER = b"too much"


def test_client_that_sends_too_much_data_still_reads_the_close_reason():
    assert asyncio.run(_sent_home(LARGE_DATA)) == ANSWER


def test_refused_connection_is_closed_after_a_timeout_if_the_client_stays_connected():
    assert asyncio.run(_sent_home(b"x", patience=0.1)) == ANSWER


async def _sent_home(said: bytes, *, patience: float = 10.0) -> bytes:
    """Return the data received by a client that is refused after its first bytes."""
    here, end = socket.socketpair()
    here.setblocking(False)
    line = Transport(here, patience, at_once)
    line.admit()
    with end:
        hearing = asyncio.create_task(asyncio.to_thread(_told, end, said))
        assert 0 < len(await line.read(hurry=True)) <= CHUNK_SIZE
        await line.write([ANSWER])
        await line.close()
        return await hearing


async def at_once() -> None:
    """Let the connection read immediately."""


def test_data_read_from_a_client_before_admission_is_limited():
    async def read() -> int:
        here, end = socket.socketpair()
        here.setblocking(False)
        line, total = Transport(here, 10.0, at_once), 0
        with here, end:
            end.send(bytes(3 * UNADMITTED_READ_LIMIT))
            while total < UNADMITTED_READ_LIMIT:
                total += len(await line.read(hurry=True))
            with pytest.raises(OverlongError, match="bytes are read from a client without the token"):
                await line.read(hurry=True)
            line.admit()
            return total + len(await line.read(hurry=True))

    assert UNADMITTED_READ_LIMIT < asyncio.run(read()) <= 3 * UNADMITTED_READ_LIMIT


def test_concurrently_sent_messages_are_not_interleaved():
    async def send() -> bytes:
        here, end = socket.socketpair()
        here.setblocking(False)
        line = Transport(here, 10.0, at_once)
        with here, end:
            hearing = asyncio.create_task(asyncio.to_thread(_heard, end, 2 * len(LARGE_DATA)))
            await asyncio.gather(line.write([LARGE_DATA]), line.write([LARGE_DATA.replace(b"\0", b"x")]))
            return await hearing

    assert asyncio.run(send()) == LARGE_DATA + LARGE_DATA.replace(b"\0", b"x")


def _heard(end: socket.socket, much: int) -> bytes:
    heard = bytearray()
    while len(heard) < much:
        heard += end.recv(CHUNK_SIZE)
    return bytes(heard)


def _told(end: socket.socket, said: bytes) -> bytes:
    with suppress(OSError):  # the rest is ignored
        end.sendall(said)
    heard = b""
    while piece := end.recv(CHUNK_SIZE):
        heard += piece
    return heard
