"""Connection acceptor on a real port, with a stub session."""

import asyncio
import json
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import replace

from kinesic.serve.reception import Reception
from kinesic.serve.wire.origin import OPEN_ACCESS, Access
from kinesic.serve.wire.pages import WebFile
from kinesic.serve.wire.quotas import Quotas

from .played_registry import Registry

RULES = Quotas(patience=20.0)
SHORT_QUOTAS = replace(RULES, patience=0.05)  # quotas with a silence timeout [s] that is meant to expire
PATIENCE = 20.0  # [s] longest wait for a condition that a test expects
PING = b'{"do": "ping", "id": "x"}\0'
PONG = {"told": "pong", "id": "x"}


class PlayedStopLines:
    """Stop lines that keep the connections that they take over."""

    def __init__(self) -> None:
        self.taken: list[socket.socket] = []

    def take(self, connection: socket.socket, wire: object) -> None:
        self.taken.append(connection)


class AccessOptions:
    """A reception that listens, with its registry."""

    def __init__(self, access: Access, rules: Quotas, files: dict[str, WebFile]) -> None:
        self.registry = Registry(access, rules)
        self.registry.session.has_unfinished_blocks = lambda _: False
        self.stop_lines = PlayedStopLines()
        self.reception = Reception(self.registry, self.stop_lines, files)
        self.port = self.reception.listen("127.0.0.1", 0)
        self._writers: list[asyncio.StreamWriter] = []

    async def connect(self, first: bytes = b"") -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
        writer.write(first)
        self._writers.append(writer)
        return reader, writer

    async def disconnect(self) -> None:
        """Close all connections of the clients."""
        for writer in self._writers:
            writer.close()
            with suppress(OSError):
                await writer.wait_closed()

    async def ask(self, message: bytes) -> dict:
        """Connect, send a message and return the first answer."""
        reader, writer = await self.connect(message)
        answer = json.loads((await reader.readuntil(b"\0")).strip(b"\n\0"))
        writer.close()
        return answer


@asynccontextmanager
async def opened(
    access: Access = OPEN_ACCESS, rules: Quotas = RULES, files: dict[str, WebFile] | None = None
) -> AsyncIterator[AccessOptions]:
    async with asyncio.timeout(PATIENCE):
        door = AccessOptions(access, rules, files or {})
        door.reception.open()
        try:
            yield door
        finally:
            await door.disconnect()
            door.reception.close()
            await door.reception.end()
