"""Queues of clients: documents are planned in turns, and what a client has still to read is bounded.

So nobody waits behind somebody else's heap, and a slow reader costs nobody else anything.
"""

from asyncio import Event
from collections import deque
from dataclasses import replace
from sys import getsizeof

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.feedback import warning
from kinesic.realizer.request import Message
from kinesic.serve.messages import Words
from kinesic.serve.wire.quotas import NOBODY

MOST_TEXT = 100_000  # letters of words that are joined
MINOR = "<syncPointProgress"  # what such a message begins with


def join_words(earlier: Message, later: Message) -> Words | None:
    """Joins words that wait with those that follow them; None where they are not to be joined."""
    if not (isinstance(earlier, Words) and isinstance(later, Words)) or earlier.ends or later.instead:
        return None
    text = f"{_text(earlier)}{_text(later)}"
    return replace(earlier, text=text, ends=later.ends) if len(text) <= MOST_TEXT else None


def _text(message: Message) -> str:
    return message.text if isinstance(message.text, str) else message.text.decode(errors="replace")


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
        joined = join_words(line[-1], document) if line else None
        if joined is not None:
            line[-1] = joined
            return True
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


class UnreadMemory:
    """Bounds the memory that the messages of all clients take: whoever has most to read loses the oldest of it."""

    def __init__(self, most_bytes: int) -> None:
        """Begins empty, for so many bytes."""
        self._most_bytes = most_bytes
        self._queues: set[OutputQueue] = set()  # that hold messages
        self.bytes = 0  # that are taken

    def take(self, queue: "OutputQueue", size: int) -> None:
        """Counts so many bytes more of a queue; others or itself may lose messages for that, unless all are lost."""
        while self._queues and self.bytes + size > self._most_bytes:
            max(self._queues, key=lambda each: each.bytes).drop()
        self._queues.add(queue)
        self.bytes += size

    def release(self, queue: "OutputQueue", size: int) -> None:
        """Counts so many bytes of a queue no longer; call it after they are gone."""
        self.bytes -= size
        if not queue:
            self._queues.discard(queue)


class OutputQueue:
    """Messages to a client, in order; a full one loses its oldest syncPointProgress, or else its oldest message."""

    def __init__(self, most: int, most_bytes: int, memory: UnreadMemory) -> None:
        """Begins empty.

        Args:
            most: messages.
            most_bytes: of memory that they take, unless a single one takes more.
            memory: that the queues of all clients share.
        """
        self._most, self._most_bytes, self._lost, self._ended = most, most_bytes, 0, False
        self.bytes = 0
        self._memory = memory
        self._messages: deque[str] = deque()
        self._news = Event()

    def __len__(self) -> int:
        return len(self._messages)

    def put(self, message: str) -> None:
        """Adds a message; never waits."""
        if self._ended:
            return
        size = getsizeof(message)
        while self._messages and (len(self._messages) == self._most or self.bytes + size > self._most_bytes):
            self.drop()
        self._memory.take(self, size)
        self._messages.append(message)
        self.bytes += size
        self._news.set()

    def drop(self) -> None:
        """Loses the oldest syncPointProgress, or else the oldest message."""
        self._remove(next((k for k, each in enumerate(self._messages) if each.startswith(MINOR)), 0))
        self._lost += 1

    def end(self) -> None:
        """Takes no further message; what is here may still be taken."""
        self._ended = True
        self._news.set()

    def discard(self) -> None:
        """Ends it, and forgets what nobody will read."""
        while self._messages:
            self._remove(0)
        self.end()

    def _remove(self, index: int) -> str:
        message = self._messages[index]
        del self._messages[index]
        size = getsizeof(message)
        self.bytes -= size
        self._memory.release(self, size)
        return message

    async def take(self) -> str | None:
        """Waits for the next message; None when there will be none.

        After messages were lost the first one says how many.
        """
        while not self._messages and not self._lost:
            if self._ended:
                return None
            self._news.clear()
            await self._news.wait()
        if self._lost:
            lost, self._lost = self._lost, 0
            text = f"rule unread: {lost} messages were dropped, because they were not read in time"
            return warning(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, NOBODY, text))
        return self._remove(0)
