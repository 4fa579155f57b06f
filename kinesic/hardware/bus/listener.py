"""Sends a question and waits for its answer, as long as it may still come and no longer."""

from dataclasses import dataclass
from math import inf, isfinite

from kinesic.hardware.bus.query import Query, ServoReplies
from kinesic.hardware.protocol.packet import STATUS_OVERHEAD, Instruction, Reader
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, Wire

LEAST, MOST = 0.002, 0.020  # [s]
STEP = 50e-6  # [s]
QUANTILE = 0.9
BURST = 62  # [bytes] that USB adapters hand over at once, at most
GAP = 0.0003  # [s] by which an answer may pause beyond the usual
RESTLESS = 10  # answers after a damaged one
FEW = 0.75  # of a burst: fewer bytes were not handed over because there was no room for more
HASTE = 0.05  # of the time between two bursts that one answer may shorten it by


class TimeoutEstimate:
    """How long to wait for an answer beyond what its bytes need on the wire: learnt, as hosts and USB differ.

    A tight fixed timeout fails on a loaded host, a wide one lets every lost answer cost a cycle. So the 90 % quantile
    of what answers took is followed, up by 9 steps for one that took longer, but hardly beyond it, and down by 1 for
    one that did not. One late answer in ten may be missed: it is accepted when it comes.
    """

    def __init__(self, usual: float = 0.0015, *, fall: float = 0.0) -> None:
        """Begins with a guess.

        Args:
            usual: [s] the quantile to begin with.
            fall: share of it by which it may come down at once, where the guess is far too high.
        """
        self._usual, self._fall = usual, fall

    @property
    def wait(self) -> float:
        """[s] to wait beyond the time of the bytes."""
        return min(max(2 * self._usual, LEAST), MOST)

    @property
    def usual(self) -> float:
        """[s] that nine answers in ten took beyond the time of their bytes."""
        return self._usual

    def took(self, excess: float) -> None:
        """Learns from an answer that came some time [s] later than its bytes needed."""
        if excess > self._usual:
            self._usual = min(self._usual + STEP * QUANTILE / (1 - QUANTILE), excess + 2 * STEP, MOST)
        else:
            self._usual = max(self._usual - max(STEP, self._fall * self._usual), 0.0)


class Listener:
    """Waits for answers on one wire, by what experience says about it.

    While all is well it sleeps until the last byte of an answer must have come. For a while after a damaged answer it
    looks at every burst, so that one which breaks off is noticed at once.
    """

    def __init__(self, wire: Wire) -> None:
        self.wire, self.slack = wire, TimeoutEstimate()
        # until the first bytes of an answer come
        self._burst = TimeoutEstimate(BURST * BITS_PER_BYTE / wire.baud, fall=HASTE)
        self.received = b""  # all bytes since `forget`
        self._byte = BITS_PER_BYTE / wire.baud
        self.sent_at = 0.0  # [s] when the last byte of what was said last is out
        self._restless = 0
        self.before = self._rest = b""  # what came before the last whole answer, and behind it
        self.mute = False  # whether nothing came when it listened last
        self.early = False  # whether the last whole answer came before its bytes could
        self.tardy = False  # whether what did not come in time came later, when that happened last

    def spoken(self, octets: int) -> float:
        """Returns how long [s] so many bytes are on the wire."""
        return octets * self._byte

    def forget(self) -> None:
        """Drops what was received so far: it belongs to nothing that is asked from now on."""
        self.received = b""

    def send(self, data: bytes) -> None:
        """Sends.

        Raises:
            BusError: the port is gone.
        """
        self.wire.write(data)
        self.sent_at = self.wire.now() + self.spoken(len(data))

    def receive(
        self, question: Query, *, end: float, strict: bool = False, patient: bool = False, again: bool = False
    ) -> ServoReplies | None:
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
        begun, limit = self._wait_for_begin(wait)
        raw += begun
        if begun:
            limit = wait.until(self.wire.now(), len(raw))
        while True:
            if len(raw) >= question.length or question.complete(raw):
                answer = question.answer(raw)
                if answer.whole:
                    self._learn(raw, answer, question.length, ideal, wait.began)
                    return answer
                if not patient and (len(raw) >= answer.end or question.complete(raw)):
                    break
                if wait.longer(answer.end):
                    limit = wait.until(self.wire.now(), len(raw))
            if wait.tight and raw and not patient:
                self.wire.sleep(min(limit, wait.handed))  # what breaks off is not noticed before anyway
            chunk = self.wire.read(limit)
            if not chunk:
                break
            raw += chunk
            wait.came(self.wire.now(), len(raw), len(chunk))
            limit = wait.until(self.wire.now(), len(raw))
        self._restless = RESTLESS
        self.received += raw
        self.mute = not raw
        return question.answer(raw) if raw else None

    def _wait(self, question: Query, end: float, *, strict: bool, patient: bool) -> "_Wait":
        usual, length = self.slack.usual, self.spoken(question.length)
        again = GAP + self.spoken(len(question.data)) + usual  # [s] of asking again, but for the bytes of the answer
        ideal = self.sent_at + length
        last = end if patient else min(ideal + self.slack.wait, end)
        if not strict:
            last = max(last, ideal + LEAST)
        return _Wait(
            sent_at=self.sent_at,
            byte=self._byte,
            length=question.length,
            usual=usual,
            burst=self._burst.usual,
            last=last,
            end=max(last, end),
            patient=patient,
            tight=question.chained and ideal + usual <= end < ideal + length + usual,
            spare=ideal + length + again <= end,
            tardy=self.tardy or self.mute,
        )

    def _wait_for_begin(self, wait: "_Wait") -> tuple[bytes, float]:
        """Sleeps while nothing can be missed; returns what has come by then, and until when [s] more may come."""
        wire, due = self.wire, self.sent_at + wait.burst + self.slack.wait
        if (self._restless or wait.tight) and not wait.patient:
            return b"", wait.until(self.sent_at, 0)
        if wait.patient or wait.spare or due >= wait.ideal:
            wire.sleep(wait.ideal)
            return b"", wait.last if wait.patient or not wait.spare else wait.mute(due)
        begun = wire.read(wait.mute(due))  # a long answer must have begun by now, or it is time to ask again
        if not begun:
            return b"", wire.now()
        wait.began = wire.now()
        wire.sleep(wait.ideal)
        return begun + wire.read(wait.ideal), wait.last

    def _learn(self, raw: bytes, answer: ServoReplies, length: int, ideal: float, began: float) -> None:
        """Learns from a whole answer of a length [bytes], which began at a time, and was not due before another [s]."""
        now = self.wire.now()
        self.slack.took(now - ideal)
        if self.sent_at <= began < ideal:
            self._burst.took(began - self.sent_at)
        self._restless = max(0, self._restless - 1)
        self.received += raw
        self.before = raw[: max(0, answer.end - length)]
        self._rest, self.mute, self.early = raw[answer.end :], False, now < ideal

    def exchange(self, data: bytes, servo: int, size: int) -> bytes | None:
        """Sends a packet to one servo, and returns the data of its status; None when it does not come in time.

        Raises:
            BusError: the port is gone.
        """
        self.send(data)
        limit = self.sent_at + self.spoken(STATUS_OVERHEAD + size) + self.slack.wait
        reader = Reader()
        while chunk := self.wire.read(limit):
            for status in reader.feed(chunk):
                if (status.id, status.instruction, len(status.data)) == (servo, Instruction.STATUS, size):
                    return status.data
        return None


