"""Client that waits for the answer to its query."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class Requester:
    """Client that sent a query, with its number and answer channel."""

    number: int
    send: Callable[[str], None]
    is_there: Callable[[], bool]
