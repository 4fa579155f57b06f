"""Where connections come in, apart from the server."""

import asyncio
import errno
import json
import socket
from types import SimpleNamespace

import pytest

from kinesic.body.config import ConfigError
from kinesic.serve.reception import REST, Reception
from kinesic.serve.stop_lines import StopLines
from kinesic.serve.wire.quotas import Quotas

pytestmark = pytest.mark.realtime


def reception() -> Reception:
    """One whom nobody joins."""
    return Reception(SimpleNamespace(rules=Quotas()), StopLines(lambda: None, Quotas()))


class Full(socket.socket):
    """A listener on a machine that can open no further file."""

    asked = 0

    def accept(self):
        self.asked += 1
        raise OSError(errno.EMFILE, "Too many open files")


def test_where_no_file_can_be_opened_it_is_tried_again_after_a_while():
    async def crowded() -> int:
        here, full = reception(), Full()
        full.bind(("127.0.0.1", 0))
        full.listen()
        here._listeners.append(full)
        here.open()
        with socket.create_connection(full.getsockname()):
            await asyncio.sleep(4.5 * REST)
        here.close()
        await asyncio.sleep(2 * REST)
        return full.asked

    assert 1 <= asyncio.run(crowded()) <= 5


def test_an_address_that_cannot_be_had_leaves_nothing_open():
    async def refused() -> None:
        here = reception()
        with pytest.raises(ConfigError, match=r"--listen 192\.0\.2\.1:0: .*; give another one"):
            here.listen("192.0.2.1", 0)
        assert here._listeners == []

    asyncio.run(refused())


def test_the_door_holds_at_most_half_of_the_files_that_may_be_open(monkeypatch):
    monkeypatch.setattr("kinesic.serve.reception.getrlimit", lambda _: (200, 200))
    assert reception()._room == 100


def test_newcomers_replace_the_oldest_that_say_nothing(server, becomes, monkeypatch):
    assert becomes(lambda: not server.open.clients._clients)
    monkeypatch.setattr(server.open.reception, "_room", 8)
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
            for each in silent:
                each.close()
