"""Web and e-mail addresses in a text."""

import re

from kinesic.intent.manuscript.pieces import Manuscript, Step
from kinesic.intent.reading.addresses import ends_with_host

WEB_ADDRESS = re.compile(r"(?:https?|ftp)://[^\s<>]*|www\.[^\s<>]*", re.IGNORECASE)
MAX_USER_LENGTH = 64  # [characters] longest end of a user name between `_` and `@`
_ADDRESS_STARTS = ("http://", "https://", "ftp://", "www.")
_CLOSING_SIGNS = ".,;:!?)'\"*_]"  # signs after an address that do not belong to it


def read_address(state: Manuscript, *, ends: bool) -> Step | None:
    """Read the web or e-mail address with which the text continues.

    Returns:
        Length 0 without an address, None if it may be incomplete.
    """
    rest = state.rest
    if rest[0] == "/" and ends_with_host(state.spoken):
        return _skip(rest, re.match(r"[^\s<>]*", rest), "the path of an address", ends=ends)
    if rest[0] == "_" and state.spoken[-1:].isalnum():
        return _keep_user_name(rest, ends=ends)
    lowered = rest[: len("https://")].lower()
    if any(lowered.startswith(address_start) for address_start in _ADDRESS_STARTS):
        return _skip(rest, WEB_ADDRESS.match(rest), "an address", ends=ends)
    if not ends and any(address_start.startswith(lowered) for address_start in _ADDRESS_STARTS):
        return None
    return Step(0)


def _skip(rest: str, found: re.Match[str] | None, what: str, *, ends: bool) -> Step | None:
    length = found.end() if found else 1
    if length == len(rest) and not ends:
        return None
    address = rest[:length].rstrip(_CLOSING_SIGNS)
    text = " " if what == "an address" else ""
    return Step(len(address) or 1, text, f"{what} is not spoken: {address}" if address.strip("/") else "")


def _keep_user_name(rest: str, *, ends: bool) -> Step | None:
    """Keep an underscore within the user name of an e-mail address."""
    user = re.match(r"[\w.+-]{1,64}", rest)
    end = user.end() if user else 1
    if end == len(rest) and end < MAX_USER_LENGTH and not ends:
        return None
    return Step(1, "_") if rest[end : end + 1] == "@" else Step(0)
