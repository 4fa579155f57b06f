"""Takes in connections: whoever has no place among the clients yet waits at the door.

There newcomers replace the oldest, so that a thousand connections which say nothing, or nothing that is right, keep
nobody out. A connection costs next to nothing until its first byte comes.
"""

import socket
from asyncio import Task, TimerHandle, create_task, get_running_loop, timeout, wait
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from resource import RLIMIT_NOFILE, getrlimit

from kinesic.body.config import ConfigError
from kinesic.serve.clients import ClientRegistry, ConnectedClient
from kinesic.serve.conversation import attend
from kinesic.serve.stop_lines import MovableWire, StopLines
from kinesic.serve.wire.origin import own_authorities
from kinesic.serve.wire.pace import Pace
from kinesic.serve.wire.pages import NO_FILES, WebFile
from kinesic.serve.wire.protocol import BLANK
from kinesic.serve.wire.quotas import Quotas, TokenBucket
from kinesic.serve.wire.transport import UNKNOWN, Console, HalfError, OverlongError, Stream, Transport
from kinesic.serve.wire.websocket import WebSocket

REQUEST = b"GET "  # how a WebSocket begins
DOCUMENT = (b"<", b"{")  # how a client's first message begins, after blanks: no request of a browser does
DOOR = 2048  # connections at the door, or half as many as files may be open
BACKLOG = 4096  # connections that the system keeps until they are taken in
REST = 0.1  # [s] for which nobody is taken in when no file can be opened
AT_ONCE = 32  # connections taken in before others have their turn
BUFFER = 65_536  # [bytes] that the system keeps for a client that does not read
FIRST_READS = 4  # of a connection at once, before it has to wait for its turn; floods open many
READS = 20  # likewise of one that has a place
FAREWELL = 1.5  # [s] in which clients may read what was said last


class Visitor:
    """A connection at the door."""

    def __init__(self, connection: socket.socket, address: str) -> None:
        """Begins silent.

        Args:
            connection: to the client.
            address: of the client.
        """
        self.socket, self.address = connection, address
        self.task: Task[None] | None = None  # that attends to it, once it has said something
        self.watch: TimerHandle | None = None  # that sends it away when it says nothing

    def dismiss(self) -> None:
        """Sends it away."""
        if self.watch is not None:
            self.watch.cancel()
        if self.task is None:
            get_running_loop().remove_reader(self.socket)
            self.socket.close()
        else:
            self.task.cancel()


