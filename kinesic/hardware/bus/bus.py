"""Cyclic communication with the servos on one wire.

One write holds the goals and the query; the common reply is checked block by block, missing records are queried again
while the cycle has time, and records that stay missing keep their last value. `cycle` never raises for faults of servos
or of the port, but returns them. Opening and other slow operations are in `bring_up`.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from math import inf

import numpy as np

from kinesic.hardware.bus.bounds import RecordBounds
from kinesic.hardware.bus.changes import describe_changes
from kinesic.hardware.bus.cycle import BLOCK_DTYPE, CELL_CONTENTS, RECORD_SIZE, Cycle, Event, EventKind
from kinesic.hardware.bus.dialect import Servo, make_dialect
from kinesic.hardware.bus.late_replies import LateReplies
from kinesic.hardware.bus.listener import TIMEOUT_TUNING, Listener
from kinesic.hardware.bus.plausibility import PlausibilityFilter, ServoSelection
from kinesic.hardware.bus.polling import PollingPlan
from kinesic.hardware.bus.query import Query
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError, Wire

CYCLE_FRACTION = 0.95  # fraction of the period that a cycle may use, or more if HOST_RESERVE leaves more
HOST_RESERVE = 0.0005  # [s] longest time at the end of a period that a cycle leaves free for the host
MAX_RETRIES = 4  # largest number of repeated queries per cycle, for servos whose record of this cycle is missing
FAST_OVERHEAD = 22  # [bytes] size of a fast query and its reply, without the bytes per servo
REOPEN_INTERVAL = 0.05  # [s] pause between two attempts to reopen a lost port
MISMATCH_DELAY = 1.0  # [s] wait before reopening a port whose servos were not identified


class Bus:
    """Bus that sends goal positions to prepared servos and reads their registers."""

    def __init__(self, wire: Wire, servos: Sequence[Servo], *, period: float = 0.01, fast: bool = True) -> None:
        """Create the bus without sending anything.

        Args:
            wire: an open wire.
            servos: servos in the order of goals and records.
            period: [s] between cycles, kept by the caller; a cycle repeats queries only while it has time.
            fast: whether all servos answer fast reads.
        """
        self.wire, self.servos, self.period, self.fast = wire, tuple(servos), period, fast
        self.ids = tuple(servo.id for servo in servos)
        self._dialect = make_dialect(servos, baud=wire.baud, period=period, fast=fast)
        bounds = RecordBounds.of([servo.model for servo in servos], [servo.span for servo in servos])
        self._accepted = PlausibilityFilter(bounds, period)
        self._polling = PollingPlan(len(servos))
        self._listener = Listener(wire)
        self._late = LateReplies(self._accepted, self._listener)
        self._queue: deque[bytes] = deque()
        self._events: list[Event] = []
        self._reported, self._signature = self._accepted.blocks, self._accepted.signature
        self._rebooted: set[int] = set()  # indices of rebooted servos whose indirect addresses are not confirmed yet
        self._requested: set[int] = set()  # indices of the servos queried in this cycle
        self._lost = False
        self._looked = -REOPEN_INTERVAL
        self._begun = self._sent_at = 0.0  # [s] start of this cycle and its query
        self._question, self._places = self._next_question()
        self._repeated = self._question  # last repeated query
        self._whole = True  # whether the reply is complete
        self._only_listens = False  # whether this cycle sends no query

    def put(self, register: Register, values: Mapping[int, int]) -> None:
        """Queue register writes that the next cycle sends before the goal positions.

        Servos do not acknowledge `values` (id -> raw value). While the port is lost, queued writes are dropped.

        Raises:
            ValueError: a value does not fit into the register.
        """
        self._queue.append(self._dialect.write(register, values))

    def cycle(self, goals: Ticks | None = None) -> Cycle:
        """Send goals, query all servos, and return their records.

        Args:
            goals: (n,) GOAL_POSITION [ticks], clipped to one turn; None: query only.
        """
        self.begin(goals)
        return self.finish()

    def begin(self, goals: Ticks | None = None) -> None:
        """Run the first half of a cycle: send writes, goals and query."""
        self._begun = self.wire.now()
        self._accepted.begin()
        if not self._dialect.collective:
            self._requested = set(self._indices(self._places))
        try:
            if self._lost and not self._reopen_port():
                self._queue.clear()
                return
            self._late.catch_up(self.wire.read(self._begun), self._begun)
            self._listener.forget()
            self._only_listens = self._late.needs_trial
            goal_frame = self._dialect.goals(goals) if goals is not None else b""
            if not self._dialect.has_cells:
                self._question = self._date(self._question, self._indices(self._places))
            question = b"" if self._only_listens else self._question.data
            self._listener.send(b"".join((*self._queue, goal_frame, question)))
            self._sent_at = self._listener.sent_at
            self._queue.clear()
        except BusError as error:
            self._report_lost_port(error)

    def finish(self) -> Cycle:
        """Run the second half of a cycle: receive records and repeat queries."""
        if not self._lost:
            try:
                self._receive_all()
            except BusError as error:
                self._report_lost_port(error)
        self._update_polling()
        ended, accepted = self.wire.now(), self._accepted
        events, self._events = tuple(self._events), []
        return Cycle(
            time=self._begun,
            duration=ended - self._begun,
            servos=self.ids,
            records=accepted.blocks,
            times=accepted.times,
            fresh=accepted.fresh,
            late=accepted.late,
            silent=self._polling.silent,
            lost=self._lost,
            signature=accepted.signature,
            events=events,
        )

    def drop(self, reason: BusError) -> None:
        """Close the port for `MISMATCH_DELAY`, after a failed identification of servos."""
        self.wire.close()
        self._report_lost_port(reason)
        self._looked = self.wire.now() + MISMATCH_DELAY

    @property
    def _end(self) -> float:
        """Time [s] at which the current bus cycle must end."""
        return self._begun + max(CYCLE_FRACTION * self.period, self.period - HOST_RESERVE)

    def _receive_all(self) -> None:
        late, mute = self._late, self._listener.mute
        if self._only_listens:
            late.listen_for_late(self._question, self._places, self._end)
            return
        self._whole = self._receive(self._question, self._places, patient=mute)
        late.note(fresh=bool(self._accepted.fresh.any()))
        self._query_missing_servos()
        if self._accepted.late.any() or (mute and self._accepted.fresh.any()):
            self._listener.replies_late = bool(self._accepted.late.any())
        late.keep(self._question, self._places, sent_at=self._sent_at, whole=self._whole)

    def _receive(self, question: Query, places: ServoSelection, *, strict: bool = False, patient: bool = False) -> bool:
        """Receive the reply to the last query and admit plausible records.

        Returns whether the reply is complete.
        """
        listener, late, end = self._listener, self._late, self._end
        answer = listener.receive(question, end=end, strict=strict, patient=patient)
        while answer is not None and late.admit_earlier(question, places, answer):
            answer = listener.receive(question, end=end, strict=strict, patient=patient, again=True)
        if answer is not None:
            answer = late.remove_earlier(question, places, answer)
        if answer is not None and answer.whole:
            late.catch_up(listener.before, self._begun)
        if answer is not None:
            since = self._sent_at if late.is_open else inf
            self._accepted.admit(places, answer, min(listener.sent_at, self.wire.now()), open_since=since)
        if answer is None or not answer.whole:
            late.note_missed(question)
        return answer is not None and answer.whole

    def _query_missing_servos(self) -> None:
        """Query missing and silent servos again while the cycle has time."""
        accepted, polling, listener = self._accepted, self._polling, self._listener
        if accepted.fresh.all():
            return
        for _ in range(MAX_RETRIES if self._dialect.collective else len(self.ids)):
            missing = [k for k in polling.order if not accepted.fresh[k] and k not in accepted.unmapped]
            if not self._dialect.collective:  # each servo once, that with the oldest record first
                missing = sorted(set(missing) - self._requested, key=lambda k: accepted.times[k])[:1]
            # the first missing servo may have cut off the others, so it is queried last
            suspect_last = (*missing[1:], *missing[:1])
            mute = listener.mute
            if not missing or not self._request(suspect_last[: self._count_possible_servos()]):
                break
            if mute and not listener.mute:
                # a repeated query recovers lost replies but destroys late ones
                listener.replies_late = 2 * int(accepted.fresh.sum()) < len(missing)
            self._look_again()
        if not self._dialect.has_cells:
            accepted.unmapped.clear()
        for place in tuple(accepted.unmapped):
            self._restore_cells(place)
        if not accepted.fresh.all():
            self._late.catch_up(self._listener.received, self._begun)
        alone = polling.next_alone(self.wire.now())
        if alone is not None and self._request((alone[0],), must=alone[1]):
            polling.note_alone(alone[0], self.wire.now())
            if not accepted.fresh[alone[0]]:
                self._late.keep_alone(self._repeated, np.array([alone[0]]), sent_at=listener.sent_at)

    def _count_possible_servos(self) -> int:
        """Return how many servos one repeated query may address."""
        wire_time, status_size = self._listener.wire_time, packet.STATUS_OVERHEAD + RECORD_SIZE + 1
        left = self._end - self.wire.now() - self._listener.slack.usual - wire_time(FAST_OVERHEAD)
        return max(1, int(left / wire_time(BLOCK_DTYPE.itemsize + 1 if self.fast else status_size)))

    def _request(self, places: tuple[int, ...], *, must: bool = False) -> bool:
        """Send a query if the cycle has time, and return whether sent."""
        question = self._date(self._dialect.question(places), places)
        listener = self._listener
        ends = self.wire.now() + listener.wire_time(len(question.data) + question.length) + listener.slack.usual
        if ends > self._end and not must:
            return False
        listener.send(question.data)
        self._repeated = question
        self._requested.update(places)
        self._receive(question, np.array(places), strict=not must)
        return True

    def _restore_cells(self, place: int) -> None:
        """Rewrite indirect addresses of a servo after a reboot."""
        servo, exchange = self.servos[place], self._listener.exchange
        cells = servo.model.cells[0].addresses
        shown = exchange(packet.read_packet(servo.id, cells, len(CELL_CONTENTS)), servo.id, len(CELL_CONTENTS))
        if shown is None:
            return
        if shown != CELL_CONTENTS:
            self._rebooted.add(place)
            if exchange(packet.write_packet(servo.id, cells, CELL_CONTENTS), servo.id, 0) is None:
                return  # the servo may have received the packet all the same
        if place in self._rebooted:
            self._rebooted.discard(place)
            self._accepted.forget(place)
            self._report(servo.id, "rebooted", "RAM is as at power-on: torque off, no profile, no watchdog")
        self._accepted.unmapped.discard(place)

    def _look_again(self) -> None:
        """Accept late records of the cycle's first query, received during repeated queries."""
        answer, accepted = self._question.parse(self._listener.received), self._accepted
        if not answer.whole:
            answer = self._late.remove_earlier(self._question, self._places, answer)
        news = answer.received & ~accepted.fresh[self._places]
        if news.any():
            accepted.admit(self._places, answer._replace(received=news, whole=False), self._sent_at)
        if answer.whole and not self._whole:
            self._whole = True
            self._listener.slack.learn(TIMEOUT_TUNING.max_timeout)

    def _update_polling(self) -> None:
        """Choose the servos of the next query, and report events."""
        accepted, polling = self._accepted, self._polling
        if not (accepted.fresh.all() and polling.is_natural) and not (self._lost or self._only_listens):
            heard = accepted.fresh | accepted.late
            if not self._dialect.collective:  # the cycle may have had no time for every servo
                unasked = np.array([k not in self._requested for k in range(len(self.ids))])
                heard = heard | (unasked & ~polling.silent)
            gone, back = polling.note(heard)
            for place in gone:
                self._report(self.ids[place], "silent", "no credible answer in five cycles")
            for place in back:
                self._report(self.ids[place], "heard", "answers again")
            self._question, self._places = self._next_question()
        for place in accepted.doubted:
            self._report(self.ids[place], "doubted", "reported an implausible value")
        for place, text in accepted.impossible.items():
            self._report(self.ids[place], "impossible", f"{text}; ignored until the value is possible")
        accepted.doubted.clear()
        accepted.impossible.clear()
        if accepted.signature != self._signature:
            for servo, kind, text in describe_changes(self.ids, self._reported, accepted.blocks):
                self._report(servo, kind, text)
            self._signature = accepted.signature
        self._reported = accepted.blocks

    def _report_lost_port(self, error: BusError) -> None:
        self._lost = True
        self._report(None, "port lost", str(error))

    def _reopen_port(self) -> bool:
        """Try to reopen the lost port, and return success."""
        if self._begun - self._looked < REOPEN_INTERVAL:
            return False
        self._looked = self._begun
        if self.wire.reopen():
            self._lost = False
            self._report(None, "port back", self.wire.name)
        return not self._lost

    def _next_question(self) -> tuple[Query, ServoSelection]:
        order = self._polling.order
        if not self._dialect.collective:
            order = (min(order, key=lambda k: self._accepted.times[k]),)
        places: ServoSelection = slice(None) if order == tuple(range(len(self.ids))) else np.array(order)
        return self._dialect.question(order), places

    def _indices(self, places: ServoSelection) -> list[int]:
        indices: list[int] = np.arange(len(self.ids))[places].tolist()
        return indices

    def _date(self, question: Query, places: Sequence[int]) -> Query:
        return self._dialect.dated(question, self.wire.now(), places, self._accepted.blocks)

    def _report(self, servo: int | None, kind: EventKind, text: str) -> None:
        self._events.append(Event(self.wire.now(), servo, kind, text))
