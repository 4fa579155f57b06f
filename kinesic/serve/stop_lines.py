"""Emergency-stop lines: connections that only stop the robot.

A separate thread reads them, independent of all other clients. No client may hold a line without function: if the
thread does not start, the server does not open; after the thread has ended, connections are closed at once. A failed
stop is reported to its sender and on the standard error of the server.
"""

import socket
from asyncio import Event, Task, get_running_loop, run, sleep
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from threading import Event as Flag
from threading import Lock, Thread
from typing import Protocol

from kinesic.serve.clients import CLOSE_NORMAL, CLOSE_POLICY_VIOLATION, CLOSE_TRY_LATER
from kinesic.serve.conversation import ClientWire
from kinesic.serve.priority import raise_priority
from kinesic.serve.wire.pace import ReadPace
from kinesic.serve.wire.protocol import Ping, Stop, json_answer, read_control, stop_failure
from kinesic.serve.wire.quotas import Quotas, TokenBucket
from kinesic.serve.wire.transport import HalfError, Transport

MAX_STOP_LINES = 64  # largest number of simultaneous emergency-stop connections
READ_BURST = 20  # number of successive reads of an emergency-stop connection that do not wait for other connections
STOP_ONLY_REFUSAL = "this connection only stops the robot; open another one for everything else"


class MovableWire(ClientWire, Protocol):
    """Message connection that another thread can take over."""

    def move(self, line: Transport, /) -> None:
        """Continue over another transport of the same connection."""


class StopLines:
    """Thread that reads emergency-stop connections and executes each `stop` at once."""

    def __init__(self, emergency_stop: Callable[[], None], rules: Quotas) -> None:
        """Create a reader without emergency-stop connections.

        Args:
            emergency_stop: executes an emergency stop; called in the thread of the stop lines.
            rules: limits for the clients.
        """
        self._emergency_stop, self._rules = emergency_stop, rules
        self._pace = ReadPace()
        self._tasks: set[Task[None]] = set()
        self._open = 0  # open lines, without refused ones
        self._changing = Lock()  # held while a line starts or all lines end
        self._is_running = False  # whether lines are read
        self._started = Flag()  # set when the thread has started to read or has failed
        self._thread = Thread(target=self._run, name="stop lines", daemon=True)

    def open(self) -> None:
        """Start the thread that reads all emergency-stop connections.

        Raises:
            RuntimeError: the thread could not be started or has ended at once.
        """
        self._thread.start()
        self._started.wait()
        if not self._is_running:
            raise RuntimeError("the thread that reads stop lines has ended at once; see the error above")

    def close(self) -> None:
        """Close all emergency-stop connections and wait for their thread to end."""
        with self._changing:
            if self._is_running:
                self._is_running = False
                self._loop.call_soon_threadsafe(self._end.set)
        if self._thread.is_alive():
            self._thread.join()

    def take(self, connection: socket.socket, wire: MovableWire) -> None:
        """Take over a client's connection as an emergency-stop line.

        Close it if the thread has ended.

        Args:
            connection: non-blocking socket of the client; no other thread reads or closes it from now on.
            wire: messages of the client.
        """
        with self._changing:
            if self._is_running:
                self._loop.call_soon_threadsafe(self._begin, connection, wire)
            else:
                connection.close()

    def _run(self) -> None:
        try:
            run(self._serve())
        finally:
            self._started.set()

    async def _serve(self) -> None:
        self._loop, self._end = get_running_loop(), Event()
        try:
            with raise_priority():
                self._is_running = True
                self._started.set()
                await self._end.wait()
        finally:
            with self._changing:
                self._is_running = False

    def _begin(self, connection: socket.socket, wire: MovableWire) -> None:
        task = self._loop.create_task(self._serve_connection(connection, wire))
        self._tasks.add(task)
        task.add_done_callback(partial(self._end_line, connection))

    def _end_line(self, connection: socket.socket, task: Task[None]) -> None:
        """Close a connection, even if its task never ran."""
        self._tasks.discard(task)
        connection.close()
        if not task.cancelled() and (error := task.exception()) is not None:
            self._report("a stop line failed", error)

    def _report(self, message: str, error: BaseException) -> None:
        """Report an error on the standard error of the server."""
        self._loop.call_exception_handler({"message": message, "exception": error})

    async def _serve_connection(self, connection: socket.socket, wire: MovableWire) -> None:
        reads = TokenBucket(self._rules.rate, READ_BURST)
        line = Transport(connection, self._rules.patience, partial(self._pace.await_turn, reads))
        line.admit()
        wire.move(line)
        with suppress(OSError, HalfError):  # any disconnection is normal
            await wire.close(*await self._serve_client(wire))

    async def _serve_client(self, wire: MovableWire) -> tuple[int, str]:
        """Serve a client, and return close code and reason at the end."""
        if self._open >= MAX_STOP_LINES:
            return CLOSE_TRY_LATER, f"{MAX_STOP_LINES} connections only stop already; send stop by any other"
        self._open += 1
        try:
            return await self._answer_all(wire)
        finally:
            self._open -= 1

    async def _answer_all(self, wire: MovableWire) -> tuple[int, str]:
        messages = TokenBucket(self._rules.rate, self._rules.burst)
        await wire.send(json_answer("stop_line"))
        try:
            async for message in wire.messages(lambda: False):
                await wire.send(self._answer(message))
                if not messages.take():
                    return (
                        CLOSE_POLICY_VIOLATION,
                        f"rule rate: at most {self._rules.rate:g} messages a second are taken",
                    )
                await sleep(0)  # other lines take turns
        except ValueError as error:
            return CLOSE_POLICY_VIOLATION, str(error)
        return CLOSE_NORMAL, ""

    def _answer(self, message: bytes) -> str:
        try:
            request = read_control(message)
        except ValueError as error:
            return json_answer("refused", why=str(error))
        match request:
            case Stop():
                return self._stop()
            case Ping(id):
                return json_answer("pong", id=id)
        return json_answer("refused", why=STOP_ONLY_REFUSAL)

    def _stop(self) -> str:
        try:
            self._emergency_stop()
        except (
            OSError,
            EOFError,
            RuntimeError,
            ValueError,
        ) as error:  # caught here, because elsewhere they mean a lost client
            self._report("an emergency stop failed", error)
            return stop_failure(error)
        return json_answer("stopped")
