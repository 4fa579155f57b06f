"""Sending of queries, with adaptive timeouts for their replies."""

from dataclasses import dataclass
from math import inf, isfinite

from kinesic.hardware.bus.query import Query, ServoReplies
from kinesic.hardware.protocol.packet import STATUS_OVERHEAD, Instruction, Reader
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, Wire

USB_BURST_SIZE = 62  # [bytes] largest payload that a USB adapter delivers at once


@dataclass(frozen=True)
class TimeoutTuning:
    """Bounds and adaptation rates of the reply timeouts."""

    min_timeout: float = 0.002  # [s] lower bound of the timeout beyond the transmission time
    max_timeout: float = 0.020  # [s] upper bound of the timeout and of its estimate
    quantile_step: float = 50e-6  # [s] decrease of the estimate per reply that came earlier than estimated
    target_quantile: float = 0.9  # fraction of replies that the estimate covers
    max_extra_pause: float = 0.0003  # [s] longest accepted pause inside a reply, beyond the usual delay
    alert_replies: int = 10  # intact replies after a damaged reply until the listener sleeps again while it waits
    full_burst_fraction: float = 0.75  # relative to a full burst; smaller bursts were held back by the adapter's timer
    max_burst_fall: float = 0.05  # largest relative decrease of the burst interval per reply


TIMEOUT_TUNING = TimeoutTuning()  # bounds and rates of the timeouts on every bus


class TimeoutEstimate:
    """Adaptive timeout: twice the running 90 % quantile of reply delays.

    A delay is the time beyond that of the bytes on the wire. A tight fixed timeout fails on a loaded host, and with a
    wide one each lost reply costs a cycle. The estimate rises by 9 steps after a slower reply, but hardly beyond its
    delay, and falls by 1 step after a faster one. A reply that misses the timeout is accepted when it
    arrives.
    """

    def __init__(self, usual: float = 0.0015, *, fall: float = 0.0) -> None:
        """Start with an initial guess of the reply delay [s].

        Args:
            usual: [s] initial quantile.
            fall: largest relative decrease per reply, for a guess that is far too high.
        """
        self._usual, self._fall = usual, fall

    @property
    def wait(self) -> float:
        """Timeout [s] in addition to the transmission time of the bytes."""
        return min(max(2 * self._usual, TIMEOUT_TUNING.min_timeout), TIMEOUT_TUNING.max_timeout)

    @property
    def usual(self) -> float:
        """Estimated 90 % quantile of the reply delay [s]."""
        return self._usual

    def learn(self, excess: float) -> None:
        """Update the quantile estimate with the measured delay of a reply [s]."""
        if excess > self._usual:
            self._usual = min(
                self._usual
                + TIMEOUT_TUNING.quantile_step * TIMEOUT_TUNING.target_quantile / (1 - TIMEOUT_TUNING.target_quantile),
                excess + 2 * TIMEOUT_TUNING.quantile_step,
                TIMEOUT_TUNING.max_timeout,
            )
        else:
            self._usual = max(self._usual - max(TIMEOUT_TUNING.quantile_step, self._fall * self._usual), 0.0)


