"""Pending feedback of the loop, and a record of sent messages.

A message is identified by its key, whatever its time. The planner may change the agenda that it proposed last, except
for messages that were sent. Messages that it has said are final.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from operator import attrgetter

from kinesic.realizer.feedback import FeedbackKey, Progress, ScheduledFeedback


class FeedbackQueue:
    """Messages in order of time, each sent once at most."""

    def __init__(self) -> None:
        """Create an empty queue."""
        self.messages: list[ScheduledFeedback] = []  # in order of time; replaced whole, so that any thread may read it
        self.runs = 0  # number of the last running block that was proposed
        self._agenda: set[FeedbackKey] = set()  # that the planner proposed last, sent or not
        self._sent: set[FeedbackKey] = set()  # since then
        self._points: set[FeedbackKey] = set()  # those of them that are no texts
        self._latest = -inf  # [s] time of the last point that was sent

    def propose(self, said: Sequence[ScheduledFeedback], agenda: Sequence[ScheduledFeedback]) -> bool:
        """Accept proposed feedback unless it contradicts sent messages.

        Args:
            said: final messages.
            agenda: messages that a later proposal contains again, maybe at another time, or withdraws.

        Returns:
            False, and nothing changes, if a point that was sent is withdrawn, or a point would come out of order.
        """
        proposed = {message.key: message for message in (*said, *agenda)}
        if not self._points & self._agenda <= proposed.keys():
            return False
        final = [message for message in self.messages if message.key not in self._agenda]
        excluded = self._sent | {message.key for message in final}
        fresh = [message for key, message in proposed.items() if key not in excluded]
        waiting = {message.key: message.time for message in self.messages}
        for message in fresh:
            comes_before_sent = message.time < self._latest and waiting.get(message.key) != message.time
            if comes_before_sent and isinstance(message.content, Progress):
                return False
        self._agenda = {message.key for message in agenda}
        self._sent &= self._agenda
        self._points &= self._agenda
        self.messages = sorted((*final, *fresh), key=attrgetter("time"))
        points = (message.content for message in agenda)
        self.runs = max(self.runs, *(point.run for point in points if isinstance(point, Progress)), 0)
        return True

    def hand_over(self, known: Sequence[ScheduledFeedback]) -> None:
        """Let a new planner change only the messages of its initial agenda."""
        self._agenda = {message.key for message in known}

    def due(self, now: float) -> ScheduledFeedback | None:
        """Return the next message if it is due."""
        return self.messages[0] if self.messages and self.messages[0].time <= now else None

    def sent(self) -> ScheduledFeedback:
        """Remove the next message and record it as sent."""
        message, *self.messages = self.messages
        self._sent.add(message.key)
        if isinstance(message.content, Progress):
            self._points.add(message.key)
            self._latest = max(self._latest, message.time)
        return message

    def halt(self, time: float) -> None:
        """Withdraw all points after an emergency stop at a time [s].

        Blocks that have begun end at that time, interrupted.
                The planner revokes a block whose start it may still withdraw; a start that it has said comes at once.
        """
        later = [message for message in self.messages if message.block is not None and message.time > time]
        starts = [message for message in later if message.is_block_start]
        said = [replace(message, time=time) for message in starts if message.key not in self._agenda]
        revoked = {message.key[0] for message in starts if message.key in self._agenda}
        ends = [
            message.interrupted_at(time) for message in later if message.is_block_end and message.key[0] not in revoked
        ]
        self._agenda -= {message.key for message in ends}
        left = [message for message in self.messages if message not in later]
        self.messages = sorted((*left, *said, *ends), key=attrgetter("time"))
