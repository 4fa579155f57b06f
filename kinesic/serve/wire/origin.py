"""Says who may open a WebSocket: programs, and pages of this very server.

Any page that a browser shows may try. The browser says in `Origin` whose page it is, and in `Host` by which name it
found the server: a stranger's name that points here (DNS rebinding) shows there. Both are compared as a whole with the
few values that are right, so that there is nothing to be read cleverly.
"""

import re
from dataclasses import dataclass
from http import HTTPStatus
from ipaddress import ip_address
from socket import gethostname

from websockets.datastructures import Headers

from kinesic.body.config import ConfigError

ORIGIN = re.compile(r"(https?)://((?:[a-z0-9.-]+|\[[0-9a-f:.]+\])(?::[1-9][0-9]{0,4})?)")
LOOPBACK = ("localhost", "127.0.0.1", "[::1]")
SCHEMES = ("http", "https")
WEB_PORT = 80  # which a browser leaves out


@dataclass(frozen=True)
class Access:
    """Who may connect, and whether what they send may be plain text."""

    token: str | None = None  # that clients must show; None: none is needed
    origins: frozenset[str] = frozenset()  # of pages that may connect beside those of this server
    texts: bool = False  # whether a message that is neither XML nor JSON is said


ANYBODY_HERE = Access()


@dataclass(frozen=True)
class Rejection:
    """Why a request is refused."""

    status: HTTPStatus
    why: str


def read_origin(text: str) -> str:
    """Reads the origin of a page as an operator names it, such as `http://studio.local:5173`.

    Raises:
        ConfigError: it is none.
    """
    if ORIGIN.fullmatch(text.lower()) is None:
        raise ConfigError(f"--allow-origin {text}: give SCHEME://HOST[:PORT], such as http://localhost:5173")
    return text.lower()


def own_authorities(listening: str, local: str, port: int) -> frozenset[str]:
    """Lists what a request for this server may have as `Host`.

    Args:
        listening: the host that the server was asked to listen at.
        local: the address of this machine at which the connection came in.
        port: of the server.
    """
    address = ip_address(local.partition("%")[0])
    names = {_written(local)}
    if address.is_loopback:
        names.update(LOOPBACK)
    if not _is_wildcard(listening):
        names.add(_written(listening.lower()))
    else:
        names.update((gethostname().lower(), f"{gethostname().lower()}.local"))
    return frozenset(f"{name}:{port}" for name in names) | (frozenset(names) if port == WEB_PORT else frozenset())


def find_rejection(headers: Headers, authorities: frozenset[str], origins: frozenset[str]) -> Rejection | None:
    """Finds what is wrong with a request; None for a program, or a page that may connect.

    Args:
        headers: of the request.
        authorities: what `Host` may be, as `own_authorities` lists it.
        origins: of pages that may connect beside those of this server; their hosts may be asked for, too.
    """
    hosts, pages = headers.get_all("Host"), headers.get_all("Origin")
    known = authorities | {origin.partition("://")[2] for origin in origins}
    if len(hosts) != 1 or len(pages) > 1:
        return Rejection(HTTPStatus.BAD_REQUEST, "a request has one Host and at most one Origin")
    if hosts[0].lower() not in known:
        return Rejection(
            HTTPStatus.MISDIRECTED_REQUEST, f"Host is {hosts[0]!r}, this is {', '.join(sorted(authorities))}"
        )
    if pages and pages[0] not in origins | {f"{scheme}://{own}" for scheme in SCHEMES for own in authorities}:
        return Rejection(
            HTTPStatus.FORBIDDEN, f"pages of {pages[0]!r} may not connect, unless --allow-origin names them"
        )
    return None


def _written(host: str) -> str:
    """Writes a host as it stands in a URL."""
    bare = host.partition("%")[0]
    return f"[{bare}]" if ":" in bare else bare


def _is_wildcard(host: str) -> bool:
    try:
        return ip_address(host).is_unspecified
    except ValueError:
        return False
