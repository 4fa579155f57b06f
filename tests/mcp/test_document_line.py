"""Document connection with failing sends."""

import asyncio
from threading import Event

import pytest

from kinesic.mcp.document_line import DocumentLine
from kinesic.mcp.errors import RobotError


class BrokenClient:
    """Stub client that fails to send and stays silent until it is closed."""

    def __init__(self) -> None:
        self.closed = Event()
        self.sent: list[bytes] = []

    def send_bytes(self, message: bytes) -> None:
        self.sent.append(message)
        raise TimeoutError("timed out")

    def receive(self) -> str:
        self.closed.wait(20)
        raise ConnectionError("closed")

    def close(self) -> None:
        self.closed.set()


def test_document_that_cannot_be_sent_closes_the_server_connection():
    client = BrokenClient()

    async def act() -> None:
        line = DocumentLine(lambda: client)
        with pytest.raises(RobotError, match=r"the server is gone \(timed out\): start it again"):
            await line.send(lambda: "first")
        assert client.closed.is_set()
        while line._gone is None:
            await asyncio.sleep(0.01)
        with pytest.raises(RobotError, match="closed"):
            await line.send(lambda: "second")

    asyncio.run(act())
    assert client.sent == [b"first"]
