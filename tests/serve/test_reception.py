"""Connection acceptor without a server."""

import asyncio
import errno
import json
import socket
from types import SimpleNamespace

import pytest

from kinesic.body.config import ConfigError
from kinesic.serve.reception import ACCEPT_RETRY_DELAY, Reception
from kinesic.serve.stop_lines import StopLines
from kinesic.serve.wire.quotas import Quotas

pytestmark = pytest.mark.realtime


def reception() -> Reception:
    """Return an acceptor without clients."""
    return Reception(SimpleNamespace(rules=Quotas()), StopLines(lambda: None, Quotas()))


class Full(socket.socket):
    """Stub listener at the open file limit."""

    asked = 0

    def accept(self):
        self.asked += 1
        raise OSError(errno.EMFILE, "Too many open files")


def test_accepting_connections_resumes_after_the_open_file_limit():
    async def crowded() -> int:
        here, full = reception(), Full()
        full.bind(("127.0.0.1", 0))
        full.listen()
        here._listeners.append(full)
        here.open()
        with socket.create_connection(full.getsockname()):
            await asyncio.sleep(4.5 * ACCEPT_RETRY_DELAY)
        here.close()
        await asyncio.sleep(2 * ACCEPT_RETRY_DELAY)
        return full.asked

    assert 1 <= asyncio.run(crowded()) <= 5


def test_unavailable_address_leaves_no_open_socket():
    async def refused() -> None:
        here = reception()
        with pytest.raises(ConfigError, match=r"--listen 192\.0\.2\.1:0: .*; give another one"):
            here.listen("192.0.2.1", 0)
        assert here._listeners == []

    asyncio.run(refused())


def test_listener_keeps_pending_connections_within_half_of_the_limit_of_open_files(monkeypatch):
    monkeypatch.setattr("kinesic.serve.reception.max_open_files", lambda: 200)
    assert reception()._max_pending == 100


def test_new_connections_replace_the_oldest_silent_ones(server, becomes, monkeypatch):
    assert becomes(lambda: not server.open.clients._clients)
    monkeypatch.setattr(server.open.reception, "_max_pending", 8)
    with server.client() as present:
        present.do("ping")
        present.receive(20)
        silent = [socket.create_connection(("127.0.0.1", server.port), 20) for _ in range(20)]
        try:
            with server.client() as newcomer:
                newcomer.do("ping", id="new")
                assert json.loads(newcomer.receive(20))["id"] == "new"
            assert silent[0].recv(1) == b""
            present.do("ping", id="still")
            assert json.loads(present.receive(20))["id"] == "still"
        finally:
            for item in silent:
                item.close()
