"""Byte transports over TCP and over standard input and output.

Messages end with NUL. Reads and writes have time limits, so that a slow client cannot block for ever. On standard
input, the end of the input also ends the last document.
"""

import json
import os
import socket
import sys
from asyncio import Future, Lock, StreamReader, get_running_loop, sleep, timeout
from codecs import getincrementaldecoder
from collections import deque
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from contextlib import suppress
from queue import SimpleQueue
from threading import Thread

from kinesic.serve.wire.protocol import MESSAGE_END, MessageFramer, json_answer
from kinesic.serve.wire.quotas import Quotas

CHUNK_SIZE = 65_536  # [bytes] largest read from a connection
UNADMITTED_READ_LIMIT = 8192  # [bytes] total data that a client may send before it is admitted
DISCARD_PERIOD = 0.05  # [s] time between two discarded chunks of data
LINGER_TIMEOUT = 1.0  # [s] time for a client to read the last messages, while its own data is discarded


class HalfError(EOFError):
    """Connection loss or timeout before a message was complete."""


class OverlongError(ValueError):
    """Excess data from a client that is not admitted yet."""


class Transport:
    """Byte connection to a client with time and rate limits."""

    def __init__(self, connection: socket.socket, patience: float, await_turn: Callable[[], Awaitable[None]]) -> None:
        """Wrap an open byte connection to a client.

        Reads are limited until the client is admitted.

        Args:
            connection: non-blocking socket of the client.
            patience: timeout of reads and writes [s].
            await_turn: waits until the connection may be read.
        """
        self._socket, self._patience, self._await_turn = connection, patience, await_turn
        self._loop, self._writing = get_running_loop(), Lock()
        self._left: int | None = UNADMITTED_READ_LIMIT  # [bytes] that may still be read; None: no limit

    def admit(self) -> None:
        """Remove the limit on received bytes once the client is admitted."""
        self._left = None

    async def read(self, *, hurry: bool) -> bytes:
        """Read the next bytes, empty once the client has ended sending.

        Args:
            hurry: whether the time limit applies.

        Raises:
            HalfError: no data arrived within the time limit.
            OverlongError: the client exceeded the read limit before it was admitted.
        """
        if self._left == 0:
            raise OverlongError(f"at most {UNADMITTED_READ_LIMIT} bytes are read from a client without the token")
        try:
            async with timeout(self._patience if hurry else None):
                await self._await_turn()
                data = await self._loop.sock_recv(self._socket, CHUNK_SIZE if self._left is None else self._left)
        except TimeoutError:
            raise HalfError(f"no data arrived for {self._patience:g} s") from None
        if self._left is not None:
            self._left -= len(data)
        return data

    async def write(self, pieces: Iterable[bytes]) -> None:
        """Send byte strings, and end the sending side after an empty one.

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
        """End the connection after unread data of the client is discarded.

        Sending ends at once, receiving when the client ends it or after a short time. A connection that is closed with
        unread data is reset, and the client might never read the reason.
        """
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_WR)
            async with timeout(min(LINGER_TIMEOUT, self._patience)):
                while await self._loop.sock_recv(self._socket, CHUNK_SIZE):
                    await sleep(DISCARD_PERIOD)
        self._socket.close()


class Stream:
    """Message connection over a byte stream."""

    lingers = True

    def __init__(self, line: Transport, first: bytes, max_size: int) -> None:
        """Wrap an open byte transport to a client.

        Args:
            line: transport to the client.
            first: bytes that were read already.
            max_size: maximum message size [bytes].
        """
        self._line, self._first, self._frames = line, first, MessageFramer(max_size)
        self._complete_messages = deque[bytes]()  # complete messages that were not yielded yet

    def move(self, line: Transport) -> None:
        """Continue over another transport of the same connection."""
        self._line = line

    async def messages(self, hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Yield messages until the client stops sending.

        Args:
            hurry: returns whether the next message has a time limit.

        Raises:
            ValueError: a message exceeds the size limit.
            HalfError: the connection ended or stalled within a message.
        """
        data, self._first = self._first, b""
        while True:
            self._complete_messages.extend(self._frames.feed(data))
            while self._complete_messages:
                yield self._complete_messages.popleft()
            data = await self._line.read(hurry=self._frames.is_midway or hurry())
            if not data:
                break
        if self._frames.is_midway:
            raise HalfError("the connection ended")

    async def send(self, message: str) -> None:
        """Send a message.

        Raises:
            TimeoutError: the client does not read.
        """
        await self._line.write([message.encode() + b"\n" + MESSAGE_END])

    async def close(self, code: int, why: str) -> None:
        """Send the reason and end the connection."""
        if why:
            await self.send(json_answer("closed", code=code, why=why))
        await self._line.close()


