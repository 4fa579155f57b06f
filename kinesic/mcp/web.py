"""HTTP server for the tools, restricted to authorised programs.

These are programs on this machine or programs with the token.
"""

from hmac import compare_digest

import uvicorn
from mcp.server import MCPServer
from mcp.server.transport_security import TransportSecuritySettings
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from kinesic.mcp.sessions import MAX_SESSIONS, SessionLimit

MAX_REQUEST_SIZE = 1_000_000  # [bytes] largest request body
MAX_OPEN_SESSIONS = 2 * MAX_SESSIONS  # largest number of HTTP sessions, including those with pending calls


def serve_web(server: MCPServer, host: str, port: int, *, token: str | None) -> None:
    """Serve the tools at an address until the process ends.

    Args:
        server: tool server.
        host: host name or address of this machine.
        port: port to listen at.
        token: token that clients send as `Authorization: Bearer TOKEN`; None for programs of this machine only.
    """
    app = web_app(server, host, port, token=token)
    uvicorn.run(app, host=host, port=port, log_level="warning")


def web_app(server: MCPServer, host: str, port: int, *, token: str | None) -> ASGIApp:
    """Create the web application of the tools, protected from browser pages.

    Requests with a foreign origin or a rebound host name are refused.
    """
    names = [
        f"{name}:{port}" for name in {host, *(("localhost", "127.0.0.1") if host in ("localhost", "127.0.0.1") else ())}
    ]
    security = TransportSecuritySettings(
        enable_dns_rebinding_protection=True, allowed_hosts=names, allowed_origins=[f"http://{name}" for name in names]
    )
    app = SessionLimit(
        server.streamable_http_app(
            transport_security=security,
            host=host,
            max_request_body_size=MAX_REQUEST_SIZE,
            max_sessions=MAX_OPEN_SESSIONS,
        )
    )
    return app if token is None else _TokenGuard(app, token)


class _TokenGuard:
    """ASGI middleware that answers requests without the token with status 401."""

    def __init__(self, app: ASGIApp, token: str) -> None:
        self._app, self._authorization = app, f"Bearer {token}".encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            shown = Request(scope).headers.get("authorization", "").encode(errors="surrogateescape")
            if not compare_digest(shown, self._authorization):
                refused: Response = PlainTextResponse("show the token: Authorization: Bearer TOKEN", 401)
                await refused(scope, receive, send)
                return
        await self._app(scope, receive, send)
