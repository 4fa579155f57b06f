import asyncio
import socket
from asyncio import StreamReader, StreamWriter

import pytest

from kinesic.serve.transport import CHUNK, Transport

pytestmark = pytest.mark.realtime

MUCH = bytes(8_000_000)  # more than sockets keep
ANSWER = b"too much"


def test_a_client_that_says_too_much_still_reads_why_it_is_sent_home():
    assert asyncio.run(_sent_home(MUCH)) == ANSWER


def test_a_client_that_never_ends_its_side_is_left_after_a_while():
    assert asyncio.run(_sent_home(b"x", patience=0.1)) == ANSWER


async def _sent_home(said: bytes, *, patience: float = 10.0) -> bytes:
    """What a client hears that says a lot and is answered after the first piece."""
    gone = asyncio.Event()

    async def client(reader: StreamReader, writer: StreamWriter) -> None:
        line = Transport(reader, writer, patience)
        assert 0 < len(await line.read(hurry=True)) <= CHUNK
        await line.write([ANSWER])
        await line.close()
        gone.set()

    async with await asyncio.start_server(client, "127.0.0.1", 0) as server:
        address = server.sockets[0].getsockname()
        with socket.create_connection(address) as end:
            heard = await asyncio.to_thread(_told, end, said)
            if len(said) < CHUNK:
                await gone.wait()
        await gone.wait()
    return heard


def _told(end: socket.socket, said: bytes) -> bytes:
    end.sendall(said)
    heard = b""
    while piece := end.recv(CHUNK):
        heard += piece
    return heard
