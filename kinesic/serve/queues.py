"""Queues of clients: whose block is planned next, each in turn, and what one has still to read, bounded.

So nobody waits behind somebody else's heap, and a slow reader costs nobody else anything.
"""

from asyncio import Event
from collections import deque
from dataclasses import dataclass

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.feedback import warning
from kinesic.serve.quotas import NOBODY

MINOR = "<syncPointProgress"  # what such a message begins with


@dataclass(frozen=True)
class QueuedDocument:
    """A document that waits to be planned."""

    text: bytes
    sender: int
    source: str  # how messages call it


class FairQueue:
    """Documents by sender, in the order in which each sent them."""

    def __init__(self, most: int) -> None:
        """For so many documents of each sender."""
        self._most = most
        self._lines: dict[int, deque[QueuedDocument]] = {}  # the sender whose turn it is first

    def __len__(self) -> int:
        return sum(map(len, self._lines.values()))

    def __contains__(self, sender: int) -> bool:
        return sender in self._lines

    def add(self, waiting: QueuedDocument) -> bool:
        """Adds a document; False, and nothing happens, when too many of this sender's wait."""
        line = self._lines.setdefault(waiting.sender, deque())
        if len(line) >= self._most:
            return False
        line.append(waiting)
        return True

    def next(self) -> QueuedDocument | None:
        """Takes the document whose turn it is."""
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
    """Messages in order. When it is full the oldest syncPointProgress goes, or else the oldest message of all."""

    def __init__(self, most: int) -> None:
        """For so many messages at most."""
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
        """Nothing more will come; what is here may still be taken."""
        self._ended = True
        self._news.set()

    async def take(self) -> str | None:
        """The next message; None when there will be none.

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
