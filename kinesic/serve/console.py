"""Standard input and output as a client: documents that end with NUL, the last one with the input."""

import os
import sys
from asyncio import StreamReader, get_running_loop, to_thread
from collections.abc import AsyncIterator, Callable
from threading import Thread

from kinesic.serve.line import CHUNK
from kinesic.serve.protocol import END, Frames
from kinesic.serve.quotas import Rules


class Console:
    """Messages over standard input and output."""

    lingers = True

    def __init__(self, rules: Rules) -> None:
        """Begins to read; a thread does, since a file or terminal cannot be waited for."""
        self._frames, self._reader = Frames(rules.message), StreamReader()
        self._loop = get_running_loop()
        Thread(target=self._read, name="stdin", daemon=True).start()

    async def messages(self, _hurry: Callable[[], bool]) -> AsyncIterator[bytes]:
        """Messages as they come, until the input ends.

        Raises:
            ValueError: a message is too long.
        """
        while data := await self._reader.read(CHUNK):
            for message in self._frames.fed(data):
                yield message
        for message in self._frames.fed(END):
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
