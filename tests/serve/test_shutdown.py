"""Shutdown of a server and connections beyond its limits."""

import gc
import json
import logging
import socket
import struct
from contextlib import ExitStack

import pytest
from websockets.exceptions import ConnectionClosedError
from websockets.sync.client import connect

from kinesic.serve.wire.quotas import Quotas

from .conftest import Running, running

pytestmark = pytest.mark.realtime

MAX_WAIT = 20.0  # [s] longest wait for a message or condition
BLOCK = b'<bml id="late"><head id="h" lexeme="NOD" start="0"/></bml>\0'


def opened(server: Running, first: bytes = b"") -> socket.socket:
    """Return a connection that has sent a first message."""
    wire = socket.create_connection(("127.0.0.1", server.port), timeout=MAX_WAIT)
    wire.sendall(first)
    return wire


def heard(wire: socket.socket) -> bytes:
    """Return all received data until the server ends the connection."""
    said = b""
    try:
        while data := wire.recv(65536):
            said += data
    except ConnectionResetError:
        pass
    finally:
        wire.close()
    return said


def test_shutdown_notifies_clients_without_asyncio_or_resource_warnings(caplog: pytest.LogCaptureFixture, recwarn):
    with caplog.at_level(logging.WARNING, "asyncio"):
        with running(Quotas(patience=2.0)) as server:
            idle, half, deaf = opened(server, BLOCK), opened(server, BLOCK[:20]), opened(server)
            silent = opened(server, b'{"do": "ping"}\0')
            silent.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            page = connect(f"ws://127.0.0.1:{server.port}")
            page.send('{"do": "ping"}')
            assert "pong" in page.recv(MAX_WAIT)
            silent.close()  # a reset
        last = heard(idle).rstrip(b"\0\n").split(b"\0")[-1]
        assert json.loads(last) == {"told": "closed", "code": 1001, "why": "the server ends"}
        heard(half), heard(deaf)
        for _ in page:
            pass
        assert page.close_code == 1001
        page.close()
        with pytest.raises(RuntimeError, match="the control loop has ended"):  # no client receives an acknowledgement
            server.open.clients.session.emergency_stop()
        gc.collect()
    assert [record.getMessage() for record in caplog.records] == []
    assert [str(warning.message) for warning in recwarn.list if warning.category is ResourceWarning] == []


def test_18_clients_beyond_the_limit_are_told_the_reason_of_their_refusal():
    with running(Quotas(clients=3, patience=2.0)) as server, ExitStack() as opened_clients:
        inside = [opened_clients.enter_context(server.client()) for _ in range(3)]
        for client in inside:
            client.do("ping")
            assert "pong" in client.receive(MAX_WAIT)
        for _ in range(12):
            assert b"rule clients: 3 are connected already" in heard(opened(server, b'{"do": "ping"}\0'))
        for _ in range(6):
            page = connect(f"ws://127.0.0.1:{server.port}")
            page.send('{"do": "ping"}')
            with pytest.raises(ConnectionClosedError, match="3 are connected already"):
                page.recv(MAX_WAIT)
            assert page.close_code == 1013
        inside[0].do("ping")
        assert "pong" in inside[0].receive(MAX_WAIT)
