"""Serves the tools by HTTP, to programs of this machine or to those that show the token."""

from hmac import compare_digest

import uvicorn
from mcp.server import MCPServer
from mcp.server.transport_security import TransportSecuritySettings
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from kinesic.mcp.sessions import MAX_SESSIONS, SessionLimit

MOST_BYTES = 1_000_000  # of a request
MAX_OPEN_SESSIONS = 2 * MAX_SESSIONS  # while those beyond `MAX_SESSIONS` have pending calls


def serve_web(server: MCPServer, host: str, port: int, *, token: str | None) -> None:
    """Serves at an address until it is ended.

    Args:
        server: of the tools.
        host: of this machine.
        port: to listen at.
        token: that clients show as `Authorization: Bearer TOKEN`; None: those of this machine need none.
    """
    app = web_app(server, host, port, token=token)
    uvicorn.run(app, host=host, port=port, log_level="warning")


def web_app(server: MCPServer, host: str, port: int, *, token: str | None) -> ASGIApp:
    """Makes the application, which no page of the web may call: neither by its origin nor by a name that is rebound."""
    names = [
        f"{name}:{port}" for name in {host, *(("localhost", "127.0.0.1") if host in ("localhost", "127.0.0.1") else ())}
    ]
    security = TransportSecuritySettings(
        enable_dns_rebinding_protection=True, allowed_hosts=names, allowed_origins=[f"http://{name}" for name in names]
    )
    app = SessionLimit(
        server.streamable_http_app(
            transport_security=security, host=host, max_request_body_size=MOST_BYTES, max_sessions=MAX_OPEN_SESSIONS
        )
    )
    return app if token is None else _Guarded(app, token)


class _Guarded:
    """Lets in whoever shows the token."""

    def __init__(self, app: ASGIApp, token: str) -> None:
        self._app, self._right = app, f"Bearer {token}".encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            shown = Request(scope).headers.get("authorization", "").encode(errors="surrogateescape")
            if not compare_digest(shown, self._right):
                refused: Response = PlainTextResponse("show the token: Authorization: Bearer TOKEN", 401)
                await refused(scope, receive, send)
                return
        await self._app(scope, receive, send)
