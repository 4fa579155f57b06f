"""Connection acceptor of the server.

New connections stay pending until the client has one of the limited client slots. When too many are pending, new ones
replace the oldest, so that silent or invalid connections cannot block other clients. A connection costs almost nothing
before its first byte.
"""

import socket
from asyncio import Task, TimerHandle, create_task, get_running_loop, timeout, wait
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial

from kinesic.body.config import ConfigError
from kinesic.host import max_open_files
from kinesic.serve.clients import ClientRegistry, ConnectedClient
from kinesic.serve.conversation import serve_client
from kinesic.serve.stop_lines import MovableWire, StopLines
from kinesic.serve.wire.origin import own_authorities
from kinesic.serve.wire.pace import ReadPace
from kinesic.serve.wire.pages import NO_FILES, WebFile
from kinesic.serve.wire.protocol import BLANK_BYTES
from kinesic.serve.wire.quotas import Quotas, TokenBucket
from kinesic.serve.wire.transport import UNADMITTED_READ_LIMIT, Console, HalfError, OverlongError, Stream, Transport
from kinesic.serve.wire.websocket import WebSocket

HTTP_REQUEST_PREFIX = b"GET "  # beginning of a WebSocket request
MESSAGE_PREFIXES = (b"<", b"{")  # beginnings of first messages, after blanks; no browser request has them
MAX_PENDING_CONNECTIONS = 2048  # largest number of pending connections, at most half of the open file limit
LISTEN_BACKLOG = 4096  # largest number of connections that the operating system queues
ACCEPT_RETRY_DELAY = 0.1  # [s] pause of accepting after the open file limit was reached
ACCEPTS_PER_TURN = 32  # connections accepted in succession before other tasks run
SEND_BUFFER_SIZE = 65_536  # [bytes] size of a client's socket send buffer: limits the data that it leaves unread
INITIAL_READ_BURST = 4  # reads of a new connection before it waits for others; small, because a flood opens many
ADMITTED_READ_BURST = 20  # reads of a client with a slot before it waits for other connections
CLOSING_TIMEOUT = 1.5  # [s] time for clients to read the last messages


class PendingConnection:
    """Connection that has no reserved client slot yet."""

    def __init__(self, connection: socket.socket, address: str) -> None:
        """Create a pending connection that has sent nothing yet.

        Args:
            connection: socket of the client.
            address: network address of the client.
        """
        self.socket, self.address = connection, address
        self.task: Task[None] | None = None  # serves the connection after its first byte
        self.watch: TimerHandle | None = None  # closes the connection if it stays silent

    def dismiss(self) -> None:
        """Close the connection, or cancel the task that serves it."""
        if self.watch is not None:
            self.watch.cancel()
        if self.task is None:
            get_running_loop().remove_reader(self.socket)
            self.socket.close()
        else:
            self.task.cancel()


