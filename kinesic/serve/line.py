"""A connection whose other end may be slow, but not for ever."""

from asyncio import StreamReader, StreamWriter, timeout
from collections.abc import Iterable
from contextlib import suppress

CHUNK = 65_536  # [bytes] read at once
LINGER = 1.0  # [s] in which a client may read what was said last, while what it still says is thrown away


class HalfError(EOFError):
    """The connection ended, or came to a halt, within a message."""


class Line:
    """Bytes to and from a client, with patience."""

    def __init__(self, reader: StreamReader, writer: StreamWriter, patience: float) -> None:
        """Takes over a connection.

        Args:
            reader: from the client.
            writer: to it.
            patience: how long is waited for it [s].
        """
        self._reader, self._writer, self._patience = reader, writer, patience

    async def read(self, *, hurry: bool) -> bytes:
        """What comes next; nothing at the end.

        Args:
            hurry: whether it must come soon.

        Raises:
            HalfError: it must, and does not.
        """
        try:
            async with timeout(self._patience if hurry else None):
                return await self._reader.read(CHUNK)
        except TimeoutError:
            raise HalfError(f"nothing came for {self._patience:g} s") from None

    async def write(self, pieces: Iterable[bytes]) -> None:
        """Sends pieces, of which an empty one says that no other follows.

        Raises:
            TimeoutError: the client does not read.
        """
        for piece in pieces:
            if piece:
                self._writer.write(piece)
            elif self._writer.can_write_eof():
                self._writer.write_eof()
        async with timeout(self._patience):
            await self._writer.drain()

    async def close(self) -> None:
        """Ends the connection: this side at once, the other when the client does, or soon.

        A connection that is closed while something of the client's is unread is reset, and the client may never read
        why it was sent home.

        Raises:
            TimeoutError: the client does not read what is still to be sent.
        """
        if self._writer.can_write_eof():
            self._writer.write_eof()
        with suppress(TimeoutError):
            async with timeout(min(LINGER, self._patience)):
                while await self._reader.read(CHUNK):
                    pass
        self._writer.close()
        async with timeout(self._patience):
            await self._writer.wait_closed()
