"""The server: clients come by TCP, WebSocket and standard input, and every one is attended to by itself.

As a whole it opens, waits until somebody wants it to end, and folds the robot to rest.
"""

from asyncio import (
    FIRST_COMPLETED,
    CancelledError,
    Event,
    StreamReader,
    StreamWriter,
    create_task,
    sleep,
    start_server,
    timeout,
    wait,
)
from asyncio import Server as Listener
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from socket import SO_KEEPALIVE, SO_SNDBUF, SOL_SOCKET
from typing import Protocol

from kinesic.body.config import ConfigError
from kinesic.planning.setup import Setup
from kinesic.serve.clients import POLICY, TOO_BIG, ClientRegistry, ConnectedClient
from kinesic.serve.protocol import BLANK, END
from kinesic.serve.quotas import USUAL, Quotas, quota_feedback
from kinesic.serve.session import Session
from kinesic.serve.sinks import ServoSink
from kinesic.serve.transport import Console, HalfError, Stream, Transport
from kinesic.serve.websocket import WebSocket

REQUEST = b"GET "  # how a WebSocket begins
DOCUMENT = (b"<", b"{", END)  # how a message may begin, after blanks
BUFFER = 65_536  # [bytes] for a client that does not read
DOORWAY = 2  # times as many connections as clients, among them such as have not said anything
LOOK_AT_CLIENT = 0.05  # [s] between two looks at whether a client is owed something
AWAY = 1001  # WebSocket's code of a server that ends
FOLDING = 30.0  # [s] that ending everything and coming to rest may take
LOOK_AT_LOOP = 0.1  # [s] between two looks at whether the loop still runs


class ClientWire(Protocol):
    """A way to a client."""

    lingers: bool  # whether a client that says nothing more may still listen

    def messages(self, hurry: Callable[[], bool], /) -> AsyncIterator[bytes]:
        """What it says."""

    async def send(self, message: str, /) -> None:
        """Tells it something."""

    async def close(self, code: int, why: str, /) -> None:
        """Sends it home."""


async def open_listener(desk: ClientRegistry, host: str, port: int) -> Listener:
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


async def attend_console(desk: ClientRegistry) -> None:
    """Attends to standard input until it ends and everything from it is performed."""
    await _attend(desk, Console(desk.rules), desk.joined("stdin", trusted=True))


async def _welcome(desk: ClientRegistry, reader: StreamReader, writer: StreamWriter) -> None:
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
    line = Transport(reader, writer, desk.rules.patience)
    if first.startswith(REQUEST):
        wire = WebSocket(line, first, desk.rules.message)
        await _attend(desk, wire, desk.joined(name, trusted=await wire.opened(desk.is_right, open_house=desk.is_open)))
    elif first.lstrip(BLANK).startswith(DOCUMENT):
        await _attend(desk, Stream(line, first, desk.rules.message), desk.joined(name))


async def _attend(desk: ClientRegistry, wire: ClientWire, guest: ConnectedClient) -> None:
    """Hears and answers a client until it goes, or is sent home."""
    hearing, telling = create_task(_hear(desk, wire, guest)), create_task(_tell(wire, guest))
    try:
        await wait((hearing, telling), return_when=FIRST_COMPLETED)
        while wire.lingers and not telling.done() and desk.performer.owes(guest.number):
            await sleep(LOOK_AT_CLIENT)
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


async def _hear(desk: ClientRegistry, wire: ClientWire, guest: ConnectedClient) -> None:
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
        guest.put(quota_feedback("half", f"{error} before the message did; it is not performed"))
        guest.close(POLICY, "half a message")


async def _tell(wire: ClientWire, guest: ConnectedClient) -> None:
    while (message := await guest.outbox.take()) is not None:
        await wire.send(message)


@dataclass(frozen=True)
class Address:
    """Where a server listens."""

    host: str
    port: int  # 0: any that is free

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


@dataclass(frozen=True, eq=False)
class Serving:
    """An open server."""

    desk: ClientRegistry
    address: Address | None  # None: only standard input


@asynccontextmanager
async def open_serving(
    make_setup: Callable[[], Setup],
    followers: Sequence[ServoSink],
    *,
    address: Address | None,
    rules: Quotas = USUAL,
    token: str | None = None,
    face: bool = False,
    sound: bool = False,
) -> AsyncIterator[Serving]:
    """Opens a server once its planner is warm, and folds the robot to rest at the end.

    Args:
        make_setup: makes what planning needs; picklable, because another process calls it too.
        followers: sinks, closed at the end.
        address: to listen at; None: nowhere.
        rules: what clients may do.
        token: that clients must show.
        face: one of the sinks shows it.
        sound: speech is heard.

    Raises:
        ConfigError: the address cannot be had.
    """
    desk = ClientRegistry(
        rules, token, lambda own: Session(make_setup, followers, rules, own.tell, face=face, sound=sound)
    )
    listener = None
    try:
        if address is not None:
            listener = await open_listener(desk, address.host, address.port)
            address = Address(address.host, listener.sockets[0].getsockname()[1])
        await desk.performer.start()
        if listener is not None:
            await listener.start_serving()
        yield Serving(desk, address)
        if listener is not None:
            listener.close()
        with suppress(TimeoutError):
            async with timeout(FOLDING):
                await desk.performer.fold()
    finally:
        if listener is not None:
            listener.close()
        desk.close(AWAY, "the server ends")
        await sleep(LOOK_AT_LOOP)  # for what is still to be read
        desk.performer.close()


async def until_done(open_: Serving, wanted: Event, *, console: bool) -> None:
    """Waits until somebody wants the end, the loop has failed, or nothing can come any more.

    Args:
        open_: the server.
        wanted: set by whoever wants the end.
        console: whether standard input is read.
    """
    tasks = {create_task(wanted.wait()), create_task(_failed(open_.desk.performer))}
    reading = create_task(attend_console(open_.desk)) if console else None
    if reading is not None and open_.address is None:
        tasks.add(reading)
    await wait(tasks, return_when=FIRST_COMPLETED)
    for task in (*tasks, *((reading,) if reading else ())):
        task.cancel()


async def _failed(performer: Session) -> None:
    while performer.loop.is_alive():
        await sleep(LOOK_AT_LOOP)
