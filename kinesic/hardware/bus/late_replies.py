"""Keeps track of answers that did not come in their cycle, and may come in a later one.

Protocol 2.0 numbers no answers, so a servo's clock tells which question one answers. When the two clocks have moved
apart, since a host stood still or a servo started anew, every answer seems to be an earlier one. What tells is a
cycle in which nothing is asked: only what is really overdue comes in it.
"""

from math import inf

import numpy as np

from kinesic.hardware.bus.listener import MOST, Listener
from kinesic.hardware.bus.plausibility import Place, PlausibilityFilter
from kinesic.hardware.bus.query import Query, ServoReplies

LAG = 0.004  # [s] beyond its own time by which an answer is clearly older than the question
OWED = 0.05  # [s] beyond its own time during which an answer that did not come may still come
STUCK = 2  # cycles in a row that brought nothing but what seems to be older, before one without a question
SETTLED = 100  # cycles without another such trial, when answers proved to be late indeed

_Unfinished = tuple[Query, Place, bytes, float]  # its answer so far; [s] when it was asked


class LateReplies:
    """The answers that one bus still waits for."""

    def __init__(self, believed: PlausibilityFilter, listener: Listener) -> None:
        self._believed, self._listener = believed, listener
        self._until = -inf  # [s] when nothing more will come
        self._unfinished: _Unfinished | None = None
        self._alone: _Unfinished | None = None  # to one servo alone
        self._set_aside = False  # whether this cycle brought what seems to be older
        self._seeming = 0  # cycles in a row that brought nothing else, see STUCK

    @property
    def in_doubt(self) -> bool:
        """Whether a cycle without a question should find out if answers are really late."""
        return self._seeming >= STUCK

    @property
    def open(self) -> bool:
        """Whether the answer to an earlier question than the last may still come."""
        return self._listener.sent_at <= self._until

    def missed(self, question: Query) -> None:
        """Notes that what was asked last has not been answered in full."""
        self._until = self._listener.sent_at + self._listener.spoken(question.length) + OWED

    def is_of_earlier(self, question: Query, places: Place, answer: ServoReplies) -> bool:
        """Checks whether a whole answer belongs to an earlier question, and admits its new records if it does."""
        listener, believed, sent_at = self._listener, self._believed, self._listener.sent_at
        if not answer.whole or not self.open:
            return False
        places_of = np.arange(len(believed.blocks))[places].tolist()
        leeway = LAG + listener.spoken(question.length)
        late = [
            believed.is_late(k, block, sent_at, leeway=leeway)
            for k, block in zip(places_of, answer.blocks, strict=True)
        ]
        if not listener.early and 2 * sum(late) <= len(late):
            return False
        self._set_aside = self._set_aside or not listener.early
        believed.admit_late(places, answer, sent_at)
        return True

    def without_earlier(self, question: Query, places: Place, answer: ServoReplies) -> ServoReplies:
        """Returns a broken answer without the records that belong to an earlier question."""
        listener = self._listener
        if answer.whole or not self.open:
            return answer
        leeway = LAG + listener.spoken(question.length)
        return self._believed.without_late(places, answer, listener.sent_at, leeway=leeway)

    def keep(self, question: Query, places: Place, *, sent_at: float, whole: bool) -> None:
        """Ends a cycle: unless the answer to the question of a time [s] was whole, its rest is still expected."""
        self._unfinished = None if whole else (question, places, self._listener.received, sent_at)
        self._set_aside = False

    def keep_alone(self, question: Query, places: Place, *, sent_at: float) -> None:
        """Expect the late answer of one servo, queried at a time [s]."""
        self._alone = (question, places, b"", sent_at)

    def catch_up(self, more: bytes, time: float) -> None:
        """Complete earlier answers with bytes that came after their cycle.

        Args:
            more: what has come.
            time: [s] by when.
        """
        if self._unfinished is not None and more:
            self._unfinished = self._completed(self._unfinished, more, time)
            if self._unfinished is None:
                self._listener.slack.took(MOST)
        if self._alone is not None and more:
            self._alone = self._completed(self._alone, more, time)

    def _completed(self, earlier: "_Unfinished", more: bytes, time: float) -> "_Unfinished | None":
        """Admit an earlier answer with more bytes, and return it if unfinished."""
        question, places, received, sent_at = earlier
        answer = question.answer(received + more)
        self._believed.admit_late(places, answer, time, sent_at=sent_at)
        return None if answer.whole else (question, places, received + more, sent_at)

    def note(self, *, fresh: bool) -> None:
        """Notes whether something fresh has come after all servos were asked."""
        self._seeming = 0 if fresh else self._seeming + self._set_aside

    def listen_for_late(self, question: Query, places: Place, end: float) -> None:
        """Listens until `end` [s] without a question: data are late answers, silence means that the clocks drifted."""
        raw = b""
        while chunk := self._listener.wire.read(end):
            raw += chunk
        answer = question.answer(raw)
        if answer.found.any():
            self._believed.admit_late(places, answer, self._listener.wire.now())
            self._seeming = -SETTLED
        else:
            self._believed.distrust_clocks()
            self._seeming = 0
