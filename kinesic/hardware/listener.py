"""Sends a question and waits for its answer, as long as it may still come and no longer."""

from dataclasses import dataclass
from math import inf, isfinite

from kinesic.hardware.packet import STATUS_OVERHEAD, Instruction, Reader
from kinesic.hardware.question import Answer, Question
from kinesic.hardware.slack import LEAST, Slack
from kinesic.hardware.wire import BITS_PER_BYTE, Wire

BURST = 62  # [bytes] that USB adapters hand over at once
GAP = 0.0003  # [s] by which an answer may pause beyond the usual
RESTLESS = 50  # answers after a damaged one


class Listener:
    """One wire, and what experience says about it.

    While all is well it sleeps until the last byte of an answer must have come. For a while after a damaged answer it
    looks at every burst, so that one which breaks off is noticed at once.
    """

    def __init__(self, wire: Wire) -> None:
        """Knows nothing yet."""
        self.wire, self.slack = wire, Slack()
        self.heard = b""  # all bytes since `forget`
        self._byte = BITS_PER_BYTE / wire.baud
        self.asked = 0.0  # [s] when the last byte of what was said last is out
        self._restless = 0
        self._rest = b""  # what came behind the last whole answer
        self.mute = False  # whether nothing came when it listened last
        self.early = False  # whether the last whole answer came before its bytes could

    def spoken(self, octets: int) -> float:
        """[s] that so many bytes are on the wire."""
        return octets * self._byte

    def forget(self) -> None:
        """What was heard so far belongs to nothing that is asked from now on."""
        self.heard = b""

    def say(self, data: bytes) -> None:
        """Sends.

        Raises:
            BusError: the port is gone.
        """
        self.wire.write(data)
        self.asked = self.wire.now() + self.spoken(len(data))

    def hear(
        self, question: Question, *, end: float, strict: bool = False, patient: bool = False, again: bool = False
    ) -> Answer | None:
        """Waits for the answer to what was said last.

        Args:
            question: that was asked.
            end: [s] when waiting should end.
            strict: whether it must; else an answer that may come in time by its bytes is waited for.
            patient: whether to wait until then, since an earlier answer is still to come and holds up this one.
            again: whether the answer just heard was an earlier one, and what came behind it may be the beginning.

        Returns:
            The answer; None if nothing came.

        Raises:
            BusError: the port is gone.
        """
        wait = self._wait(question, end, strict=strict, patient=patient)
        ideal = wait.ideal
        raw, self._rest = self._rest if again else b"", b""
        begun, limit = self._begun(wait)
        raw += begun
        if begun:
            limit = wait.until(self.wire.now(), len(raw))
        while True:
            if len(raw) >= question.length or question.complete(raw):
                answer = question.answer(raw)
                if answer.whole:
                    self._understood(raw, answer, ideal)
                    return answer
                if not patient and (len(raw) >= answer.end or question.complete(raw)):
                    break
                if wait.longer(answer.end):
                    limit = wait.until(self.wire.now(), len(raw))
            chunk = self.wire.read(limit)
            if not chunk:
                break
            raw += chunk
            wait.came(self.wire.now(), len(raw), len(chunk))
            limit = wait.until(self.wire.now(), len(raw))
        self._restless = RESTLESS
        self.heard += raw
        self.mute = not raw
        return question.answer(raw) if raw else None

    def _wait(self, question: Question, end: float, *, strict: bool, patient: bool) -> "_Wait":
        """How long to wait for what was said last; see `hear`."""
        usual, ideal = self.slack.usual, self.asked + self.spoken(question.length)
        last = end if patient else min(ideal + self.slack.wait, end)
        if not strict:
            last = max(last, ideal + LEAST)
        # what breaks off could be asked again within the cycle, but not after the time of the whole
        tight = question.chained and ideal + usual <= end < ideal + self.spoken(question.length) + usual
        return _Wait(self.asked, self._byte, question.length, usual, last, max(last, end), patient, tight)

    def _begun(self, wait: "_Wait") -> tuple[bytes, float]:
        """Sleeps while nothing can be missed; what has come by then, and until when more may come [s]."""
        wire, due = self.wire, self.asked + self.spoken(BURST) + self.slack.wait
        if (self._restless or wait.tight) and not wait.patient:
            return b"", wait.until(self.asked, 0)
        if wait.patient or due >= wait.ideal:
            wire.sleep(wait.ideal)
            return b"", wait.last
        begun = wire.read(due)  # a long answer must have begun by now, or it is time to ask again
        if not begun:
            return b"", due
        wire.sleep(wait.ideal)
        return begun + wire.read(wait.ideal), wait.last

    def _understood(self, raw: bytes, answer: Answer, ideal: float) -> None:
        """Learns from a whole answer, whose bytes could not have been there before `ideal` [s]."""
        now = self.wire.now()
        self.slack.took(now - ideal)
        self._restless = max(0, self._restless - 1)
        self.heard += raw
        self._rest, self.mute, self.early = raw[answer.end :], False, now < ideal

    def exchange(self, data: bytes, servo: int, size: int) -> bytes | None:
        """One packet to one servo, and the data of its status; None when it does not come in time.

        Raises:
            BusError: the port is gone.
        """
        self.say(data)
        limit = self.asked + self.spoken(STATUS_OVERHEAD + size) + self.slack.wait
        reader = Reader()
        while chunk := self.wire.read(limit):
            for status in reader.feed(chunk):
                if (status.id, status.instruction, len(status.data)) == (servo, Instruction.STATUS, size):
                    return status.data
        return None


@dataclass
class _Wait:
    """How long an answer is waited for: what breaks off falls behind the bytes that the wire could have brought."""

    asked: float  # [s] when the question is out
    byte: float  # [s]
    length: int  # [bytes] of the answer
    usual: float  # [s] that its last bytes stay in the adapter
    last: float  # [s] when waiting ends
    end: float  # [s] when it ends at the latest
    patient: bool  # whatever the gaps
    tight: bool  # whether a broken one must be noticed at once
    behind: float = inf  # [s] by which the answer has been late at least

    @property
    def ideal(self) -> float:
        """[s] when its last byte is out."""
        return self.asked + self.byte * self.length

    def came(self, now: float, octets: int, news: int) -> None:
        """Bytes have come; so many are here, and so many are new: fewer than a burst have stayed in the adapter."""
        stayed = self.usual if news < BURST else 0.0
        self.behind = max(0.0, min(self.behind, now - self.asked - self.byte * octets - stayed))

    def until(self, now: float, octets: int) -> float:
        """Until when more may come [s], when so many bytes are here."""
        lacking, burst = self.length - octets, self.byte * BURST
        if self.patient:
            return self.last
        if not self.tight:
            # what is neither here nor in the adapter when all of it must be out never was
            gap = burst + self.usual + GAP
            return now if now >= self.ideal and self.byte * lacking > gap else min(self.last, now + gap)
        pause = self.byte * lacking + self.usual if lacking < BURST else max(burst, self.usual)
        behind = self.behind if isfinite(self.behind) else 0.0
        return min(self.asked + behind + self.byte * octets + pause + GAP, self.last)

    def longer(self, length: int) -> bool:
        """Whether bytes were added to the answer, so that its end comes later."""
        added = length > self.length
        if added:
            self.length, self.last = length, self.end
        return added