class Listener:
    """Sender of queries and receiver of replies, with learnt timeouts.

    While all is well it sleeps until the last byte of a reply is due. After a damaged reply it examines every burst for
    a while, so that a truncated reply is noticed at once.
    """

    def __init__(self, wire: Wire) -> None:
        self.wire, self.slack = wire, TimeoutEstimate()
        # time until the first bytes of a reply
        self._burst = TimeoutEstimate(USB_BURST_SIZE * BITS_PER_BYTE / wire.baud, fall=TIMEOUT_TUNING.max_burst_fall)
        self.received = b""  # all bytes since `forget`
        self._byte = BITS_PER_BYTE / wire.baud
        self.sent_at = 0.0  # [s] time at which the last byte of the last packet is transmitted
        self._alert_replies = 0
        self.before = self._rest = b""  # bytes before and after the last complete reply
        self.mute = False  # whether the last query got no reply
        self.early = False  # whether the last complete reply came sooner than its transmission time allows
        self.replies_late = False  # whether the reply that was missed last arrived later

    def wire_time(self, octets: int) -> float:
        """Return the transmission time [s] of `octets` bytes."""
        return octets * self._byte

    def forget(self) -> None:
        """Discard received bytes before a new query."""
        self.received = b""

    def send(self, data: bytes) -> None:
        """Send bytes, and estimate when their transmission ends.

        Raises:
            BusError: the port is gone.
        """
        self.wire.write(data)
        self.sent_at = self.wire.now() + self.wire_time(len(data))

    def receive(
        self, question: Query, *, end: float, strict: bool = False, patient: bool = False, again: bool = False
    ) -> ServoReplies | None:
        """Wait for the reply to the last query, and return it.

        Args:
            question: the query.
            end: [s] when waiting should end.
            strict: whether waiting must end then; otherwise it lasts as long as the reply can still be in time.
            patient: whether to wait until `end` in any case, because a pending earlier reply delays this one.
            again: whether the last reply was an earlier one; bytes after it may begin this one.

        Returns:
            The reply; None if no byte came.

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
            if len(raw) >= question.length or question.is_complete(raw):
                answer = question.parse(raw)
                if answer.whole:
                    self._learn(raw, answer, question.length, ideal, wait.began)
                    return answer
                if not patient and (len(raw) >= answer.end or question.is_complete(raw)):
                    break
                if wait.extend(answer.end):
                    limit = wait.until(self.wire.now(), len(raw))
            if wait.tight and raw and not patient:
                self.wire.sleep(min(limit, wait.earliest))  # a truncation cannot be noticed earlier
            chunk = self.wire.read(limit)
            if not chunk:
                break
            raw += chunk
            wait.note_bytes(self.wire.now(), len(raw), len(chunk))
            limit = wait.until(self.wire.now(), len(raw))
        self._alert_replies = TIMEOUT_TUNING.alert_replies
        self.received += raw
        self.mute = not raw
        return question.parse(raw) if raw else None

    def _wait(self, question: Query, end: float, *, strict: bool, patient: bool) -> "_Wait":
        usual, length = self.slack.usual, self.wire_time(question.length)
        again = (
            TIMEOUT_TUNING.max_extra_pause + self.wire_time(len(question.data)) + usual
        )  # [s] of a repeated query without its reply
        ideal = self.sent_at + length
        last = end if patient else min(ideal + self.slack.wait, end)
        if not strict:
            last = max(last, ideal + TIMEOUT_TUNING.min_timeout)
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
            replies_late=self.replies_late or self.mute,
        )

    def _wait_for_begin(self, wait: "_Wait") -> tuple[bytes, float]:
        """Sleep through the expected transmission of the reply before reading it.

        Returns received bytes and the deadline [s] for more.
        """
        wire, due = self.wire, self.sent_at + wait.burst + self.slack.wait
        if (self._alert_replies or wait.tight) and not wait.patient:
            return b"", wait.until(self.sent_at, 0)
        if wait.patient or wait.spare or due >= wait.ideal:
            wire.sleep(wait.ideal)
            return b"", wait.last if wait.patient or not wait.spare else wait.silence_deadline(due)
        begun = wire.read(wait.silence_deadline(due))  # a long reply must have begun by now, or the query is repeated
        if not begun:
            return b"", wire.now()
        wait.began = wire.now()
        wire.sleep(wait.ideal)
        return begun + wire.read(wait.ideal), wait.last

    def _learn(self, raw: bytes, answer: ServoReplies, length: int, ideal: float, began: float) -> None:
        """Update the timeouts with a complete reply.

        Args:
            raw: received bytes.
            answer: the reply.
            length: [bytes] of the reply.
            ideal: [s] earliest end of the reply.
            began: [s] arrival of its first bytes.
        """
        now = self.wire.now()
        self.slack.learn(now - ideal)
        if self.sent_at <= began < ideal:
            self._burst.learn(began - self.sent_at)
        self._alert_replies = max(0, self._alert_replies - 1)
        self.received += raw
        self.before = raw[: max(0, answer.end - length)]
        self._rest, self.mute, self.early = raw[answer.end :], False, now < ideal

    def exchange(self, data: bytes, servo: int, size: int) -> bytes | None:
        """Send a packet to one servo and return its reply data.

        None if no status comes in time.

        Raises:
            BusError: the port is gone.
        """
        self.send(data)
        limit = self.sent_at + self.wire_time(STATUS_OVERHEAD + size) + self.slack.wait
        reader = Reader()
        while chunk := self.wire.read(limit):
            for status in reader.feed(chunk):
                if (status.id, status.instruction, len(status.data)) == (servo, Instruction.STATUS, size):
                    return status.data
        return None


@dataclass
class _Wait:
    """Deadlines for the bytes of one reply, updated as they arrive.

    A truncated reply falls behind the bytes that the wire could have transmitted.
    """

    sent_at: float  # [s] time at which the query is transmitted
    byte: float  # [s] transmission time of a byte
    length: int  # [bytes] expected length of the reply
    usual: float  # [s] usual time for which the adapter holds the last bytes
    burst: float  # [s] time between two bursts of the adapter
    last: float  # [s] present deadline
    end: float  # [s] latest permitted deadline
    patient: bool  # whether pauses inside the reply are ignored
    tight: bool  # whether a truncated reply must be noticed at once, to leave time for a repeated query
    spare: bool  # whether the cycle has time to repeat the full query after this wait
    replies_late: bool  # whether a missing reply is late rather than lost
    behind: float = inf  # [s] smallest delay of received bytes so far
    began: float = inf  # [s] arrival of the first bytes

    @property
    def ideal(self) -> float:
        """Time [s] at which a reply without delay would be complete."""
        return self.sent_at + self.byte * self.length

    @property
    def earliest(self) -> float:
        """Earliest expected time [s] of the last bytes from the adapter."""
        return self.ideal + self.usual / 2

    def note_bytes(self, now: float, octets: int, news: int) -> None:
        """Update the estimated delay of a reply when bytes of it arrive.

        A small burst was held back by the adapter's timer.

        Args:
            now: [s].
            octets: [bytes] received in total.
            news: [bytes] received in this burst.
        """
        self.began = min(self.began, now)
        stayed = self.usual if news < TIMEOUT_TUNING.full_burst_fraction * self.burst / self.byte else 0.0
        self.behind = max(0.0, min(self.behind, now - self.sent_at - self.byte * octets - stayed))

    def until(self, now: float, octets: int) -> float:
        """Return the deadline [s] for more bytes, given the received count."""
        if self.patient:
            return self.last
        lacking = self.byte * (self.length - octets)
        if self.tight:
            pause = lacking + self.usual if lacking < self.burst else max(self.burst, self.usual)
            behind = self.behind if isfinite(self.behind) else 0.0
            last = min(max(self.last, self.ideal + behind + self.usual + TIMEOUT_TUNING.max_extra_pause), self.end)
            deadline = min(self.sent_at + behind + self.byte * octets + pause + TIMEOUT_TUNING.max_extra_pause, last)
        else:
            # bytes that are neither received nor in the adapter after their time were never sent
            gap = self.burst + self.usual + TIMEOUT_TUNING.max_extra_pause
            deadline = now if now >= self.ideal and lacking > gap else min(self.last, max(now, self.sent_at) + gap)
        return deadline if octets else self.silence_deadline(deadline)

    def silence_deadline(self, due: float) -> float:
        """Return the deadline [s] for the first byte of a reply.

        A repeated query while servos transmit destroys their reply, which is a loss if the reply was only late.
        """
        if self.spare:
            return max(due, self.ideal + TIMEOUT_TUNING.max_extra_pause)
        return self.end if self.replies_late else due

    def extend(self, length: int) -> bool:
        """Extend the expected reply length, and return whether it has grown."""
        added = length > self.length
        if added:
            self.length, self.last = length, self.end
        return added
