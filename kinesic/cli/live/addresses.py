"""Parsing of listening addresses given on the command line."""

from ipaddress import ip_address

from kinesic.body.config import ConfigError
from kinesic.client import DEFAULT_PORT
from kinesic.serve.address import Address


def read_listen_address(text: str, token: str | None) -> Address | None:
    """Parse the listening address HOST:PORT, or return None for `none`.

    Raises:
        ConfigError: the text is not an address, or other machines could connect without a token.
    """
    if text == "none":
        return None
    host, _, port = text.rpartition(":")
    host = host.strip("[]")
    if not host or not port.isdecimal() or int(port) > 65_535:
        raise ConfigError(f"--listen {text}: give HOST:PORT, such as 127.0.0.1:{DEFAULT_PORT}, or none")
    if not token and not _is_loopback(host):
        raise ConfigError(f"--listen {text}: other machines can connect there; give --token-file, or set KINESIC_TOKEN")
    return Address(host, int(port))


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
