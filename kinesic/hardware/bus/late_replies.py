"""Answers that did not come in their cycle, and may come in a later one.

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


class LateReplies:
    """What one bus still waits for."""

    def __init__(self, gate: PlausibilityFilter, listener: Listener) -> None:
        """Nothing yet."""
        self._gate, self._listener = gate, listener
        self._until = -inf  # [s] when nothing more will come
        self._unfinished: tuple[Query, Place, bytes, float] | None = None  # its answer so far; when it was asked
        self._set_aside = False  # whether this cycle brought what seems to be older
        self._seeming = 0  # cycles in a row that brought nothing else, see STUCK

    @property
    def in_doubt(self) -> bool:
        """Whether a cycle without a question should tell if answers are really late."""
        return self._seeming >= STUCK

    def missed(self, question: Query) -> None:
        """What was asked last has not been answered in full."""
        self._until = self._listener.asked + self._listener.spoken(question.length) + OWED

    def is_of_earlier(self, question: Query, places: Place, answer: ServoReplies) -> bool:
        """Whether a whole answer is one to an earlier question; then what is news of it is believed."""
        listener, gate, asked = self._listener, self._gate, self._listener.asked
        if not answer.whole or asked > self._until:
            return False
        asked_of = np.arange(len(gate.blocks))[places].tolist()
        leeway = LAG + listener.spoken(question.length)
        late = [gate.is_late(k, block, asked, leeway=leeway) for k, block in zip(asked_of, answer.blocks, strict=True)]
        if not listener.early and 2 * sum(late) <= len(late):
            return False
        self._set_aside = self._set_aside or not listener.early
        gate.admit_late(places, answer, asked)
        return True

    def without_earlier(self, question: Query, places: Place, answer: ServoReplies) -> ServoReplies:
        """An answer less what of a broken one belongs to an earlier question."""
        listener = self._listener
        if answer.whole or listener.asked > self._until:
            return answer
        leeway = LAG + listener.spoken(question.length)
        return self._gate.without_late(places, answer, listener.asked, leeway=leeway)

    def keep(self, question: Query, places: Place, *, asked: float, whole: bool) -> None:
        """The cycle is over; unless the answer to what was asked [s] was whole, the rest may still come."""
        self._unfinished = None if whole else (question, places, self._listener.heard, asked)
        self._set_aside = False

    def catch_up(self, more: bytes, time: float) -> None:
        """What comes after its cycle may still complete its answer.

        Args:
            more: what has come.
            time: [s] by when.
        """
        if self._unfinished is None or not more:
            return
        question, places, heard, asked = self._unfinished
        answer = question.answer(heard + more)
        if answer.found.any():
            self._gate.admit_late(places, answer, time, asked=asked)
        if answer.whole:
            self._listener.slack.took(MOST)
        self._unfinished = None if answer.whole else (question, places, heard + more, asked)

    def note(self, *, fresh: bool) -> None:
        """Everybody has been asked, and something fresh has come or not."""
        self._seeming = 0 if fresh else self._seeming + self._set_aside

    def overhear(self, question: Query, places: Place, end: float) -> None:
        """Listens until `end` [s] without having asked: what comes is late, else the clocks have moved apart."""
        raw = b""
        while chunk := self._listener.wire.read(end):
            raw += chunk
        answer = question.answer(raw)
        if answer.found.any():
            self._gate.admit_late(places, answer, self._listener.wire.now())
            self._seeming = -SETTLED
        else:
            self._gate.distrust_clocks()
            self._seeming = 0