class Reception:
    """Listens, and attends to whoever comes."""

    def __init__(self, clients: ClientRegistry, stop_lines: StopLines, files: Mapping[str, WebFile] = NO_FILES) -> None:
        """Listens nowhere yet.

        Args:
            clients: whom those join that say something.
            stop_lines: take over whoever only stops.
            files: that browsers may have, by their path.
        """
        self._clients, self._rules, self._stop_lines = clients, clients.rules, stop_lines
        self._files, self._host = files, ""
        self._listeners: list[socket.socket] = []
        self._door: dict[Visitor, None] = {}  # the oldest first
        self._room = min(DOOR, getrlimit(RLIMIT_NOFILE)[0] // 2)
        self._tasks: set[Task[None]] = set()
        self._pace = Pace()

    def listen(self, host: str, port: int) -> int:
        """Takes an address, and tells the port; nobody is taken in yet.

        Args:
            host: name or address.
            port: 0: any that is free.

        Raises:
            ConfigError: the address cannot be had.
        """
        self._host = host
        try:
            found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
            for family, *_, address in dict.fromkeys(found):
                place = (address[0], port)
                listener = socket.create_server(place, family=family, backlog=BACKLOG)
                listener.setblocking(False)
                self._listeners.append(listener)
                port = int(listener.getsockname()[1])
        except OSError as error:
            self.close()
            why = str(error.strerror).partition(" (")[0].lower()
            raise ConfigError(f"--listen {host}:{port}: {why}; give another one, or port 0") from None
        return port

    def open(self) -> None:
        """Takes in connections from now on."""
        for listener in self._listeners:
            self._wait_for(listener)

    def close(self) -> None:
        """Takes in no further connections."""
        for listener in self._listeners:
            get_running_loop().remove_reader(listener)
            listener.close()
        self._listeners.clear()

    async def end(self) -> None:
        """Ends all connections, once clients have had a moment to read what was said last."""
        for visitor in tuple(self._door):
            if visitor.task is None:
                self._dismiss(visitor)
        if self._tasks:
            await wait(self._tasks, timeout=FAREWELL)
        for task in self._tasks:
            task.cancel()
        if self._tasks:
            await wait(self._tasks)

    def _wait_for(self, listener: socket.socket) -> None:
        if listener in self._listeners:  # it may have been closed meanwhile
            get_running_loop().add_reader(listener, self._take_in, listener)

    def _take_in(self, listener: socket.socket) -> None:
        for _ in range(AT_ONCE):
            try:
                connection, address = listener.accept()
            except OSError as error:
                if not isinstance(error, BlockingIOError | ConnectionError):  # too many files are open
                    self._make_room(least=1)
                    get_running_loop().remove_reader(listener)
                    get_running_loop().call_later(REST, self._wait_for, listener)
                return
            self._make_room(least=0)
            self._await_first(connection, ":".join(map(str, address[:2])))

    def _make_room(self, *, least: int) -> None:
        """Sends the oldest at the door away, so many at least, until there is room for another."""
        while self._door and (least > 0 or len(self._door) >= self._room):
            self._dismiss(next(iter(self._door)))
            least -= 1

    def _await_first(self, connection: socket.socket, address: str) -> None:
        connection.setblocking(False)
        visitor, loop = Visitor(connection, address), get_running_loop()
        self._door[visitor] = None
        loop.add_reader(connection, self._begin, visitor)
        visitor.watch = loop.call_later(self._rules.patience, self._dismiss, visitor)

    def _dismiss(self, visitor: Visitor) -> None:
        self._door.pop(visitor, None)
        visitor.dismiss()

    def _begin(self, visitor: Visitor) -> None:
        """Attends to a connection, now that it says something."""
        if visitor.watch is not None:
            visitor.watch.cancel()
        get_running_loop().remove_reader(visitor.socket)
        visitor.task = task = create_task(self._attend(visitor))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _attend(self, visitor: Visitor) -> None:
        try:
            with suppress(OSError, HalfError, OverlongError):  # a client may leave in any way
                await self._welcome(visitor)
        finally:
            self._door.pop(visitor, None)
            visitor.socket.close()

    async def _welcome(self, visitor: Visitor) -> None:
        visitor.socket.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        visitor.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER)
        visitor.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        reads = TokenBucket(self._rules.rate, FIRST_READS)
        line = Transport(visitor.socket, self._rules.patience, partial(self._pace.await_turn, reads))
        wire: MovableWire
        async with timeout(self._rules.patience):
            first = await _read_first(line)
            if first.startswith(REQUEST):
                wire = web = WebSocket(line, first, self._rules)
                authorities = own_authorities(self._host, *visitor.socket.getsockname()[:2])
                shown = await web.open(self._clients.access, self._clients.is_token, authorities, self._files)
                client = self._clients.join(visitor.address, trusted=shown)
                self._clients.place(client)
            elif first.lstrip(BLANK).startswith(DOCUMENT):
                wire = Stream(line, first, self._rules.message)
                client = self._clients.join(visitor.address)
            else:
                await line.close()
                return
        notice = partial(self._notice, visitor, line, reads, client)
        notice()
        await attend(self._clients, wire, client, notice=notice)
        if client.stops_only:
            self._stop_lines.take(socket.socket(fileno=visitor.socket.detach()), wire)

    def _notice(self, visitor: Visitor, line: Transport, reads: TokenBucket, client: ConnectedClient) -> None:
        """Lets a client in from the door as soon as it may: it may say more, and newcomers do not replace it."""
        if client.admitted:
            line.admit()
        if client.placed:
            self._door.pop(visitor, None)
            reads.widen(READS)


async def attend_console(clients: ClientRegistry, make_console: Callable[[Quotas], Console] = Console) -> None:
    """Attends to standard input until it ends and everything from it is performed."""
    client = clients.join("stdin", trusted=True, movable=False)
    clients.place(client)
    await attend(clients, make_console(clients.rules), client)


async def _read_first(line: Transport) -> bytes:
    """Reads until it shows what a connection is to be."""
    first = b""
    while REQUEST.startswith(first.lstrip(BLANK)) and len(first) < UNKNOWN:
        data = await line.read(hurry=True)
        if not data:
            break
        first += data
    return first
