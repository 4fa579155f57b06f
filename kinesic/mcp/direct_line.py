"""Reserve a connection and a thread for one kind of request."""

from asyncio import shield, wrap_future
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from threading import Lock
from time import monotonic, sleep
from typing import Generic, Protocol, TypeVar

NO_INTERVAL = 0.0  # [s]


class Connection(Protocol):
    """Something that can be closed."""

    def close(self) -> None:
        """Close it."""


C = TypeVar("C", bound=Connection)
T = TypeVar("T")


class DirectLine(Generic[C, T]):
    """Make one request after the other, each for all callers that wait.

    So requests never pile up, however many callers there are. A connection that fails is replaced once for each
    request.
    """

    def __init__(
        self, connect: Callable[[], C], request: Callable[[C], T], *, name: str, interval: float = NO_INTERVAL
    ) -> None:
        """Connect.

        Args:
            connect: opens the connection; raises OSError.
            request: makes one request; raises OSError where the connection is of no use any more.
            name: of the thread.
            interval: [s] between the beginnings of two requests, at least.

        Raises:
            OSError: nobody is there.
        """
        self._connect, self._request, self._interval = connect, request, interval
        self._connection: C | None = connect()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix=name)
        self._changing = Lock()  # held for an instant, while the next request is joined or begins
        self._next: Future[T] | None = None  # request that has not begun
        self._earliest = 0.0  # [s] of the monotonic clock, at which it may begin

    async def request(self) -> T:
        """Wait for a request that begins after this call.

        It is made even if the caller leaves.

        Raises:
            OSError: two attempts failed.
        """
        with self._changing:
            if self._next is None:
                self._next = self._thread.submit(self._make_request)
            pending = self._next
        return await shield(wrap_future(pending))

    def close(self) -> None:
        """Close the connection."""
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
