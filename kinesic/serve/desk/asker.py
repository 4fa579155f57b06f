"""A client as those know it who answer its questions."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class Asker:
    """A client with a question."""

    number: int
    send: Callable[[str], None]
    is_there: Callable[[], bool]
