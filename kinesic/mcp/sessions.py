"""Limit on HTTP sessions: idle sessions end when new ones open."""

from asyncio import get_running_loop
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from kinesic.mcp.call_queue import request_end

SESSION_HEADER = "mcp-session-id"  # HTTP header with the session id
MAX_SESSIONS = 16  # number of HTTP sessions above which sessions without pending calls are ended
OPENING_REQUESTS = 2  # POST requests of a client that only opens a session: `initialize` and its confirmation


@dataclass(eq=False)
class _Session:
    """Counts of requests and open streams of an HTTP session."""

    requests: int = 0  # number of requests so far, without streams
    pending_calls: int = 0
    streams: int = 0  # number of open streams of the client

    @contextmanager
    def used(self, method: str) -> Iterator[None]:
        """Count a request or stream of the session during a `with` block."""
        is_stream = method == "GET"
        self.streams += is_stream
        self.requests += not is_stream
        self.pending_calls += not is_stream
        try:
            yield
        finally:
            self.streams -= is_stream
            self.pending_calls -= not is_stream

    @property
    def is_working(self) -> bool:
        """Whether the client has sent requests after the opening handshake."""
        return self.requests > OPENING_REQUESTS


class SessionLimit:
    """ASGI middleware that ends idle HTTP sessions when new ones open.

    Sessions that were only opened are ended first, then those without a listening client, so that clients that only
    connect do not displace the one that may have to stop the robot. A session with a pending call is never ended. The
    client of an ended session receives status 404 and opens another one.
    """

    def __init__(self, app: ASGIApp, *, max_sessions: int = MAX_SESSIONS) -> None:
        """Create the middleware without any session.

        Args:
            app: application that opens and serves sessions, and ends one by a DELETE request.
            max_sessions: number of sessions kept if none has a pending call.
        """
        self._app, self._max_sessions = app, max_sessions
        self._sessions: dict[str, _Session] = {}  # least recently used first

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request, and mark its session as recently used."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        with _announce_end():
            name = Headers(scope=scope).get(SESSION_HEADER, "")
            session = self._sessions.get(name)
            if session is None:
                await self._open(scope, receive, send)
                return
            with session.used(scope["method"]):
                await self._app(scope, receive, self._watch_end(scope["method"], name, send))
            if name in self._sessions:
                self._sessions[name] = self._sessions.pop(name)  # most recently used last

    async def _open(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request without a session id, which may open one."""
        opened = _Session()

        async def note_session(message: Message) -> None:
            if message["type"] == "http.response.start" and message["status"] == 200:
                name = Headers(raw=message["headers"]).get(SESSION_HEADER, "")
                if name:
                    self._sessions[name] = opened
                    await self._end_idle(scope, opened)
            await send(message)

        with opened.used(scope["method"]):
            await self._app(scope, receive, note_session)

    def _watch_end(self, method: str, name: str, send: Send) -> Send:
        """Wrap `send` to remove the session once the application ends it."""
        ended = (200, 404) if method == "DELETE" else (404,)

        async def note_end(message: Message) -> None:
            if message["type"] == "http.response.start" and message["status"] in ended:
                self._sessions.pop(name, None)
            await send(message)

        return note_end

    async def _end_idle(self, scope: Scope, opened: _Session) -> None:
        idle = [name for name, session in self._sessions.items() if session is not opened and not session.pending_calls]
        idle.sort(key=lambda name: (self._sessions[name].is_working, self._sessions[name].streams > 0))
        for name in idle[: max(0, len(self._sessions) - self._max_sessions)]:
            del self._sessions[name]
            await _delete(self._app, scope, name)


@contextmanager
def _announce_end() -> Iterator[None]:
    """Notify the tool calls of a request when the request ends."""
    end = get_running_loop().create_future()
    token = request_end.set(end)
    try:
        yield
    finally:
        request_end.reset(token)
        end.set_result(None)


async def _delete(app: ASGIApp, scope: Scope, name: str) -> None:
    """End an HTTP session on behalf of its client."""
    headers = [*((key, value) for key, value in scope["headers"] if key == b"host"), (b"mcp-session-id", name.encode())]

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(_message: Message) -> None:
        """Discard the application's answer to the request that ends a session."""

    await app({**scope, "method": "DELETE", "headers": headers}, receive, send)