class Console:
    """Message connection over standard input and output."""

    lingers = True

    def __init__(self, rules: Quotas) -> None:
        """Start daemon threads that read and print.

        Files and terminals cannot be awaited.
        """
        self._frames, self._reader = MessageFramer(rules.message), StreamReader()
        self._unprinted = SimpleQueue[tuple[str, Future[None]]]()
        self._loop = get_running_loop()
        Thread(target=self._read, name="stdin", daemon=True).start()
        Thread(target=self._print_all, name="stdout", daemon=True).start()

    async def messages(self, _hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Yield messages until the input ends.

        Raises:
            ValueError: a message exceeds the size limit.
        """
        while data := await self._reader.read(CHUNK_SIZE):
            for message in self._frames.feed(data):
                yield message
        for message in self._frames.feed(MESSAGE_END):
            yield message

    async def send(self, message: str) -> None:
        """Print a message on one line.

        Raises:
            OSError: standard output is closed.
        """
        printed = self._loop.create_future()
        self._unprinted.put((message, printed))
        await printed

    async def close(self, _code: int, _why: str) -> None:
        """Do nothing.

        Standard output stays open.
        """

    def _print_all(self) -> None:
        """Print queued messages as long as the process runs.

        A server whose output nobody reads ends without this thread.
        """
        with suppress(RuntimeError):  # raised by a closed event loop
            while True:
                message, printed = self._unprinted.get()
                try:
                    self._print(message)
                except OSError as error:
                    self._loop.call_soon_threadsafe(_report_failure, printed, error)
                else:
                    self._loop.call_soon_threadsafe(_report_success, printed)

    def _print(self, message: str) -> None:
        """Write a message without the lock of `sys.stdout`.

        The end of the program needs that lock.
        """
        output, line = sys.stdout.fileno(), memoryview(f"{message}\n".encode(errors="replace"))
        while line:
            line = line[os.write(output, line) :]

    def _read(self) -> None:
        """Pass standard input to the event loop until either ends."""
        with suppress(RuntimeError):  # raised by a closed event loop: the server has ended before its input
            while data := os.read(sys.stdin.fileno(), CHUNK_SIZE):
                self._loop.call_soon_threadsafe(self._reader.feed_data, data)
            self._loop.call_soon_threadsafe(self._reader.feed_eof)


class WordConsole(Console):
    """Console that sends its input as streamed text."""

    def __init__(self, rules: Quotas, show: Callable[[str], None]) -> None:
        """Start reading standard input.

        Args:
            rules: limits with the maximum message rate.
            show: called with each answer of the server.
        """
        super().__init__(rules)
        self._pause, self._show = 1.0 / rules.rate, show

    async def messages(self, _hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Yield the input as control messages until it ends.

        Text that arrives at once becomes one message.
        """
        decoder = getincrementaldecoder("utf-8")("replace")
        while data := await self._reader.read(CHUNK_SIZE):
            yield _words_message(decoder.decode(data))
            await sleep(self._pause)
        yield _words_message(decoder.decode(b"", final=True), ends=True)

    def _print(self, message: str) -> None:
        self._show(message)


def _report_success(printed: "Future[None]") -> None:
    if not printed.cancelled():
        printed.set_result(None)


def _report_failure(printed: "Future[None]", error: OSError) -> None:
    if not printed.cancelled():
        printed.set_exception(error)


def _words_message(text: str, **flags: bool) -> bytes:
    return json.dumps({"do": "words", "text": text} | flags).encode()
