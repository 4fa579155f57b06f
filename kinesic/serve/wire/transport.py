"""Byte transports: TCP, and standard input and output, whose messages end with NUL.

The other end of a connection may be slow, but not for ever. Of standard input the last document may end with the
input.
"""

import json
import os
import socket
import sys
from asyncio import Lock, StreamReader, get_running_loop, sleep, timeout, to_thread
from codecs import getincrementaldecoder
from collections import deque
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from contextlib import suppress
from threading import Thread

from kinesic.serve.wire.protocol import END, MessageFramer, json_answer
from kinesic.serve.wire.quotas import Quotas

CHUNK = 65_536  # [bytes] read at once
UNKNOWN = 8192  # [bytes] read of a client before it is admitted
DISCARD = 0.05  # [s] between two chunks that are thrown away
LINGER = 1.0  # [s] in which a client may read what was said last, while what it still says is thrown away


class HalfError(EOFError):
    """The connection ended, or came to a halt, within a message."""


class OverlongError(ValueError):
    """A client has said more than it may."""


class Transport:
    """Bytes to and from a client, each within some time, and read no faster than it may send."""

    def __init__(self, connection: socket.socket, patience: float, await_turn: Callable[[], Awaitable[None]]) -> None:
        """Takes over a connection, of which little is read until it is admitted.

        Args:
            connection: to the client; does not block.
            patience: how long is waited for it [s].
            await_turn: waits until it may be read.
        """
        self._socket, self._patience, self._await_turn = connection, patience, await_turn
        self._loop, self._writing = get_running_loop(), Lock()
        self._left: int | None = UNKNOWN  # [bytes] that are still read; None: any number

    def admit(self) -> None:
        """Lets the client say as much as it likes."""
        self._left = None

    async def read(self, *, hurry: bool) -> bytes:
        """Reads what comes next; nothing at the end.

        Args:
            hurry: whether it must come soon.

        Raises:
            HalfError: it must, and does not.
            OverlongError: the client has said too much before it was admitted.
        """
        if self._left == 0:
            raise OverlongError(f"at most {UNKNOWN} bytes are read of a client that has not shown the token")
        try:
            async with timeout(self._patience if hurry else None):
                await self._await_turn()
                data = await self._loop.sock_recv(self._socket, CHUNK if self._left is None else self._left)
        except TimeoutError:
            raise HalfError(f"nothing came for {self._patience:g} s") from None
        if self._left is not None:
            self._left -= len(data)
        return data

    async def write(self, pieces: Iterable[bytes]) -> None:
        """Sends pieces, of which an empty one says that no other follows.

        Raises:
            TimeoutError: the client does not read.
        """
        async with self._writing, timeout(self._patience):
            for piece in pieces:
                if piece:
                    await self._loop.sock_sendall(self._socket, piece)
                else:
                    self._socket.shutdown(socket.SHUT_WR)

    async def close(self) -> None:
        """Ends the connection: this side at once, the other when the client does, or soon.

        A connection that is closed while something of the client's is unread is reset, and the client may never read
        why it was closed.
        """
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_WR)
            async with timeout(min(LINGER, self._patience)):
                while await self._loop.sock_recv(self._socket, CHUNK):
                    await sleep(DISCARD)
        self._socket.close()


class Stream:
    """Messages over a stream of bytes."""

    lingers = True

    def __init__(self, line: Transport, first: bytes, most: int) -> None:
        """Takes over a connection.

        Args:
            line: to the client.
            first: what has been read already.
            most: how long a message may be [bytes].
        """
        self._line, self._first, self._frames = line, first, MessageFramer(most)
        self._whole = deque[bytes]()  # messages that were read and not taken yet

    def move(self, line: Transport) -> None:
        """Goes on over another transport of the same connection."""
        self._line = line

    async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Messages as they come, until the client ends its side.

        Args:
            hurry: whether the client has to say something soon.

        Raises:
            ValueError: a message is too long.
            HalfError: one has begun and does not end.
        """
        data, self._first = self._first, b""
        while True:
            self._whole.extend(self._frames.feed(data))
            while self._whole:
                yield self._whole.popleft()
            data = await self._line.read(hurry=self._frames.is_midway or hurry())
            if not data:
                break
        if self._frames.is_midway:
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
            await self.send(json_answer("closed", code=code, why=why))
        await self._line.close()


class Console:
    """Messages over standard input and output."""

    lingers = True

    def __init__(self, rules: Quotas) -> None:
        """Begins to read in a thread, since a file or terminal cannot be waited for."""
        self._frames, self._reader = MessageFramer(rules.message), StreamReader()
        self._loop = get_running_loop()
        Thread(target=self._read, name="stdin", daemon=True).start()

    async def messages(self, _hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Messages as they come, until the input ends.

        Raises:
            ValueError: a message is too long.
        """
        while data := await self._reader.read(CHUNK):
            for message in self._frames.feed(data):
                yield message
        for message in self._frames.feed(END):
            yield message

    async def send(self, message: str) -> None:
        """Prints a message; one line each."""
        await to_thread(self._print, message)

    async def close(self, _code: int, _why: str) -> None:
        """Nothing to close."""

    def _print(self, message: str) -> None:
        sys.stdout.write(message + "\n")
        sys.stdout.flush()

    def _read(self) -> None:
        while data := os.read(sys.stdin.fileno(), CHUNK):
            self._loop.call_soon_threadsafe(self._reader.feed_data, data)
        self._loop.call_soon_threadsafe(self._reader.feed_eof)


class WordConsole(Console):
    """Words over standard input, as they come; the last ones with its end."""

    def __init__(self, rules: Quotas, show: Callable[[str], None]) -> None:
        """Begins to read.

        Args:
            rules: how many messages a second it may make of them.
            show: is given what comes back, one message after the other.
        """
        super().__init__(rules)
        self._pause, self._show = 1.0 / rules.rate, show

    async def messages(self, _hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Words as control messages, until the input ends; what comes at once is one message."""
        letters = getincrementaldecoder("utf-8")("replace")
        while data := await self._reader.read(CHUNK):
            yield _words(letters.decode(data))
            await sleep(self._pause)
        yield _words(letters.decode(b"", final=True), ends=True)

    def _print(self, message: str) -> None:
        self._show(message)


def _words(text: str, **more: bool) -> bytes:
    return json.dumps({"do": "words", "text": text} | more).encode()
