"""The server: clients come by TCP, WebSocket and standard input, and every one is attended to by itself."""

from asyncio import (
    FIRST_COMPLETED,
    CancelledError,
    StreamReader,
    StreamWriter,
    create_task,
    sleep,
    start_server,
    timeout,
    wait,
)
from asyncio import Server as Listener
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from socket import SO_KEEPALIVE, SO_SNDBUF, SOL_SOCKET
from typing import Protocol

from kinesic.body.config import ConfigError
from kinesic.serve.console import Console
from kinesic.serve.desk import Desk
from kinesic.serve.guest import POLICY, TOO_BIG, Guest
from kinesic.serve.line import HalfError, Line
from kinesic.serve.protocol import BLANK, END
from kinesic.serve.quotas import refused
from kinesic.serve.stream import Stream
from kinesic.serve.websocket import WebSocket

REQUEST = b"GET "  # how a WebSocket begins
DOCUMENT = (b"<", b"{", END)  # how a message may begin, after blanks
BUFFER = 65_536  # [bytes] for a client that does not read
DOORWAY = 2  # times as many connections as clients, among them such as have not said anything
LOOK = 0.05  # [s] between two looks at whether a client is owed something


class Wire(Protocol):
    """A way to a client."""

    lingers: bool  # whether a client that says nothing more may still listen

    def messages(self, hurry: Callable[[], bool], /) -> AsyncIterator[bytes]:
        """What it says."""

    async def send(self, message: str, /) -> None:
        """Tells it something."""

    async def close(self, code: int, why: str, /) -> None:
        """Sends it home."""


async def listen(desk: Desk, host: str, port: int) -> Listener:
    """Takes an address for TCP and WebSocket; nobody is attended to before it starts serving.

    Raises:
        ConfigError: the address cannot be had.
    """
    present: set[StreamWriter] = set()

    async def client(reader: StreamReader, writer: StreamWriter) -> None:
        present.add(writer)
        with suppress(OSError, HalfError):  # who leaves may do so in any way
            if len(present) <= DOORWAY * desk.rules.clients:  # those too many are told so, but not without end
                await _welcome(desk, reader, writer)
        present.discard(writer)
        writer.transport.abort()

    try:
        return await start_server(client, host, port, limit=BUFFER, start_serving=False)
    except OSError as error:
        raise ConfigError(f"--listen {host}:{port}: {error.strerror}; give another one, or port 0") from None


async def attend_console(desk: Desk) -> None:
    """Attends to standard input until it ends and everything from it is performed."""
    await _attend(desk, Console(desk.rules), desk.joined("stdin", trusted=True))


async def _welcome(desk: Desk, reader: StreamReader, writer: StreamWriter) -> None:
    """Finds out how a client speaks, and attends to it."""
    socket = writer.get_extra_info("socket")
    socket.setsockopt(SOL_SOCKET, SO_KEEPALIVE, 1)
    socket.setsockopt(SOL_SOCKET, SO_SNDBUF, BUFFER)
    writer.transport.set_write_buffer_limits(high=BUFFER)
    name = ":".join(map(str, writer.get_extra_info("peername")[:2]))
    first = b""
    async with timeout(desk.rules.patience):
        while REQUEST.startswith(first.lstrip(BLANK)) and len(first) < BUFFER:
            data = await reader.read(BUFFER)
            if not data:
                return
            first += data
    line = Line(reader, writer, desk.rules.patience)
    if first.startswith(REQUEST):
        wire = WebSocket(line, first, desk.rules.message)
        await _attend(desk, wire, desk.joined(name, trusted=await wire.opened(desk.is_right, open_house=desk.is_open)))
    elif first.lstrip(BLANK).startswith(DOCUMENT):
        await _attend(desk, Stream(line, first, desk.rules.message), desk.joined(name))


async def _attend(desk: Desk, wire: Wire, guest: Guest) -> None:
    """Hears and answers a client until it goes, or is sent home."""
    hearing, telling = create_task(_hear(desk, wire, guest)), create_task(_tell(wire, guest))
    try:
        await wait((hearing, telling), return_when=FIRST_COMPLETED)
        while wire.lingers and not telling.done() and desk.performer.owes(guest.number):
            await sleep(LOOK)
        guest.outbox.end()
        hearing.cancel()
        await telling
        await wire.close(guest.code, guest.why)
        with suppress(CancelledError):
            await hearing
    finally:
        desk.left(guest)
        for task in (hearing, telling):
            task.cancel()


async def _hear(desk: Desk, wire: Wire, guest: Guest) -> None:
    try:
        messages = wire.messages(lambda: not guest.admitted)
        while guest.open:
            desk.heard(guest, await anext(messages))
    except StopAsyncIteration:
        return
    except ValueError as error:
        desk.overlong(guest, error)
        guest.close(TOO_BIG, str(error))
    except HalfError as error:
        guest.put(refused("half", f"{error} before the message did; it is not performed"))
        guest.close(POLICY, "half a message")


async def _tell(wire: Wire, guest: Guest) -> None:
    while (message := await guest.outbox.take()) is not None:
        await wire.send(message)
