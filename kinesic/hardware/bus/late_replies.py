"""Replies that miss their cycle and arrive in a later one.

Protocol 2.0 does not number replies, so the servo's clock tells which query a reply answers. If that clock and the
wire's clock have drifted apart, because the host was suspended or a servo rebooted, every reply seems to be an earlier
one. A cycle without a query decides: only replies that are really late arrive in it.
"""

from math import inf

import numpy as np

from kinesic.hardware.bus.listener import TIMEOUT_TUNING, Listener
from kinesic.hardware.bus.plausibility import PlausibilityFilter, ServoSelection
from kinesic.hardware.bus.query import Query, ServoReplies

CLOCK_TOLERANCE = 0.004  # [s] margin over the duration of a reply on the wire; older records answer an earlier query
LATE_REPLY_WINDOW = 0.05  # [s] longest delay of a missing reply after the end of its transmission time
MAX_STALE_CYCLES = 2  # consecutive cycles with only seemingly late records, after which one cycle sends no query
TRIAL_PAUSE = 100  # extra stale cycles before the next cycle without query, if the last one received late replies

_Unfinished = tuple[Query, ServoSelection, bytes, float]  # query, its servos, received bytes, [s] query time


class LateReplies:
    """Handler of replies that arrive after the cycle of their query."""

    def __init__(self, accepted: PlausibilityFilter, listener: Listener) -> None:
        self._accepted, self._listener = accepted, listener
        self._until = -inf  # [s] end of the window for late replies
        self._unfinished: _Unfinished | None = None
        self._alone: _Unfinished | None = None  # query of a single servo
        self._set_aside = False  # whether this cycle brought a seemingly earlier reply
        self._stale_cycles = 0  # number of consecutive cycles with only late records, see MAX_STALE_CYCLES

    @property
    def needs_trial(self) -> bool:
        """Whether the next cycle must omit its query, to detect late replies."""
        return self._stale_cycles >= MAX_STALE_CYCLES

    @property
    def is_open(self) -> bool:
        """Whether the reply to an earlier query may still arrive."""
        return self._listener.sent_at <= self._until

    def note_missed(self, question: Query) -> None:
        """Open the window for late replies after a missing or incomplete reply."""
        self._until = self._listener.sent_at + self._listener.wire_time(question.length) + LATE_REPLY_WINDOW

    def admit_earlier(self, question: Query, places: ServoSelection, answer: ServoReplies) -> bool:
        """Accept a complete reply if it answers an earlier query.

        Returns whether it does.
        """
        listener, accepted, sent_at = self._listener, self._accepted, self._listener.sent_at
        if not answer.whole or not self.is_open:
            return False
        places_of = np.arange(len(accepted.blocks))[places].tolist()
        leeway = CLOCK_TOLERANCE + listener.wire_time(question.length)
        late = [
            accepted.is_late(k, block, sent_at, leeway=leeway)
            for k, block in zip(places_of, answer.blocks, strict=True)
        ]
        if not listener.early and 2 * sum(late) <= len(late):
            return False
        self._set_aside = self._set_aside or not listener.early
        accepted.admit_late(places, answer, sent_at)
        return True

    def remove_earlier(self, question: Query, places: ServoSelection, answer: ServoReplies) -> ServoReplies:
        """Accept records of an earlier query, and return the reply's other records.

        A complete reply is returned unchanged.
        """
        listener = self._listener
        if answer.whole or not self.is_open:
            return answer
        leeway = CLOCK_TOLERANCE + listener.wire_time(question.length)
        return self._accepted.without_late(places, answer, listener.sent_at, leeway=leeway)

    def keep(self, question: Query, places: ServoSelection, *, sent_at: float, whole: bool) -> None:
        """Store an incomplete reply after its cycle for later completion.

        Args:
            question: query of the cycle.
            places: indices of its servos.
            sent_at: [s] when the query was sent.
            whole: whether its reply was complete.
        """
        self._unfinished = None if whole else (question, places, self._listener.received, sent_at)
        self._set_aside = False

    def keep_alone(self, question: Query, places: ServoSelection, *, sent_at: float) -> None:
        """Expect a late reply to the separate query of a silent servo."""
        self._alone = (question, places, b"", sent_at)

    def catch_up(self, more: bytes, time: float) -> None:
        """Complete unfinished replies of earlier cycles with newly received bytes.

        Args:
            more: received bytes.
            time: [s] of their arrival at the latest.
        """
        if self._unfinished is not None and more:
            self._unfinished = self._completed(self._unfinished, more, time)
            if self._unfinished is None:
                self._listener.slack.learn(TIMEOUT_TUNING.max_timeout)
        if self._alone is not None and more:
            self._alone = self._completed(self._alone, more, time)

    def _completed(self, earlier: "_Unfinished", more: bytes, time: float) -> "_Unfinished | None":
        """Append bytes to a late reply, and return None once complete."""
        question, places, received, sent_at = earlier
        answer = question.parse(received + more)
        self._accepted.admit_late(places, answer, time, sent_at=sent_at)
        return None if answer.whole else (question, places, received + more, sent_at)

    def note(self, *, fresh: bool) -> None:
        """Record whether the last query brought any up-to-date record."""
        self._stale_cycles = 0 if fresh else self._stale_cycles + self._set_aside

    def listen_for_late(self, question: Query, places: ServoSelection, end: float) -> None:
        """Listen until `end` [s] without a query, and classify the result.

        Received records are late replies; silence means that the clocks drifted.
        """
        raw = b""
        while chunk := self._listener.wire.read(end):
            raw += chunk
        answer = question.parse(raw)
        if answer.received.any():
            self._accepted.admit_late(places, answer, self._listener.wire.now())
            self._stale_cycles = -TRIAL_PAUSE
        else:
            self._accepted.distrust_clocks()
            self._stale_cycles = 0
