"""Input and output queues of the server's clients.

Documents are planned in turns between clients, and unread messages are bounded, so that neither a flood of documents
nor a slow reader affects other clients.
"""

from asyncio import Event
from collections import deque
from dataclasses import replace
from sys import getsizeof

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.feedback import write_warning
from kinesic.realizer.request import Message
from kinesic.serve.messages import Words
from kinesic.serve.wire.quotas import UNKNOWN_ID

MAX_TEXT_LENGTH = 1_000_000  # [characters] longest text of one client that may wait to be spoken
PROGRESS_PREFIX = "<syncPointProgress"  # beginning of messages that a full queue drops first


def join_words(earlier: Message, later: Message) -> Words | None:
    """Return two successive pieces of streamed text as one, if possible.

    Return None if one is a document, their styles differ, the earlier one ends its text, the later one replaces it, or
    the result is too long.
    """
    if not (isinstance(earlier, Words) and isinstance(later, Words)) or later.style != earlier.style:
        return None
    if earlier.ends or later.instead:
        return None
    text = f"{_text(earlier)}{_text(later)}"
    return replace(earlier, text=text, ends=later.ends) if len(text) <= MAX_TEXT_LENGTH else None


def _text(message: Message) -> str:
    return message.text if isinstance(message.text, str) else message.text.decode(errors="replace")


class FairQueue:
    """Document queue in which clients take turns, each first-in, first-out."""

    def __init__(self, max_count: int) -> None:
        """Create an empty queue with a maximum number of documents per client."""
        self._max_count = max_count
        self._queues: dict[int, deque[Message]] = {}  # in turn order

    def __len__(self) -> int:
        return sum(map(len, self._queues.values()))

    def __contains__(self, sender: int) -> bool:
        return sender in self._queues

    def add(self, document: Message) -> bool:
        """Add a document, or return False if the client's queue is full.

        Streamed text is joined with queued text where possible.
        """
        queue = self._queues.setdefault(document.sender, deque())
        joined = join_words(queue[-1], document) if queue else None
        if joined is not None:
            queue[-1] = joined
            return True
        if len(queue) >= self._max_count:
            return False
        queue.append(document)
        return True

    def next(self) -> Message | None:
        """Remove and return the next document, or None."""
        if not self._queues:
            return None
        sender = next(iter(self._queues))
        queue = self._queues.pop(sender)
        result = queue.popleft()
        if queue:
            self._queues[sender] = queue  # back of the turn order
        return result

    def clear(self) -> tuple[Message, ...]:
        """Remove and return all documents."""
        result = tuple(document for queue in self._queues.values() for document in queue)
        self._queues.clear()
        return result


class UnreadMemory:
    """Memory limit for the unread messages of all clients.

    When it is exceeded, the client with most unread bytes loses its oldest messages.
    """

    def __init__(self, max_bytes: int) -> None:
        """Create an empty memory account with a limit in bytes."""
        self._max_bytes = max_bytes
        self._queues: set[OutputQueue] = set()  # queues with messages
        self.bytes = 0  # reserved

    def take(self, queue: "OutputQueue", size: int) -> None:
        """Reserve memory for a message in a queue.

        Drop old messages of the largest queues if necessary.
        """
        while self._queues and self.bytes + size > self._max_bytes:
            max(self._queues, key=lambda candidate: candidate.bytes).drop()
        self._queues.add(queue)
        self.bytes += size

    def release(self, queue: "OutputQueue", size: int) -> None:
        """Release the memory of messages removed from a queue."""
        self.bytes -= size
        if not queue:
            self._queues.discard(queue)


class OutputQueue:
    """Queue of messages to one client.

    A full queue drops its oldest syncPointProgress or, without one, its oldest message.
    """

    def __init__(self, max_count: int, max_bytes: int, memory: UnreadMemory) -> None:
        """Create an empty queue.

        Args:
            max_count: maximum number of messages.
            max_bytes: maximum memory, except for a single larger message.
            memory: account shared by the queues of all clients.
        """
        self._max_count, self._max_bytes, self._lost, self._ended = max_count, max_bytes, 0, False
        self.bytes = 0
        self._memory = memory
        self._messages: deque[str] = deque()
        self._news = Event()

    def __len__(self) -> int:
        return len(self._messages)

    def put(self, message: str) -> None:
        """Add a message, dropping old ones if the queue is full.

        This never blocks. After `end`, messages are ignored.
        """
        if self._ended:
            return
        size = getsizeof(message)
        while self._messages and (len(self._messages) == self._max_count or self.bytes + size > self._max_bytes):
            self.drop()
        self._memory.take(self, size)
        self._messages.append(message)
        self.bytes += size
        self._news.set()

    def drop(self) -> None:
        """Drop the oldest syncPointProgress or, without one, the oldest message."""
        self._remove(next((k for k, message in enumerate(self._messages) if message.startswith(PROGRESS_PREFIX)), 0))
        self._lost += 1

    def end(self) -> None:
        """Accept no further messages.

        Queued ones can still be taken.
        """
        self._ended = True
        self._news.set()

    def discard(self) -> None:
        """End the queue and drop all unread messages."""
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
        """Wait for the next message, or return None after the queue's end.

        After a loss, the first message reports the number of dropped messages.
        """
        while not self._messages and not self._lost:
            if self._ended:
                return None
            self._news.clear()
            await self._news.wait()
        if self._lost:
            lost, self._lost = self._lost, 0
            text = f"rule unread: {lost} messages were dropped, because they were not read in time"
            return write_warning(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, UNKNOWN_ID, text))
        return self._remove(0)
