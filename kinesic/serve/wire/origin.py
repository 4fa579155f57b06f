"""Access rules for WebSocket clients: programs, and pages of this server.

Any page in a browser may try to connect. The browser reports the page's origin in `Origin` and the server's name in
`Host`; a foreign name that resolves to this machine (DNS rebinding) shows there. Both are compared as a whole with the
few valid values, so that no parsing is needed.
"""

import re
from dataclasses import dataclass
from http import HTTPStatus
from ipaddress import ip_address
from socket import gethostname

from websockets.datastructures import Headers

from kinesic.body.config import ConfigError

# Scheme and authority of a page origin, such as http://studio.local:5173
ORIGIN_PATTERN = re.compile(r"(https?)://((?:[a-z0-9.-]+|\[[0-9a-f:.]+\])(?::[1-9][0-9]{0,4})?)")
LOOPBACK_NAMES = ("localhost", "127.0.0.1", "[::1]")  # host names of this machine in URLs
WEB_SCHEMES = ("http", "https")  # URL schemes of page origins
DEFAULT_HTTP_PORT = 80  # port that browsers omit in the Host header


@dataclass(frozen=True)
class Access:
    """Access rules for clients, and whether plain text is accepted."""

    token: str | None = None  # token that clients must send; None: no token is required
    origins: frozenset[str] = frozenset()  # origins of pages that may connect, in addition to pages of this server
    texts: bool = False  # whether a message that is neither XML nor JSON is spoken


OPEN_ACCESS = Access()  # access without a token: any program, but only web pages of this server


@dataclass(frozen=True)
class Rejection:
    """HTTP status and reason of a refused request."""

    status: HTTPStatus
    why: str


def read_origin(text: str) -> str:
    """Validate an allowed origin from the command line, such as `http://studio.local:5173`.

    Raises:
        ConfigError: the text is not an origin.
    """
    if ORIGIN_PATTERN.fullmatch(text.lower()) is None:
        raise ConfigError(f"--allow-origin {text}: give SCHEME://HOST[:PORT], such as http://localhost:5173")
    return text.lower()


def own_authorities(listening: str, local: str, port: int) -> frozenset[str]:
    """Return the valid `Host` values of requests to this server.

    Args:
        listening: host at which the server listens.
        local: address of this machine at which the connection came in.
        port: port of the server.
    """
    address = ip_address(local.partition("%")[0])
    names = {_url_host(local)}
    if address.is_loopback:
        names.update(LOOPBACK_NAMES)
    if not _is_wildcard(listening):
        names.add(_url_host(listening.lower()))
    else:
        names.update((gethostname().lower(), f"{gethostname().lower()}.local"))
    return frozenset(f"{name}:{port}" for name in names) | (
        frozenset(names) if port == DEFAULT_HTTP_PORT else frozenset()
    )


def find_rejection(headers: Headers, authorities: frozenset[str], origins: frozenset[str]) -> Rejection | None:
    """Return the reason to refuse a request, or None to allow it.

    Programs and pages of allowed origins may connect.

    Args:
        headers: headers of the request.
        authorities: valid `Host` values, from `own_authorities`.
        origins: origins of other pages that may connect; their hosts are also valid `Host` values.
    """
    hosts, pages = headers.get_all("Host"), headers.get_all("Origin")
    valid_hosts = authorities | {origin.partition("://")[2] for origin in origins}
    if len(hosts) != 1 or len(pages) > 1:
        return Rejection(HTTPStatus.BAD_REQUEST, "a request has one Host and at most one Origin")
    if hosts[0].lower() not in valid_hosts:
        return Rejection(
            HTTPStatus.MISDIRECTED_REQUEST, f"Host is {hosts[0]!r}, this is {', '.join(sorted(authorities))}"
        )
    if pages and pages[0] not in origins | {
        f"{scheme}://{authority}" for scheme in WEB_SCHEMES for authority in authorities
    }:
        return Rejection(
            HTTPStatus.FORBIDDEN, f"pages of {pages[0]!r} may not connect, unless --allow-origin names them"
        )
    return None


def _url_host(host: str) -> str:
    """Format a host as in a URL, with IPv6 addresses in brackets."""
    address = host.partition("%")[0]
    return f"[{address}]" if ":" in address else address


def _is_wildcard(host: str) -> bool:
    try:
        return ip_address(host).is_unspecified
    except ValueError:
        return False
