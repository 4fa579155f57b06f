"""Files for browsers and their security headers."""

from collections.abc import Mapping
from dataclasses import dataclass
from email.utils import formatdate
from http import HTTPStatus
from types import MappingProxyType

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

# A page uses only files of this server, connects only to this server, and cannot be embedded in another page.
CONTENT_SECURITY_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data:",
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)


@dataclass(frozen=True)
class WebFile:
    """Content of a file for browsers, with its media type."""

    type: str  # media type, such as text/css
    body: bytes


NO_FILES: Mapping[str, WebFile] = MappingProxyType({})  # default: no files for browsers, empty


def asks_for_file(request: Request) -> bool:
    """Return whether a request is for a file instead of a WebSocket."""
    return "Upgrade" not in request.headers


def file_response(path: str, files: Mapping[str, WebFile]) -> Response:
    """Return the HTTP response for a path, 404 if not listed."""
    file = files.get(path.partition("?")[0])
    status = HTTPStatus.OK if file is not None else HTTPStatus.NOT_FOUND
    content = file or WebFile("text/plain; charset=utf-8", b"there is no such page\n")
    headers = Headers(
        [
            ("Date", formatdate(usegmt=True)),
            ("Connection", "close"),
            ("Content-Length", str(len(content.body))),
            ("Content-Type", content.type),
            ("Cache-Control", "no-cache"),
            ("Content-Security-Policy", CONTENT_SECURITY_POLICY),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
        ]
    )
    return Response(status.value, status.phrase, headers, content.body)
