"""Periodic telemetry for subscribed clients, with a limited total rate."""

from asyncio import Task, create_task, sleep
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic

from msgspec.structs import asdict

from kinesic.serve.desk.requester import Requester
from kinesic.serve.messages import BodyReport
from kinesic.serve.wire.protocol import json_answer

MAX_WATCH_RATE = 50.0  # [Hz] maximum report rate of one client
MAX_REPORT_RATE = 500.0  # [Hz] maximum report rate of all clients together
MIN_POLL_PERIOD = 0.005  # [s] smallest pause between two rounds of telemetry reports


@dataclass(eq=False)
class _Subscription:
    """Telemetry subscription of one client."""

    requester: Requester
    period: float  # [s] time between two reports
    next: float  # [s] monotonic clock time of the next report


class Watches:
    """Telemetry subscriptions of all clients, served by one task."""

    def __init__(self, report_body: Callable[[], BodyReport]) -> None:
        """Create an empty set of subscriptions.

        Args:
            report_body: returns the current state of the robot.
        """
        self._report_body = report_body
        self._subscriptions: dict[int, _Subscription] = {}  # by client
        self._task: Task[None] | None = None

    def set(self, requester: Requester, rate: float) -> None:
        """Subscribe a client to robot state reports at a rate [Hz].

        0 ends its subscription.
        """
        if rate <= 0.0:
            self._subscriptions.pop(requester.number, None)
            return
        self._subscriptions[requester.number] = _Subscription(requester, 1.0 / min(rate, MAX_WATCH_RATE), monotonic())
        if self._task is None or self._task.done():
            self._task = create_task(self._send_reports())

    def close(self) -> None:
        """End all subscriptions."""
        if self._task is not None:
            self._task.cancel()

    async def _send_reports(self) -> None:
        while self._subscriptions:
            self._send_due(monotonic())
            earliest = min((subscription.next for subscription in self._subscriptions.values()), default=0.0)
            await sleep(max(MIN_POLL_PERIOD, earliest - monotonic()))

    def _send_due(self, now: float) -> None:
        due = [subscription for subscription in self._subscriptions.values() if subscription.next <= now]
        message = json_answer("body", **asdict(self._report_body())) if due else ""
        min_period = len(self._subscriptions) / MAX_REPORT_RATE
        for subscription in due:
            if not subscription.requester.is_there():
                del self._subscriptions[subscription.requester.number]
                continue
            subscription.requester.send(message)
            subscription.next = max(subscription.next + max(subscription.period, min_period), now)
