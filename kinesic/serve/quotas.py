"""What a client may do, and the queues that hold to it; each refusal names its rule.

Documents are planned in turns, so that nobody waits behind somebody else's heap; what a client has still to read is
bounded, so that a slow reader costs nobody else anything.
"""

from asyncio import Event
from collections import deque
from dataclasses import dataclass, fields
from time import monotonic

from kinesic.bml.block import BOUNDS, Notice, NoticeType
from kinesic.bml.feedback import warning

NOBODY = "message"  # id of a warning about a message whose own id nobody has read
MINOR = "<syncPointProgress"  # what such a message begins with


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
    unread: int = 512  # messages that wait for one client to read them
    patience: float = 10.0  # [s] for a token, for the rest of a message, for a client that does not read
    planning: float = 10.0  # [s] that planning one block may take

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not value > 0:
                raise ValueError(f"{field.name} is {value}, must be above 0 (usual: {field.default})")


USUAL = Quotas()


class TokenBucket:
    """Bounds messages to `rate` a second in the long run, and `burst` at once."""

    def __init__(self, rules: Quotas) -> None:
        """Begins full."""
        self._rate, self._burst = rules.rate, float(rules.burst)
        self._left, self._time = self._burst, monotonic()

    def take(self) -> bool:
        """Takes a token for one message; False where none is left."""
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


@dataclass(frozen=True)
class QueuedDocument:
    """A document that waits to be planned."""

    text: bytes
    sender: int
    source: str  # how messages call it


class FairQueue:
    """Documents that wait: senders take turns, each with its oldest first."""

    def __init__(self, most: int) -> None:
        """Begins empty, for so many documents of each sender."""
        self._most = most
        self._lines: dict[int, deque[QueuedDocument]] = {}  # the sender whose turn it is first

    def __len__(self) -> int:
        return sum(map(len, self._lines.values()))

    def __contains__(self, sender: int) -> bool:
        return sender in self._lines

    def add(self, waiting: QueuedDocument) -> bool:
        """Adds a document; False where too many of this sender's wait."""
        line = self._lines.setdefault(waiting.sender, deque())
        if len(line) >= self._most:
            return False
        line.append(waiting)
        return True

    def next(self) -> QueuedDocument | None:
        """Takes the document whose turn it is; None where none waits."""
        if not self._lines:
            return None
        sender = next(iter(self._lines))
        line = self._lines.pop(sender)
        found = line.popleft()
        if line:
            self._lines[sender] = line  # behind the others
        return found

    def clear(self) -> tuple[QueuedDocument, ...]:
        """Takes all documents."""
        found = tuple(waiting for line in self._lines.values() for waiting in line)
        self._lines.clear()
        return found


class OutputQueue:
    """Messages to a client, in order; a full one loses its oldest syncPointProgress, or else its oldest message."""

    def __init__(self, most: int) -> None:
        """Begins empty, for so many messages at most."""
        self._most, self._lost, self._ended = most, 0, False
        self._messages: deque[str] = deque()
        self._news = Event()

    def __len__(self) -> int:
        return len(self._messages)

    def put(self, message: str) -> None:
        """Adds a message; never waits."""
        if self._ended:
            return
        if len(self._messages) == self._most:
            minor = next((k for k, each in enumerate(self._messages) if each.startswith(MINOR)), 0)
            del self._messages[minor]
            self._lost += 1
        self._messages.append(message)
        self._news.set()

    def end(self) -> None:
        """Takes no further message; what is here may still be taken."""
        self._ended = True
        self._news.set()

    async def take(self) -> str | None:
        """Waits for the next message; None when there will be none.

        After messages were lost the first one says how many.
        """
        while not self._messages:
            if self._ended:
                return None
            self._news.clear()
            await self._news.wait()
        if self._lost:
            lost, self._lost = self._lost, 0
            text = f"rule unread: {lost} messages were dropped, because they were not read in time"
            return warning(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, NOBODY, text))
        return self._messages.popleft()
