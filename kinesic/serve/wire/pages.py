"""Files that the server shows to browsers, and what it lets their pages do."""

from collections.abc import Mapping
from dataclasses import dataclass
from email.utils import formatdate
from http import HTTPStatus
from types import MappingProxyType

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

# A page runs and shows what this server gives, talks to this server alone, and is no part of another page.
POLICY = "; ".join(
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
    """A file as a browser gets it."""

    type: str  # of the Internet, such as text/css
    body: bytes


NO_FILES: Mapping[str, WebFile] = MappingProxyType({})


def asks_for_file(request: Request) -> bool:
    """Whether a request wants a file, and no WebSocket."""
    return "Upgrade" not in request.headers


def show_file(path: str, files: Mapping[str, WebFile]) -> Response:
    """Answers a request for a file by its whole path; anything else is not found, whatever a disk may hold."""
    file = files.get(path.partition("?")[0])
    status = HTTPStatus.OK if file is not None else HTTPStatus.NOT_FOUND
    found = file or WebFile("text/plain; charset=utf-8", b"there is no such page\n")
    headers = Headers(
        [
            ("Date", formatdate(usegmt=True)),
            ("Connection", "close"),
            ("Content-Length", str(len(found.body))),
            ("Content-Type", found.type),
            ("Cache-Control", "no-cache"),
            ("Content-Security-Policy", POLICY),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
        ]
    )
    return Response(status.value, status.phrase, headers, found.body)
