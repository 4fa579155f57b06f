import asyncio
import socket
from contextlib import suppress

import pytest

from kinesic.serve.wire.transport import CHUNK, UNKNOWN, OverlongError, Transport

pytestmark = pytest.mark.realtime

MUCH = bytes(8_000_000)  # more than sockets keep
ANSWER = b"too much"


def test_a_client_that_says_too_much_still_reads_why_it_is_sent_home():
    assert asyncio.run(_sent_home(MUCH)) == ANSWER


def test_a_client_that_never_ends_its_side_is_left_after_a_while():
    assert asyncio.run(_sent_home(b"x", patience=0.1)) == ANSWER


async def _sent_home(said: bytes, *, patience: float = 10.0) -> bytes:
    """What a client hears that says a lot and is answered after the first piece."""
    here, end = socket.socketpair()
    here.setblocking(False)
    line = Transport(here, patience, at_once)
    line.admit()
    with end:
        hearing = asyncio.create_task(asyncio.to_thread(_told, end, said))
        assert 0 < len(await line.read(hurry=True)) <= CHUNK
        await line.write([ANSWER])
        await line.close()
        return await hearing


async def at_once() -> None:
    """The turn of a connection beside which there is no other."""


def test_little_is_read_of_a_client_that_is_not_admitted():
    async def read() -> int:
        here, end = socket.socketpair()
        here.setblocking(False)
        line, total = Transport(here, 10.0, at_once), 0
        with here, end:
            end.send(bytes(3 * UNKNOWN))
            while total < UNKNOWN:
                total += len(await line.read(hurry=True))
            with pytest.raises(OverlongError, match="has not shown the token"):
                await line.read(hurry=True)
            line.admit()
            return total + len(await line.read(hurry=True))

    assert UNKNOWN < asyncio.run(read()) <= 3 * UNKNOWN


def test_what_two_tasks_send_is_not_mixed():
    async def send() -> bytes:
        here, end = socket.socketpair()
        here.setblocking(False)
        line = Transport(here, 10.0, at_once)
        with here, end:
            hearing = asyncio.create_task(asyncio.to_thread(_heard, end, 2 * len(MUCH)))
            await asyncio.gather(line.write([MUCH]), line.write([MUCH.replace(b"\0", b"x")]))
            return await hearing

    assert asyncio.run(send()) == MUCH + MUCH.replace(b"\0", b"x")


def _heard(end: socket.socket, much: int) -> bytes:
    heard = bytearray()
    while len(heard) < much:
        heard += end.recv(CHUNK)
    return bytes(heard)


def _told(end: socket.socket, said: bytes) -> bytes:
    with suppress(OSError):  # the rest is not wanted
        end.sendall(said)
    heard = b""
    while piece := end.recv(CHUNK):
        heard += piece
    return heard
