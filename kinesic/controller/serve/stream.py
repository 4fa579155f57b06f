"""A client by TCP: messages that end with NUL, both ways."""

from asyncio import StreamReader, StreamWriter, timeout
from collections.abc import AsyncIterator, Callable

from kinesic.controller.serve.rules import Rules
from kinesic.controller.serve.wire import END, Frames, told

CHUNK = 65_536  # [bytes] read at once


class HalfError(EOFError):
    """The connection ended, or came to a halt, within a message."""


class Stream:
    """Messages over a stream of bytes."""

    lingers = True

    def __init__(self, reader: StreamReader, writer: StreamWriter, first: bytes, rules: Rules) -> None:
        """Takes over a connection.

        Args:
            reader: from the client.
            writer: to it.
            first: what has been read already.
            rules: how long messages may be, and may take.
        """
        self._reader, self._writer, self._first = reader, writer, first
        self._frames, self._patience = Frames(rules.message), rules.patience

    async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Messages as they come, until the client ends its side.

        Args:
            hurry: whether the client has to say something soon.

        Raises:
            ValueError: a message is too long.
            HalfError: one has begun and does not end.
        """
        data = self._first
        while data:
            for message in self._frames.fed(data):
                yield message
            try:
                async with timeout(self._patience if self._frames.half or hurry() else None):
                    data = await self._reader.read(CHUNK)
            except TimeoutError:
                raise HalfError(f"nothing came for {self._patience:g} s") from None
        if self._frames.half:
            raise HalfError("the connection ended")

    async def send(self, message: str) -> None:
        """Sends a message.

        Raises:
            TimeoutError: the client does not read.
        """
        self._writer.write(message.encode() + b"\n" + END)
        async with timeout(self._patience):
            await self._writer.drain()

    async def close(self, code: int, why: str) -> None:
        """Says why, and ends the connection."""
        if why:
            await self.send(told("closed", code=code, why=why))
        self._writer.close()
        async with timeout(self._patience):
            await self._writer.wait_closed()
