"""Pending feedback of the loop, and a record of sent messages.

A message is identified by its key, not by its time. The planner may change the agenda that it proposed last, except for
messages that were sent already. Final messages never change.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from operator import attrgetter

from kinesic.realizer.feedback import FeedbackKey, Progress, ScheduledFeedback


@dataclass(frozen=True)
class PendingBlock:
    """Block that has not ended, with its scheduled times."""

    name: str
    start: float  # [s] clock time of the start; -inf for a block that has begun
    end: float  # [s] clock time of the end

    def status(self, now: float) -> dict[str, object]:
        """Return the name and the seconds until start and end."""
        starts_in, ends_in = (round(max(0.0, time - now), 3) for time in (self.start, self.end))
        return {"block": self.name, "starts_in": starts_in, "ends_in": ends_in}


class FeedbackQueue:
    """Feedback messages sorted by time, each sent at most once."""

    def __init__(self) -> None:
        """Create an empty queue."""
        # Sorted by time; the list is replaced as a whole, so that any thread may read it.
        self.messages: list[ScheduledFeedback] = []
        self.runs = 0  # number of the last proposed running block
        self._agenda: set[FeedbackKey] = set()  # messages of the last proposed agenda, sent or not
        self._sent: set[FeedbackKey] = set()  # messages sent since then
        self._sent_progress: set[FeedbackKey] = set()  # sent progress messages
        self._last_sent_time = -inf  # [s] time of the last progress message sent

    def propose(self, final_feedback: Sequence[ScheduledFeedback], agenda: Sequence[ScheduledFeedback]) -> bool:
        """Accept proposed feedback unless it contradicts sent messages.

        Args:
            final_feedback: messages that later proposals do not repeat.
            agenda: messages that a later proposal repeats, moves to another time or withdraws.

        Returns:
            False, without any change, if the proposal withdraws a sent progress message or adds one before the last
            sent one.
        """
        proposed = {message.key: message for message in (*final_feedback, *agenda)}
        if not self._sent_progress & self._agenda <= proposed.keys():
            return False
        final = [message for message in self.messages if message.key not in self._agenda]
        excluded = self._sent | {message.key for message in final}
        new = [message for key, message in proposed.items() if key not in excluded]
        pending_times = {message.key: message.time for message in self.messages}
        for message in new:
            comes_before_sent = message.time < self._last_sent_time and pending_times.get(message.key) != message.time
            if comes_before_sent and isinstance(message.content, Progress):
                return False
        self._agenda = {message.key for message in agenda}
        self._sent &= self._agenda
        self._sent_progress &= self._agenda
        self.messages = sorted((*final, *new), key=attrgetter("time"))
        points = (message.content for message in agenda)
        self.runs = max(self.runs, *(point.run for point in points if isinstance(point, Progress)), 0)
        return True

    def pending_blocks(self) -> list[PendingBlock]:
        """Return the blocks that have not ended, sorted by end time.

        Any thread may call this.
        """
        messages = self.messages
        starts = {message.key[0]: message.time for message in messages if message.is_block_start}
        return [
            PendingBlock(message.block or "", starts.get(message.key[0], -inf), message.time)
            for message in messages
            if message.is_block_end
        ]

    def hand_over(self, agenda: Sequence[ScheduledFeedback]) -> None:
        """Restrict a new planner's changes to the messages given to it."""
        self._agenda = {message.key for message in agenda}

    def due(self, now: float) -> ScheduledFeedback | None:
        """Return the next message if it is due, otherwise None."""
        return self.messages[0] if self.messages and self.messages[0].time <= now else None

    def sent(self) -> ScheduledFeedback:
        """Remove the next message and record it as sent."""
        message, *self.messages = self.messages
        self._sent.add(message.key)
        if isinstance(message.content, Progress):
            self._sent_progress.add(message.key)
            self._last_sent_time = max(self._last_sent_time, message.time)
        return message

    def halt(self, time: float) -> None:
        """Replace pending progress feedback by block ends at the emergency stop time.

        Blocks that have begun end at that time, as interrupted. A block whose start is not final is left to the
        planner, which revokes it. A final start is moved to that time.
        """
        later = [message for message in self.messages if message.block is not None and message.time > time]
        starts = [message for message in later if message.is_block_start]
        final_starts = [replace(message, time=time) for message in starts if message.key not in self._agenda]
        revoked = {message.key[0] for message in starts if message.key in self._agenda}
        ends = [
            message.interrupted_at(time) for message in later if message.is_block_end and message.key[0] not in revoked
        ]
        self._agenda -= {message.key for message in ends}
        remaining = [message for message in self.messages if message not in later]
        self.messages = sorted((*remaining, *final_starts, *ends), key=attrgetter("time"))
