"""Bounded queue of the calls that move the robot."""

from asyncio import CancelledError, Future, Lock, Task, create_task, current_task, get_running_loop, sleep
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from contextvars import ContextVar
from time import monotonic
from typing import TypeVar

from kinesic.mcp.errors import RefusedError

MAX_CALLS = 64  # that wait or are carried out at once
MIN_CALL_INTERVAL = 0.1  # [s] between two beginnings: each call sends two messages, and the server takes 50 a second
REFUSAL_DELAY = 0.1  # [s] after which discarded calls are answered: the answer to the stop goes before
CLIENT_GONE = "the client is gone"  # answer that nobody reads

T = TypeVar("T")

# Done as soon as the request that brought the present call has ended, whether it was answered or its client left.
request_end: ContextVar[Future[None] | None] = ContextVar("request_end", default=None)


class CallQueue:
    """Carry out calls in the order in which they came."""

    def __init__(
        self, *, max_calls: int = MAX_CALLS, interval: float = MIN_CALL_INTERVAL, refusal_delay: float = REFUSAL_DELAY
    ) -> None:
        """Begin empty.

        Args:
            max_calls: that wait or are carried out at once.
            interval: [s] between the beginnings of two calls, at least.
            refusal_delay: [s] after which discarded calls are answered.
        """
        self._max_calls, self._interval, self._refusal_delay = max_calls, interval, refusal_delay
        self._calls: dict[Task[object], str] = {}  # why each is given up; empty if it is not
        self._present: Task[object] | None = None  # call whose turn it is
        self._lock = Lock()
        self._earliest = 0.0  # [s] of the monotonic clock, at which the next call may begin

    async def run(self, act: Callable[[], Coroutine[None, None, T]]) -> T:
        """Carry out a call after all earlier ones.

        It is given up when its client cancels it or leaves, and when an emergency stop comes.

        Args:
            act: does the work, within `turn` as far as it is to be alone.

        Raises:
            RefusedError: too many calls wait, or this one was given up.
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
            end.add_done_callback(lambda _: self._give_up(call, CLIENT_GONE))
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
        """Wait for all earlier calls, and hold up later ones.

        Raises:
            RefusedError: the call was given up meanwhile.
        """
        async with self._lock:
            self._present = call = current_task()
            try:
                await sleep(max(0.0, self._earliest - monotonic()))
                if call is not None and (why := self._calls.get(call)):
                    raise RefusedError(why)
                self._earliest = monotonic() + self._interval
                yield
            finally:
                self._present = None

    def discard(self, why: str) -> None:
        """Give up all calls, so that none of them moves the robot.

        Args:
            why: answer to each of them.
        """
        for call in self._calls:
            self._calls[call] = self._calls[call] or why
        if self._present is not None:
            self._present.cancel()
        get_running_loop().call_later(self._refusal_delay, self._answer_discarded, tuple(self._calls), why)

    def _answer_discarded(self, calls: tuple[Task[object], ...], why: str) -> None:
        for call in calls:
            self._give_up(call, why)

    def _give_up(self, call: Task[object], why: str) -> None:
        if call in self._calls:
            self._calls[call] = self._calls[call] or why
            call.cancel()
