"""Bounded queue of tool calls that can be discarded together."""

from asyncio import CancelledError, Future, Lock, Task, create_task, current_task, get_running_loop, sleep
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from contextvars import ContextVar
from time import monotonic
from typing import TypeVar

from kinesic.mcp.errors import RefusedError

MAX_CALLS = 64  # largest number of pending calls, including the current one
MIN_CALL_INTERVAL = 0.1  # [s] shortest time between two calls, as the server accepts 50 messages per second
REFUSAL_DELAY = 0.1  # [s] delay of answers to discarded calls, so that the emergency stop is answered first
CLIENT_GONE = "the client is gone"  # answer to a call whose client has disconnected

T = TypeVar("T")  # type of a call's result

# Done when the request of the current call has ended, by an answer or by a disconnection.
request_end: ContextVar[Future[None] | None] = ContextVar("request_end", default=None)


class CallQueue:
    """Queue that executes tool calls in order of arrival."""

    def __init__(
        self, *, max_calls: int = MAX_CALLS, interval: float = MIN_CALL_INTERVAL, refusal_delay: float = REFUSAL_DELAY
    ) -> None:
        """Create an empty queue of tool calls.

        Args:
            max_calls: maximum number of pending calls.
            interval: minimum time [s] between the starts of two calls.
            refusal_delay: time [s] after which discarded calls are answered.
        """
        self._max_calls, self._interval, self._refusal_delay = max_calls, interval, refusal_delay
        self._calls: dict[Task[object], str] = {}  # reason for cancelling each call; empty if active
        self._current: Task[object] | None = None  # call in its turn
        self._lock = Lock()
        self._earliest = 0.0  # [s] monotonic clock time at which the next call may start

    async def run(self, act: Callable[[], Coroutine[None, None, T]]) -> T:
        """Run a tool call, whose `turn` follows those of earlier calls.

        The call is cancelled if its client cancels it or disconnects, and at an emergency stop.

        Args:
            act: does the work, within `turn` where it must be exclusive.

        Raises:
            RefusedError: too many calls are pending, or this one was cancelled.
        """
        count = sum(not why for why in self._calls.values())
        if count >= self._max_calls:
            raise RefusedError(
                f"{count} calls that move the robot are pending, and no more are taken: wait for their answers and "
                "call again, or call stop, which discards them"
            )
        call = create_task(act())
        self._calls[call] = ""
        end = request_end.get()
        if end is not None:
            end.add_done_callback(lambda _: self._cancel(call, CLIENT_GONE))
        try:
            return await call
        except CancelledError:
            if why := self._calls[call]:
                raise RefusedError(why) from None
            raise
        finally:
            del self._calls[call]

    @asynccontextmanager
    async def turn(self) -> AsyncIterator[None]:
        """Run the enclosed code after earlier tool calls and before later ones.

        Raises:
            RefusedError: the call was cancelled while waiting.
        """
        async with self._lock:
            self._current = call = current_task()
            try:
                await sleep(max(0.0, self._earliest - monotonic()))
                if call is not None and (why := self._calls.get(call)):
                    raise RefusedError(why)
                self._earliest = monotonic() + self._interval
                yield
            finally:
                self._current = None

    def discard(self, why: str) -> None:
        """Cancel all pending calls, so that none of them moves the robot.

        Args:
            why: answer to each of them.
        """
        for call in self._calls:
            self._calls[call] = self._calls[call] or why
        if self._current is not None:
            self._current.cancel()
        get_running_loop().call_later(self._refusal_delay, self._answer_discarded, tuple(self._calls), why)

    def _answer_discarded(self, calls: tuple[Task[object], ...], why: str) -> None:
        for call in calls:
            self._cancel(call, why)

    def _cancel(self, call: Task[object], why: str) -> None:
        if call in self._calls:
            self._calls[call] = self._calls[call] or why
            call.cancel()
