"""What one client has still to read: bounded, so that a slow reader costs nobody else anything."""

from asyncio import Event
from collections import deque

from kinesic.bml.block import Notice, NoticeType
from kinesic.bml.feedback import warning
from kinesic.serve.quotas import NOBODY

MINOR = "<syncPointProgress"  # what such a message begins with


class Outbox:
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
