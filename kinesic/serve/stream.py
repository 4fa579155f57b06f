"""A client by TCP: messages that end with NUL, both ways."""

from collections.abc import AsyncIterator, Callable

from kinesic.serve.line import HalfError, Line
from kinesic.serve.protocol import END, Frames, told


class Stream:
    """Messages over a stream of bytes."""

    lingers = True

    def __init__(self, line: Line, first: bytes, most: int) -> None:
        """Takes over a connection.

        Args:
            line: to the client.
            first: what has been read already.
            most: how long a message may be [bytes].
        """
        self._line, self._first, self._frames = line, first, Frames(most)

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
            data = await self._line.read(hurry=self._frames.half or hurry())
        if self._frames.half:
            raise HalfError("the connection ended")

    async def send(self, message: str) -> None:
        """Sends a message.

        Raises:
            TimeoutError: the client does not read.
        """
        await self._line.write([message.encode() + b"\n" + END])

    async def close(self, code: int, why: str) -> None:
        """Says why, and ends the connection."""
        if why:
            await self.send(told("closed", code=code, why=why))
        await self._line.close()
