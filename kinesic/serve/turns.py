"""Whose block is planned next: each client in turn, so that nobody waits behind somebody else's heap."""

from collections import deque
from dataclasses import dataclass


@dataclass(frozen=True)
class Waiting:
    """A document that waits to be planned."""

    text: bytes
    sender: int
    source: str  # how messages call it


class Turns:
    """Documents by sender, in the order in which each sent them."""

    def __init__(self, most: int) -> None:
        """For so many documents of each sender."""
        self._most = most
        self._lines: dict[int, deque[Waiting]] = {}  # the sender whose turn it is first

    def __len__(self) -> int:
        return sum(map(len, self._lines.values()))

    def __contains__(self, sender: int) -> bool:
        return sender in self._lines

    def add(self, waiting: Waiting) -> bool:
        """Adds a document; False, and nothing happens, when too many of this sender's wait."""
        line = self._lines.setdefault(waiting.sender, deque())
        if len(line) >= self._most:
            return False
        line.append(waiting)
        return True

    def next(self) -> Waiting | None:
        """Takes the document whose turn it is."""
        if not self._lines:
            return None
        sender = next(iter(self._lines))
        line = self._lines.pop(sender)
        found = line.popleft()
        if line:
            self._lines[sender] = line  # behind the others
        return found

    def clear(self) -> tuple[Waiting, ...]:
        """Takes all documents."""
        found = tuple(waiting for line in self._lines.values() for waiting in line)
        self._lines.clear()
        return found