@dataclass
class _Wait:
    """How long to wait for an answer: one that breaks off falls behind the bytes that the wire could have brought."""

    sent_at: float  # [s] when the question is out
    byte: float  # [s]
    length: int  # [bytes] of the answer
    usual: float  # [s] that its last bytes stay in the adapter
    burst: float  # [s] between two times that the adapter hands bytes over
    last: float  # [s] when waiting ends
    end: float  # [s] when it ends at the latest
    patient: bool  # whatever the gaps
    tight: bool  # whether a broken one must be noticed at once: later than that, it could not be asked for again
    spare: bool  # whether all of it could be asked for again after its own time
    tardy: bool  # whether what does not come is late, rather than lost
    behind: float = inf  # [s] by which the answer has been late at least
    began: float = inf  # [s] when its first bytes came

    @property
    def ideal(self) -> float:
        """[s] when its last byte is out."""
        return self.sent_at + self.byte * self.length

    @property
    def handed(self) -> float:
        """[s] before which its last bytes hardly come out of the adapter."""
        return self.ideal + self.usual / 2

    def came(self, now: float, octets: int, news: int) -> None:
        """Notes that bytes have come: so many are here, and so many new; a few stay in the adapter for its timer."""
        self.began = min(self.began, now)
        stayed = self.usual if news < FEW * self.burst / self.byte else 0.0
        self.behind = max(0.0, min(self.behind, now - self.sent_at - self.byte * octets - stayed))

    def until(self, now: float, octets: int) -> float:
        """Returns until when more may come [s], when so many bytes are here."""
        if self.patient:
            return self.last
        lacking = self.byte * (self.length - octets)
        if self.tight:
            pause = lacking + self.usual if lacking < self.burst else max(self.burst, self.usual)
            behind = self.behind if isfinite(self.behind) else 0.0
            last = min(max(self.last, self.ideal + behind + self.usual + GAP), self.end)
            found = min(self.sent_at + behind + self.byte * octets + pause + GAP, last)
        else:
            # what is neither here nor in the adapter when all of it must be out never was
            gap = self.burst + self.usual + GAP
            found = now if now >= self.ideal and lacking > gap else min(self.last, max(now, self.sent_at) + gap)
        return found if octets else self.mute(found)

    def mute(self, due: float) -> float:
        """Returns until when to wait [s] for an answer that has not begun when it is due [s].

        Asking again while servos speak spoils what they say, which is a loss if it was only late.
        """
        if self.spare:
            return max(due, self.ideal + GAP)
        return self.end if self.tardy else due

    def longer(self, length: int) -> bool:
        """Returns whether bytes were added to the answer, so that its end comes later."""
        added = length > self.length
        if added:
            self.length, self.last = length, self.end
        return added
