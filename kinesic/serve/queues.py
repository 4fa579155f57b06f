"""Queues of clients: documents are planned in turns, and what a client has still to read is bounded.

So nobody waits behind somebody else's heap, and a slow reader costs nobody else anything.
"""

from asyncio import Event
from collections import deque
from sys import getsizeof

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.feedback import warning
from kinesic.realizer.request import Message
from kinesic.serve.wire.quotas import NOBODY

MINOR = "<syncPointProgress"  # what such a message begins with


class FairQueue:
    """Documents that wait: senders take turns, each with its oldest first."""

    def __init__(self, most: int) -> None:
        """Begins empty, for so many documents of each sender."""
        self._most = most
        self._lines: dict[int, deque[Message]] = {}  # the sender whose turn it is first

    def __len__(self) -> int:
        return sum(map(len, self._lines.values()))

    def __contains__(self, sender: int) -> bool:
        return sender in self._lines

    def add(self, document: Message) -> bool:
        """Adds a document; False where too many of this sender's wait."""
        line = self._lines.setdefault(document.sender, deque())
        if len(line) >= self._most:
            return False
        line.append(document)
        return True

    def next(self) -> Message | None:
        """Takes the document whose turn it is; None where none waits."""
        if not self._lines:
            return None
        sender = next(iter(self._lines))
        line = self._lines.pop(sender)
        found = line.popleft()
        if line:
            self._lines[sender] = line  # behind the others
        return found

    def clear(self) -> tuple[Message, ...]:
        """Takes all documents."""
        found = tuple(document for line in self._lines.values() for document in line)
        self._lines.clear()
        return found


class OutputQueue:
    """Messages to a client, in order; a full one loses its oldest syncPointProgress, or else its oldest message."""

    def __init__(self, most: int, most_bytes: int) -> None:
        """Begins empty, for so many messages at most, or one that takes more bytes of memory than they may."""
        self._most, self._most_bytes, self._lost, self._ended = most, most_bytes, 0, False
        self._bytes = 0
        self._messages: deque[str] = deque()
        self._news = Event()

    def __len__(self) -> int:
        return len(self._messages)

    def put(self, message: str) -> None:
        """Adds a message; never waits."""
        if self._ended:
            return
        size = getsizeof(message)
        while self._messages and (len(self._messages) == self._most or self._bytes + size > self._most_bytes):
            minor = next((k for k, each in enumerate(self._messages) if each.startswith(MINOR)), 0)
            self._bytes -= getsizeof(self._messages[minor])
            del self._messages[minor]
            self._lost += 1
        self._messages.append(message)
        self._bytes += size
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
        message = self._messages.popleft()
        self._bytes -= getsizeof(message)
        return message
