"""The server: clients come by TCP, WebSocket and standard input, and each is attended to by itself.

It opens, waits until its end is requested, and folds the robot to rest.
"""

from asyncio import (
    FIRST_COMPLETED,
    Event,
    StreamReader,
    StreamWriter,
    Task,
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
from kinesic.serve.origin import ANYBODY_HERE, Access, own_authorities
from kinesic.serve.protocol import BLANK
from kinesic.serve.quotas import USUAL, Quotas, quota_feedback
from kinesic.serve.session import Session
from kinesic.serve.sinks import RealTimeSink
from kinesic.serve.tracks import SILENT, SoundAndFace
from kinesic.serve.transport import Console, HalfError, Stream, Transport
from kinesic.serve.websocket import WebSocket

REQUEST = b"GET "  # how a WebSocket begins
DOCUMENT = (b"<", b"{")  # how a client's first message begins, after blanks: no request of a browser does
BUFFER = 65_536  # [bytes] for a client that does not read
DOORWAY = 2  # times as many connections as clients, among them such as have not said anything
LOOK_AT_CLIENT = 0.05  # [s] between two looks at whether a client is owed something
AWAY = 1001  # WebSocket's code of a server that ends
FOLDING = 30.0  # [s] that ending everything and coming to rest may take
FAREWELL = 1.5  # [s] in which clients may read what the server says last
LOOK_AT_LOOP = 0.1  # [s] between two looks at whether the loop still runs


class ClientWire(Protocol):
    """A connection to a client, by any transport."""

    lingers: bool  # whether a client that says nothing more may still listen

    def messages(self, hurry: Callable[[], bool], /) -> AsyncIterator[bytes]:
        """Messages of the client as they come."""

    async def send(self, message: str, /) -> None:
        """Sends the client a message."""

    async def close(self, code: int, why: str, /) -> None:
        """Closes the connection, and says why."""


class Reception:
    """Connections as they come, each attended to by a task of its own until it has ended."""

    def __init__(self, clients: ClientRegistry, host: str) -> None:
        """Begins with none.

        Args:
            clients: where they are registered.
            host: that the server was told to listen at.
        """
        self._clients, self._host = clients, host
        self._attending: set[Task[None]] = set()

    @property
    def count(self) -> int:
        """How many are attended to."""
        return len(self._attending)

    def take(self, reader: StreamReader, writer: StreamWriter) -> None:
        """Attends to a connection; one too many is closed at once, so that those are told so, but not without end."""
        if self.count >= DOORWAY * self._clients.rules.clients:
            writer.transport.abort()
            return
        task = create_task(self._attend(reader, writer))
        self._attending.add(task)
        task.add_done_callback(self._attending.discard)

    async def dismiss(self) -> None:
        """Gives everybody some time to read what was said last, and then ends what is left."""
        if self._attending:
            await wait(self._attending, timeout=FAREWELL)
        for task in self._attending:
            task.cancel()
        if self._attending:
            await wait(self._attending)

    async def _attend(self, reader: StreamReader, writer: StreamWriter) -> None:
        try:
            with suppress(OSError, HalfError):  # a client may leave in any way
                await _welcome(self._clients, self._host, reader, writer)
        finally:
            writer.transport.abort()


async def open_listener(reception: Reception, address: "Address") -> Listener:
    """Takes an address for TCP and WebSocket; no client is attended to before it starts serving.

    Raises:
        ConfigError: the address cannot be had.
    """
    try:
        return await start_server(reception.take, address.host, address.port, limit=BUFFER, start_serving=False)
    except OSError as error:
        raise ConfigError(f"--listen {address}: {error.strerror}; give another one, or port 0") from None


async def attend_console(clients: ClientRegistry) -> None:
    """Attends to standard input until it ends and everything from it is performed."""
    await _attend(clients, Console(clients.rules), clients.join("stdin", trusted=True))


async def _welcome(clients: ClientRegistry, host: str, reader: StreamReader, writer: StreamWriter) -> None:
    socket = writer.get_extra_info("socket")
    socket.setsockopt(SOL_SOCKET, SO_KEEPALIVE, 1)
    socket.setsockopt(SOL_SOCKET, SO_SNDBUF, BUFFER)
    writer.transport.set_write_buffer_limits(high=BUFFER)
    name = ":".join(map(str, writer.get_extra_info("peername")[:2]))
    first = b""
    async with timeout(clients.rules.patience):
        while REQUEST.startswith(first.lstrip(BLANK)) and len(first) < BUFFER:
            data = await reader.read(BUFFER)
            if not data:
                return
            first += data
    line = Transport(reader, writer, clients.rules.patience)
    if first.startswith(REQUEST):
        wire = WebSocket(line, first, clients.rules.message)
        authorities = own_authorities(host, *writer.get_extra_info("sockname")[:2])
        trusted = await wire.open(clients.access, clients.is_token, authorities)
        await _attend(clients, wire, clients.join(name, trusted=trusted))
    elif first.lstrip(BLANK).startswith(DOCUMENT):
        await _attend(clients, Stream(line, first, clients.rules.message), clients.join(name))


async def _attend(clients: ClientRegistry, wire: ClientWire, client: ConnectedClient) -> None:
    """Receives from a client and sends to it until it goes, or is closed."""
    receiving, sending = create_task(_receive(clients, wire, client)), create_task(_send(wire, client))
    try:
        await wait((receiving, sending), return_when=FIRST_COMPLETED)
        while wire.lingers and not sending.done() and clients.session.owes(client.number):
            await sleep(LOOK_AT_CLIENT)
        client.output.end()
        receiving.cancel()
        await wait((receiving,))  # closing reads too, and only one may
        await sending
        await wire.close(client.code, client.why)
        if not receiving.cancelled():
            receiving.result()
    finally:
        clients.leave(client)
        for task in (receiving, sending):
            task.cancel()
        await wait((receiving, sending))


async def _receive(clients: ClientRegistry, wire: ClientWire, client: ConnectedClient) -> None:
    try:
        messages = wire.messages(lambda: not client.admitted)
        while client.open:
            clients.receive(client, await anext(messages))
    except StopAsyncIteration:
        return
    except ValueError as error:
        clients.refuse_overlong(client, error)
        client.close(TOO_BIG, str(error))
    except HalfError as error:
        client.send(quota_feedback("half", f"{error} before the message did; it is not performed"))
        client.close(POLICY, "half a message")


async def _send(wire: ClientWire, client: ConnectedClient) -> None:
    while (message := await client.output.take()) is not None:
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
    """An open server: its clients and its address."""

    clients: ClientRegistry
    address: Address | None  # None: only standard input


@asynccontextmanager
async def open_serving(
    make_setup: Callable[[], Setup],
    sinks: Sequence[RealTimeSink],
    *,
    address: Address | None,
    rules: Quotas = USUAL,
    access: Access = ANYBODY_HERE,
    accompaniment: SoundAndFace = SILENT,
) -> AsyncIterator[Serving]:
    """Opens a server once its planner is warm, and folds the robot to rest at the end.

    Args:
        make_setup: makes what planning needs; picklable, because another process calls it too.
        sinks: sinks, closed at the end.
        address: to listen at; None: nowhere.
        rules: what clients may do.
        access: who may connect.
        accompaniment: whether one of the sinks shows the face, and whether speech is heard.

    Raises:
        ConfigError: the address cannot be had.
    """
    clients = ClientRegistry(
        rules, access, lambda own: Session(make_setup, sinks, rules, own.tell, accompaniment=accompaniment)
    )
    listener, reception = None, Reception(clients, "" if address is None else address.host)
    try:
        if address is not None:
            listener = await open_listener(reception, address)
            address = Address(address.host, listener.sockets[0].getsockname()[1])
        await clients.session.start()
        if listener is not None:
            await listener.start_serving()
        yield Serving(clients, address)
        if listener is not None:
            listener.close()
        with suppress(TimeoutError):
            async with timeout(FOLDING):
                await clients.session.fold()
    finally:
        if listener is not None:
            listener.close()
        clients.close(AWAY, "the server ends")
        await reception.dismiss()
        clients.session.close()


async def until_done(open_: Serving, enough: Event, *, console: bool) -> None:
    """Waits until the end is requested, the loop has failed, or nothing can come any more.

    Args:
        open_: the server.
        enough: set by whoever requests the end.
        console: whether standard input is read.
    """
    tasks = {create_task(enough.wait()), create_task(_failed(open_.clients.session))}
    reading = create_task(attend_console(open_.clients)) if console else None
    if reading is not None and open_.address is None:
        tasks.add(reading)
    await wait(tasks, return_when=FIRST_COMPLETED)
    ending = (*tasks, *((reading,) if reading else ()))
    for task in ending:
        task.cancel()
    await wait(ending)


async def _failed(session: Session) -> None:
    while session.loop.is_alive():
        await sleep(LOOK_AT_LOOP)
