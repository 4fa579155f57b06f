"""Stop lines: connections that only stop the robot, read in a thread of their own past all that other clients send.

Nobody may hold a line that does not stop: where the thread does not begin the server does not open, where it has ended
a connection ends at once, and a stop that fails is told to whoever sent it and to whoever runs the server.
"""

import socket
from asyncio import Event, Task, get_running_loop, run, sleep
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from threading import Event as Flag
from threading import Lock, Thread
from typing import Protocol

from kinesic.serve.clients import LATER, NORMAL, POLICY
from kinesic.serve.conversation import ClientWire
from kinesic.serve.priority import urgent
from kinesic.serve.wire.pace import Pace
from kinesic.serve.wire.protocol import Ping, Stop, control, json_answer, stop_failure
from kinesic.serve.wire.quotas import Quotas, TokenBucket
from kinesic.serve.wire.transport import HalfError, Transport

MOST_LINES = 64  # at once
READS = 20  # of a line at once, before it has to wait for its turn
REFUSAL = "this connection only stops the robot; open another one for everything else"


class MovableWire(ClientWire, Protocol):
    """Messages over a connection that another thread may go on with."""

    def move(self, line: Transport, /) -> None:
        """Goes on over another transport of the same connection."""


class StopLines:
    """Reads connections of which every `stop` is obeyed at once, whatever the thread of the other clients does."""

    def __init__(self, halt: Callable[[], None], rules: Quotas) -> None:
        """Begins without lines.

        Args:
            halt: makes an emergency stop; called in the thread of the lines.
            rules: what their clients may do.
        """
        self._halt, self._rules = halt, rules
        self._pace = Pace()
        self._tasks: set[Task[None]] = set()
        self._open = 0  # lines; who was refused and reads why is none
        self._changing = Lock()  # held while a line begins, or all of them end
        self._taking = False  # whether lines are read
        self._tried = Flag()  # whether the thread has begun to read, or has failed to
        self._thread = Thread(target=self._run, name="stop lines", daemon=True)

    def open(self) -> None:
        """Begins to read.

        Raises:
            RuntimeError: the system grants no thread, or it has ended at once.
        """
        self._thread.start()
        self._tried.wait()
        if not self._taking:
            raise RuntimeError("the thread that reads stop lines has ended at once; why is said above")

    def close(self) -> None:
        """Ends all lines."""
        with self._changing:
            if self._taking:
                self._taking = False
                self._loop.call_soon_threadsafe(self._end.set)
        if self._thread.is_alive():
            self._thread.join()

    def take(self, connection: socket.socket, wire: MovableWire) -> None:
        """Takes over a connection that nobody else reads or closes from now on; it ends at once where no line is read.

        Args:
            connection: to the client; does not block.
            wire: its messages.
        """
        with self._changing:
            if self._taking:
                self._loop.call_soon_threadsafe(self._begin, connection, wire)
            else:
                connection.close()

    def _run(self) -> None:
        try:
            run(self._serve())
        finally:
            self._tried.set()

    async def _serve(self) -> None:
        self._loop, self._end = get_running_loop(), Event()
        try:
            with urgent():
                self._taking = True
                self._tried.set()
                await self._end.wait()
        finally:
            with self._changing:
                self._taking = False

    def _begin(self, connection: socket.socket, wire: MovableWire) -> None:
        task = self._loop.create_task(self._attend(connection, wire))
        self._tasks.add(task)
        task.add_done_callback(partial(self._end_line, connection))

    def _end_line(self, connection: socket.socket, task: Task[None]) -> None:
        """Closes the connection, also of a client whom nobody had attended to when all ended."""
        self._tasks.discard(task)
        connection.close()
        if not task.cancelled() and (error := task.exception()) is not None:
            self._report("a stop line failed", error)

    def _report(self, what: str, error: BaseException) -> None:
        """Tells whoever runs the server, on standard error."""
        self._loop.call_exception_handler({"message": what, "exception": error})

    async def _attend(self, connection: socket.socket, wire: MovableWire) -> None:
        reads = TokenBucket(self._rules.rate, READS)
        line = Transport(connection, self._rules.patience, partial(self._pace.await_turn, reads))
        line.admit()
        wire.move(line)
        with suppress(OSError, HalfError):  # a client may leave in any way
            await wire.close(*await self._obey(wire))

    async def _obey(self, wire: MovableWire) -> tuple[int, str]:
        """Obeys a client until it goes; says why it is sent away, if it is."""
        if self._open >= MOST_LINES:
            return LATER, f"{MOST_LINES} connections only stop already; send stop by any other"
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
                    return POLICY, f"rule rate: at most {self._rules.rate:g} messages a second are taken"
                await sleep(0)  # other lines have their turn
        except ValueError as error:
            return POLICY, str(error)
        return NORMAL, ""

    def _answer(self, message: bytes) -> str:
        try:
            request = control(message)
        except ValueError as error:
            return json_answer("refused", why=str(error))
        match request:
            case Stop():
                return self._stop()
            case Ping(id):
                return json_answer("pong", id=id)
        return json_answer("refused", why=REFUSAL)

    def _stop(self) -> str:
        try:
            self._halt()
        except (OSError, EOFError, RuntimeError, ValueError) as error:  # which elsewhere say that a client has gone
            self._report("an emergency stop failed", error)
            return stop_failure(error)
        return json_answer("stopped")
