"""Dedicated connection and thread for one kind of request."""

from asyncio import shield, wrap_future
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from threading import Lock
from time import monotonic, sleep
from typing import Generic, Protocol, TypeVar

NO_INTERVAL = 0.0  # [s] minimum time between requests that may follow one another at once


class Connection(Protocol):
    """Connection that can be closed."""

    def close(self) -> None:
        """Close the connection to the server."""


C = TypeVar("C", bound=Connection)  # type of the connection
T = TypeVar("T")  # type of a request's result


class DirectLine(Generic[C, T]):
    """Connection for sequential requests, each answering all waiting callers.

    Requests never pile up, however many callers there are. A failed connection is replaced once per request.
    """

    def __init__(
        self, connect: Callable[[], C], request: Callable[[C], T], *, name: str, interval: float = NO_INTERVAL
    ) -> None:
        """Open the connection to the server.

        Args:
            connect: opens the connection; raises OSError.
            request: executes one request; raises OSError if the connection has failed.
            name: name of the thread.
            interval: minimum time [s] between the starts of two requests.

        Raises:
            OSError: no server listens.
        """
        self._connect, self._request, self._interval = connect, request, interval
        self._connection: C | None = connect()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix=name)
        self._changing = Lock()  # held briefly while the next request is joined or started
        self._next: Future[T] | None = None  # request that has not started
        self._earliest = 0.0  # [s] monotonic clock time at which the next request may start

    async def request(self) -> T:
        """Return the result of the next request, shared by all waiting callers.

        The request starts after this call, and is executed even if the caller is cancelled.

        Raises:
            OSError: two attempts failed.
        """
        with self._changing:
            if self._next is None:
                self._next = self._thread.submit(self._make_request)
            pending = self._next
        return await shield(wrap_future(pending))

    def close(self) -> None:
        """Close the connection to the server."""
        self._thread.shutdown(wait=False, cancel_futures=True)
        if self._connection is not None:
            self._connection.close()

    def _make_request(self) -> T:
        sleep(max(0.0, self._earliest - monotonic()))
        with self._changing:
            self._next = None
        self._earliest = monotonic() + self._interval
        if self._connection is not None:
            try:
                return self._request(self._connection)
            except OSError:
                self._connection.close()
                self._connection = None
        connection = self._connect()
        try:
            result = self._request(connection)
        except OSError:
            connection.close()
            raise
        self._connection = connection
        return result
