"""Tells clients again and again how the robot is: all of them together so often that nobody else waits for it."""

from asyncio import Task, create_task, sleep
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic

from msgspec.structs import asdict

from kinesic.serve.desk.asker import Asker
from kinesic.serve.messages import BodyReport
from kinesic.serve.wire.protocol import json_answer

MOST_RATE = 50.0  # [Hz] at which a client may watch
MOST_REPORTS = 500.0  # [1/s] to all clients
PAUSE = 0.005  # [s] between two looks at the robot


@dataclass(eq=False)
class _Watch:
    """One client that watches."""

    asker: Asker
    period: float  # [s]
    next: float  # [s] of the machine's monotonic clock


class Watches:
    """Who watches the robot, and how often; one task looks at it for all of them."""

    def __init__(self, look: Callable[[], BodyReport]) -> None:
        """Begins with nobody.

        Args:
            look: says how the robot is.
        """
        self._look = look
        self._watches: dict[int, _Watch] = {}  # by client
        self._task: Task[None] | None = None

    def set(self, asker: Asker, rate: float) -> None:
        """Has a client watch at a rate [Hz] from now on; 0: no longer."""
        if rate <= 0.0:
            self._watches.pop(asker.number, None)
            return
        self._watches[asker.number] = _Watch(asker, 1.0 / min(rate, MOST_RATE), monotonic())
        if self._task is None or self._task.done():
            self._task = create_task(self._report())

    def close(self) -> None:
        """Tells nobody any more."""
        if self._task is not None:
            self._task.cancel()

    async def _report(self) -> None:
        while self._watches:
            self._tell(monotonic())
            earliest = min((watch.next for watch in self._watches.values()), default=0.0)
            await sleep(max(PAUSE, earliest - monotonic()))

    def _tell(self, now: float) -> None:
        due = [watch for watch in self._watches.values() if watch.next <= now]
        message = json_answer("body", **asdict(self._look())) if due else ""
        least = len(self._watches) / MOST_REPORTS
        for watch in due:
            if not watch.asker.is_there():
                del self._watches[watch.asker.number]
                continue
            watch.asker.send(message)
            watch.next = max(watch.next + max(watch.period, least), now)