class Reception:
    """Listener that accepts and serves connections."""

    def __init__(self, clients: ClientRegistry, stop_lines: StopLines, files: Mapping[str, WebFile] = NO_FILES) -> None:
        """Create an acceptor that does not listen yet.

        Args:
            clients: registry of clients.
            stop_lines: takes over connections that only stop the robot.
            files: files for browsers, by path.
        """
        self._clients, self._rules, self._stop_lines = clients, clients.rules, stop_lines
        self._files, self._host = files, ""
        self._listeners: list[socket.socket] = []
        self._pending: dict[PendingConnection, None] = {}  # oldest first
        self._max_pending = min(MAX_PENDING_CONNECTIONS, max_open_files() // 2)
        self._tasks: set[Task[None]] = set()
        self._pace = ReadPace()

    def listen(self, host: str, port: int) -> int:
        """Bind to an address and return the port.

        Connections are accepted later.

        Args:
            host: host name or address.
            port: port number; 0 selects any free port.

        Raises:
            ConfigError: the address is not available.
        """
        self._host = host
        try:
            candidates = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
            for family, *_, address in dict.fromkeys(candidates):
                bind_address = (address[0], port)
                listener = socket.create_server(bind_address, family=family, backlog=LISTEN_BACKLOG)
                listener.setblocking(False)
                self._listeners.append(listener)
                port = int(listener.getsockname()[1])
        except OSError as error:
            self.close()
            why = str(error.strerror).partition(" (")[0].lower()
            raise ConfigError(f"--listen {host}:{port}: {why}; give another one, or port 0") from None
        return port

    def open(self) -> None:
        """Start accepting connections."""
        for listener in self._listeners:
            self._wait_for(listener)

    def close(self) -> None:
        """Stop accepting connections."""
        for listener in self._listeners:
            get_running_loop().remove_reader(listener)
            listener.close()
        self._listeners.clear()

    async def end(self) -> None:
        """Give clients `CLOSING_TIMEOUT` to read last messages, then end all connections."""
        for pending in tuple(self._pending):
            if pending.task is None:
                self._dismiss(pending)
        if self._tasks:
            await wait(self._tasks, timeout=CLOSING_TIMEOUT)
        for task in self._tasks:
            task.cancel()
        if self._tasks:
            await wait(self._tasks)

    def _wait_for(self, listener: socket.socket) -> None:
        if listener in self._listeners:  # unless it was closed in the pause
            get_running_loop().add_reader(listener, self._accept, listener)

    def _accept(self, listener: socket.socket) -> None:
        for _ in range(ACCEPTS_PER_TURN):
            try:
                connection, address = listener.accept()
            except OSError as error:
                if not isinstance(error, BlockingIOError | ConnectionError):  # open file limit
                    self._drop_pending(min_count=1)
                    get_running_loop().remove_reader(listener)
                    get_running_loop().call_later(ACCEPT_RETRY_DELAY, self._wait_for, listener)
                return
            self._drop_pending(min_count=0)
            self._await_first(connection, ":".join(map(str, address[:2])))

    def _drop_pending(self, *, min_count: int) -> None:
        """Close at least `min_count` of the oldest pending connections.

        Afterwards, fewer than the limit are pending.
        """
        while self._pending and (min_count > 0 or len(self._pending) >= self._max_pending):
            self._dismiss(next(iter(self._pending)))
            min_count -= 1

    def _await_first(self, connection: socket.socket, address: str) -> None:
        connection.setblocking(False)
        pending, loop = PendingConnection(connection, address), get_running_loop()
        self._pending[pending] = None
        loop.add_reader(connection, self._begin, pending)
        pending.watch = loop.call_later(self._rules.patience, self._dismiss, pending)

    def _dismiss(self, pending: PendingConnection) -> None:
        self._pending.pop(pending, None)
        pending.dismiss()

    def _begin(self, pending: PendingConnection) -> None:
        """Start to serve a connection after its first byte."""
        if pending.watch is not None:
            pending.watch.cancel()
        get_running_loop().remove_reader(pending.socket)
        pending.task = task = create_task(self._serve_connection(pending))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _serve_connection(self, pending: PendingConnection) -> None:
        try:
            with suppress(OSError, HalfError, OverlongError):  # any disconnection is normal
                await self._open_connection(pending)
        finally:
            self._pending.pop(pending, None)
            pending.socket.close()

    async def _open_connection(self, pending: PendingConnection) -> None:
        pending.socket.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        pending.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_SIZE)
        pending.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        reads = TokenBucket(self._rules.rate, INITIAL_READ_BURST)
        line = Transport(pending.socket, self._rules.patience, partial(self._pace.await_turn, reads))
        wire: MovableWire
        async with timeout(self._rules.patience):
            first = await _read_first(line)
            if first.startswith(HTTP_REQUEST_PREFIX):
                wire = web = WebSocket(line, first, self._rules)
                authorities = own_authorities(self._host, *pending.socket.getsockname()[:2])
                has_token = await web.open(self._clients.access, self._clients.is_token, authorities, self._files)
                client = self._clients.join(pending.address, trusted=has_token)
                self._clients.place(client)
            elif first.lstrip(BLANK_BYTES).startswith(MESSAGE_PREFIXES):
                wire = Stream(line, first, self._rules.message)
                client = self._clients.join(pending.address)
            else:
                await line.close()
                return
        notice = partial(self._notice, pending, line, reads, client)
        notice()
        await serve_client(self._clients, wire, client, notice=notice)
        if client.stops_only:
            self._stop_lines.take(socket.socket(fileno=pending.socket.detach()), wire)

    def _notice(self, pending: PendingConnection, line: Transport, reads: TokenBucket, client: ConnectedClient) -> None:
        """Lift a connection's initial limits once its client has token or slot.

        An admitted client may send more data. The connection of a client with a slot is no longer pending, so that new
        ones do not replace it.
        """
        if client.admitted:
            line.admit()
        if client.placed:
            self._pending.pop(pending, None)
            reads.widen(ADMITTED_READ_BURST)


async def serve_console(clients: ClientRegistry, make_console: Callable[[Quotas], Console] = Console) -> None:
    """Serve standard input until it ends and all its documents are performed."""
    client = clients.join("stdin", trusted=True, movable=False)
    clients.place(client)
    await serve_client(clients, make_console(clients.rules), client)


async def _read_first(line: Transport) -> bytes:
    """Read the first bytes until they show the connection's protocol."""
    first = b""
    while HTTP_REQUEST_PREFIX.startswith(first.lstrip(BLANK_BYTES)) and len(first) < UNADMITTED_READ_LIMIT:
        data = await line.read(hurry=True)
        if not data:
            break
        first += data
    return first
