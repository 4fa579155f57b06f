"""What a client may do; each refusal names its rule."""

from dataclasses import dataclass, fields
from time import monotonic

from kinesic.bml.block import BOUNDS, Notice, NoticeType
from kinesic.bml.feedback import warning

NOBODY = "message"  # id of a warning about a message whose own id nobody has read


@dataclass(frozen=True)
class Quotas:
    """Limits of a server, above zero."""

    message: int = 1_000_000  # [bytes] of one message
    depth: int = BOUNDS.depth  # of elements inside one another
    duration: float = 300.0  # [s] of one block: a longer one delays others while it is planned
    rate: float = 50.0  # [1/s] messages of one client, in the long run
    burst: int = 100  # messages of one client at once
    waiting: int = 256  # blocks of one client that wait to be planned
    clients: int = 256  # at once
    fragments: int = 1000  # WebSocket frames of one client at once, and half as many a second in the long run
    unread: int = 512  # messages that wait for one client to read them
    unread_bytes: int = 8_000_000  # [bytes] of memory that they take
    unread_bytes_of_all: int = 64_000_000  # [bytes] of memory that the messages to all clients take
    patience: float = 10.0  # [s] for a token, for the rest of a message, for a client that does not read
    planning: float = 10.0  # [s] that planning one block may take

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not value > 0:
                raise ValueError(f"{field.name} is {value}, must be above 0 (usual: {field.default})")


USUAL = Quotas()


class TokenBucket:
    """Bounds what happens to `rate` a second in the long run, and `burst` at once."""

    def __init__(self, rate: float, burst: float) -> None:
        """Begins full."""
        self._rate, self._burst = rate, burst
        self._left, self._time = burst, monotonic()

    @property
    def period(self) -> float:
        """[s] until another token is there."""
        return 1.0 / self._rate

    def widen(self, burst: float) -> None:
        """Bounds what happens to so much at once from now on, if that is more."""
        self._left += max(0.0, burst - self._burst)
        self._burst = max(self._burst, burst)

    def empty(self) -> None:
        """Takes all tokens."""
        self._left, self._time = 0.0, monotonic()

    def take(self) -> bool:
        """Takes a token; False where none is left."""
        now = monotonic()
        self._left = min(self._burst, self._left + self._rate * (now - self._time))
        self._time = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


def quota_feedback(
    rule: str, what: str, *, name: str = NOBODY, type_: NoticeType = NoticeType.IMPOSSIBLE_TO_SCHEDULE
) -> str:
    """Writes the warningFeedback that names the rule by which a message was refused.

    Args:
        rule: name of the rule.
        what: what was wrong, and what would have worked.
        name: id of its block, where that can be read.
        type_: of the warning.
    """
    return warning(Notice(type_, name, f"rule {rule}: {what}"))
