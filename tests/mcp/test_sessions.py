"""Replacement of idle HTTP sessions with a stub application."""

import asyncio
from collections.abc import Awaitable, Callable
from itertools import count

from starlette.requests import Request
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from kinesic.mcp.call_queue import request_end
from kinesic.mcp.sessions import MAX_SESSIONS, OPENING_REQUESTS, SESSION_HEADER, SessionLimit


class Application:
    """Stub application that opens a session per POST and answers as scripted."""

    def __init__(self) -> None:
        self.sessions, self.may_answer = [], asyncio.Event()
        self.hosts, self.ends, self._numbers = [], [], count(1)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        request = Request(scope, receive)
        name = request.headers.get(SESSION_HEADER)
        self.hosts.append((request.method, request.headers.get("host")))
        self.ends.append(request_end.get())
        if name is None:
            await self._open(request, send)
        elif name not in self.sessions:
            await Response(status_code=404)(scope, receive, send)
        elif request.method == "DELETE":
            self.sessions.remove(name)
            await Response()(scope, receive, send)
        else:
            if request.url.path == "/slow":
                await self.may_answer.wait()
            await Response()(scope, receive, send)

    async def _open(self, request: Request, send: Send) -> None:
        if request.url.path == "/broken":
            await Response(status_code=400, headers={SESSION_HEADER: "broken"})(request.scope, request.receive, send)
            return
        name = f"s{next(self._numbers)}"
        self.sessions.append(name)
        if request.url.path == "/slow":
            await self.may_answer.wait()
        await Response(headers={SESSION_HEADER: name})(request.scope, request.receive, send)


class Web:
    """Requests to the application through the session limit."""

    def __init__(self, most: int) -> None:
        self.app = Application()
        self.limit = SessionLimit(self.app, max_sessions=most)

    async def ask(self, method: str = "POST", session: str = "", path: str = "/", host: str = "here") -> int:
        """Send an HTTP request and return the status of its answer."""
        headers = [(b"host", host.encode()), *([(SESSION_HEADER.encode(), session.encode())] if session else [])]
        statuses = []

        async def receive() -> dict:
            return {"type": "http.request", "body": b"", "more_body": False}

        async def send(message: dict) -> None:
            if message["type"] == "http.response.start":
                statuses.append(message["status"])

        scope = {"type": "http", "method": method, "path": path, "headers": headers, "query_string": b""}
        await self.limit(scope, receive, send)
        return statuses[0]

    def later(self, *arguments: str, **more: str) -> asyncio.Task[int]:
        return asyncio.create_task(self.ask(*arguments, **more))


def with_sessions(most: int, act: Callable[[Web], Awaitable[None]], *, opened: int) -> None:
    async def run() -> None:
        web = Web(most)
        for _ in range(opened):
            assert await web.ask() == 200
        await act(web)

    asyncio.run(asyncio.wait_for(run(), 20))


async def settle() -> None:
    for _ in range(10):
        await asyncio.sleep(0)


def test_new_http_session_replaces_the_session_that_was_idle_longest():
    async def act(web: Web) -> None:
        assert await web.ask(session="s1") == 200
        assert web.app.sessions == ["s1", "s2", "s3"]
        await web.ask(host="another.name")
        assert web.app.sessions == ["s1", "s3", "s4"]
        assert ("DELETE", "another.name") in web.app.hosts
        await web.ask()
        assert web.app.sessions == ["s1", "s4", "s5"]
        assert await web.ask(session="s3") == 404

    with_sessions(3, act, opened=3)


def test_only_the_newest_sixteen_of_forty_http_sessions_remain():
    async def act(web: Web) -> None:
        assert web.app.sessions == [f"s{k}" for k in range(25, 41)]

    assert MAX_SESSIONS == 16
    with_sessions(MAX_SESSIONS, act, opened=40)


def test_http_sessions_that_only_connect_do_not_end_an_active_session():
    async def act(web: Web) -> None:
        for _ in range(OPENING_REQUESTS):
            assert await web.ask(session="s1") == 200
        for _ in range(20):
            await web.ask()
        assert web.app.sessions[0] == "s1"
        assert await web.ask(session="s1") == 200

    with_sessions(3, act, opened=3)


def test_new_http_session_does_not_replace_a_session_with_a_pending_call():
    async def act(web: Web) -> None:
        calls = [web.later("POST", "s1", "/slow"), web.later("POST", "s2", "/slow")]
        await settle()
        for _ in range(3):
            await web.ask()
        assert web.app.sessions == ["s1", "s2", "s5"]
        web.app.may_answer.set()
        assert await asyncio.gather(*calls) == [200, 200]
        await web.ask()
        assert web.app.sessions == ["s2", "s6"]

    with_sessions(2, act, opened=2)


def test_http_session_without_an_open_stream_is_ended_before_sessions_with_one():
    async def act(web: Web) -> None:
        stream = web.later("GET", "s1", "/slow")
        await settle()
        await web.ask()
        assert web.app.sessions == ["s1", "s3"]
        await web.ask()
        assert web.app.sessions == ["s1", "s4"]
        others = web.later("GET", "s4", "/slow")
        await settle()
        await web.ask()
        assert len(web.app.sessions) == 2
        web.app.may_answer.set()
        await asyncio.gather(stream, others)

    with_sessions(2, act, opened=2)


def test_failed_http_request_ends_no_other_session():
    async def act(web: Web) -> None:
        assert await web.ask(path="/broken") == 400
        assert await web.ask(session="unknown") == 404
        assert web.app.sessions == ["s1", "s2"]

    with_sessions(2, act, opened=2)


def test_http_session_ended_by_its_client_allows_a_new_session():
    async def act(web: Web) -> None:
        assert await web.ask("DELETE", "s2") == 200
        await web.ask()
        assert web.app.sessions == ["s1", "s3"]
        assert web.app.hosts[2] == ("DELETE", "here")
        assert len([host for host in web.app.hosts if host[0] == "DELETE"]) == 1

    with_sessions(2, act, opened=2)


def test_tool_call_is_notified_when_its_http_request_ends():
    async def act(web: Web) -> None:
        call = web.later("POST", "s1", "/slow")
        await settle()
        end = web.app.ends[-1]
        assert end is not None
        assert not end.done()
        call.cancel()
        await settle()
        assert end.done()
        assert request_end.get() is None

    with_sessions(2, act, opened=1)


def test_session_limit_passes_an_asgi_lifespan_scope_to_the_application():
    handed = []

    async def app(scope: Scope, _receive: Receive, _send: Send) -> None:
        handed.append(scope["type"])

    asyncio.run(SessionLimit(app)({"type": "lifespan"}, None, None))
    assert handed == ["lifespan"]


def test_http_session_ended_by_the_application_allows_a_new_session():
    async def act(web: Web) -> None:
        web.app.sessions.remove("s2")
        assert await web.ask(session="s2") == 404
        await web.ask()
        assert web.app.sessions == ["s1", "s3"]
        await web.ask()
        assert list(web.limit._sessions) == web.app.sessions == ["s3", "s4"]

    with_sessions(2, act, opened=2)
