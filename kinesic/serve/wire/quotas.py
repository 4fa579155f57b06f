"""Size, rate and memory limits for clients.

Each refusal names the exceeded limit.
"""

from dataclasses import dataclass, fields
from time import monotonic

from kinesic.bml.block import DEFAULT_BOUNDS, Notice, NoticeType
from kinesic.bml.feedback import write_warning

UNKNOWN_ID = "message"  # id in warnings about messages whose block id could not be read


@dataclass(frozen=True)
class Quotas:
    """Size, rate and memory limits of a server for its clients.

    All values are positive.
    """

    message: int = 1_000_000  # [bytes] size of one message
    depth: int = DEFAULT_BOUNDS.depth  # nesting depth of elements
    duration: float = 300.0  # [s] duration of one block; planning a longer block delays other clients
    rate: float = 50.0  # [1/s] long-term message rate of one client
    burst: int = 100  # messages of one client in a burst
    waiting: int = 256  # blocks of one client waiting to be planned
    clients: int = 256  # connected clients that may do more than stop the robot
    fragments: int = 1000  # WebSocket frames of one client in a burst; half as many per second in the long term
    unread: int = 512  # unread messages of one client
    unread_bytes: int = 8_000_000  # [bytes] total size of unread messages of one client
    unread_bytes_of_all: int = 64_000_000  # [bytes] total size of unread messages of all clients
    patience: float = 10.0  # [s] timeout for the token, for the rest of a message, and for a client that does not read
    planning: float = 10.0  # [s] planning time of one block

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not value > 0:
                raise ValueError(f"{field.name} is {value}, must be above 0 (default: {field.default})")


DEFAULT_QUOTAS = Quotas()  # limits used without the option --rule


class TokenBucket:
    """Rate limiter with a long-term rate [1/s] and a burst size."""

    def __init__(self, rate: float, burst: float) -> None:
        """Create a full bucket."""
        self._rate, self._burst = rate, burst
        self._left, self._time = burst, monotonic()

    @property
    def period(self) -> float:
        """Time [s] in which one token is refilled."""
        return 1.0 / self._rate

    def widen(self, burst: float) -> None:
        """Increase the burst size to at least this value."""
        self._left += max(0.0, burst - self._burst)
        self._burst = max(self._burst, burst)

    def empty(self) -> None:
        """Remove all tokens."""
        self._left, self._time = 0.0, monotonic()

    def take(self) -> bool:
        """Take a token if available, and return success."""
        now = monotonic()
        self._left = min(self._burst, self._left + self._rate * (now - self._time))
        self._time = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


def quota_feedback(
    rule: str, what: str, *, name: str = UNKNOWN_ID, type_: NoticeType = NoticeType.IMPOSSIBLE_TO_SCHEDULE
) -> str:
    """Return a warningFeedback that names the violated limit.

    Args:
        rule: name of the rule.
        what: cause and remedy.
        name: block id, if the message could be read.
        type_: warning type.
    """
    return write_warning(Notice(type_, name, f"rule {rule}: {what}"))
