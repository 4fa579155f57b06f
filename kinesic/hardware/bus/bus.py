"""Drives the servos on one wire at its rate: goals out and a record of every servo back, cycle by cycle.

One write holds the goals and the question; the joint reply is checked block by block, what is missing is asked again
while the cycle has time, and what stays missing is only old. Faults of servos and of the port are data: `cycle` never
raises for them. Opening, and everything that may take its time, is in `bring_up`.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.bounds import RecordBounds, Span
from kinesic.hardware.bus.cycle import BLOCK, CELLS, SIZE, Cycle, Event, Happening, Records
from kinesic.hardware.bus.goals import GoalFrame
from kinesic.hardware.bus.late_replies import LateReplies
from kinesic.hardware.bus.listener import MOST, Listener
from kinesic.hardware.bus.plausibility import Place, PlausibilityFilter
from kinesic.hardware.bus.polling import PollingPlan
from kinesic.hardware.bus.query import Query, question_to
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.models import Model
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError, Wire

SHARE, HOST = 0.95, 0.0005  # of the period that a cycle may use, or all but so much of it [s]
ROUNDS = 4  # times that a missing servo is asked again in one cycle
ASKING = 22  # [bytes] of a fast question and its answer but for the servos
RETRY = 0.05  # [s] between two looks for a lost port
REST = 1.0  # [s] without such a look, after other servos were found behind it


@dataclass(frozen=True)
class Servo:
    """A servo on a bus: its id and its model."""

    id: int
    model: Model
    span: Span = (0, TICKS_PER_TURN - 1)  # [ticks] between which it may have goals

    @property
    def cells(self) -> int:
        """Address at which its record shows."""
        return self.model.cells[0].data


class Bus:
    """Servos on one wire that `bring_up` has prepared, so that their cells show the record."""

    def __init__(self, wire: Wire, servos: Sequence[Servo], *, period: float = 0.01, fast: bool = True) -> None:
        """Nothing is sent yet.

        Args:
            wire: an open one.
            servos: in the order of goals and records.
            period: [s] between cycles, which the caller keeps; a cycle asks again only while it has time.
            fast: whether all of them answer fast reads.
        """
        self.wire, self.servos, self.period, self.fast = wire, tuple(servos), period, fast
        self.ids = tuple(servo.id for servo in servos)
        self._frame = GoalFrame(self.ids)
        bounds = RecordBounds.of([servo.model for servo in servos], [servo.span for servo in servos])
        self._believed = PlausibilityFilter(bounds, period)
        self._polling = PollingPlan(len(servos))
        self._listener = Listener(wire)
        self._late = LateReplies(self._believed, self._listener)
        self._queue: deque[bytes] = deque()
        self._events: list[Event] = []
        self._reported, self._signature = self._believed.blocks, self._believed.signature
        self._rebooted: set[int] = set()  # places of those whose cells are not known to be set yet
        self._lost = False
        self._looked = -RETRY
        self._begun = self._sent_at = 0.0  # [s] this cycle, and everybody in it
        self._question, self._places = self._next_question()
        self._whole = True  # whether its answer has come
        self._only_listens = False  # whether nobody was asked in this cycle

    def put(self, register: Register, values: Mapping[int, int]) -> None:
        """Writes a register of some servos (id -> raw value) with the next cycle, before its goals.

        Servos do not answer: what they made of it, their records tell. While the port is lost, nothing is kept.

        Raises:
            ValueError: a value does not fit into the register.
        """
        field = register.field
        rows = {servo: field.pack(value) for servo, value in values.items()}
        self._queue.append(packet.sync_write(field.address, field.size, rows))

    def cycle(self, goals: Ticks | None = None) -> Cycle:
        """Sends goals, asks all servos, and returns what came.

        Args:
            goals: (n,) GOAL_POSITION [ticks], clipped to one turn; None: asks only.
        """
        self.begin(goals)
        return self.finish()

    def begin(self, goals: Ticks | None = None) -> None:
        """Runs the first half of a cycle, up to the question; several buses may begin before the first finishes."""
        self._begun = self.wire.now()
        self._believed.begin()
        try:
            if self._lost and not self._regained():
                self._queue.clear()
                return
            self._late.catch_up(self.wire.read(self._begun), self._begun)
            self._listener.forget()
            self._only_listens = self._late.in_doubt
            goal_frame = self._frame.filled(goals) if goals is not None else b""
            question = b"" if self._only_listens else self._question.data
            self._listener.send(b"".join((*self._queue, goal_frame, question)))
            self._sent_at = self._listener.sent_at
            self._queue.clear()
        except BusError as error:
            self._lose(error)

    def finish(self) -> Cycle:
        """Runs the second half of a cycle: takes the answers, and asks again for those that are missing."""
        if not self._lost:
            try:
                self._receive_all()
            except BusError as error:
                self._lose(error)
        self._note()
        ended, believed = self.wire.now(), self._believed
        events, self._events = tuple(self._events), []
        return Cycle(
            time=self._begun,
            duration=ended - self._begun,
            servos=self.ids,
            records=believed.blocks,
            times=believed.times,
            fresh=believed.fresh,
            late=believed.late,
            silent=self._polling.silent,
            lost=self._lost,
            signature=believed.signature,
            events=events,
        )

    def drop(self, reason: BusError) -> None:
        """Gives the port up for a while, as if it were lost: the servos behind it are not those that were there."""
        self.wire.close()
        self._lose(reason)
        self._looked = self.wire.now() + REST

    @property
    def _end(self) -> float:
        """[s] when the cycle should be over."""
        return self._begun + max(SHARE * self.period, self.period - HOST)

    def _receive_all(self) -> None:
        late, mute = self._late, self._listener.mute
        if self._only_listens:
            late.listen_for_late(self._question, self._places, self._end)
            return
        self._whole = self._receive(self._question, self._places, patient=mute)
        late.note(fresh=bool(self._believed.fresh.any()))
        self._repair()
        if self._believed.late.any() or (mute and self._believed.fresh.any()):
            self._listener.tardy = bool(self._believed.late.any())
        late.keep(self._question, self._places, sent_at=self._sent_at, whole=self._whole)

    def _receive(self, question: Query, places: Place, *, strict: bool = False, patient: bool = False) -> bool:
        """Waits for the answer to what was sent last, and takes what is plausible of it; whether it was whole."""
        listener, late, end = self._listener, self._late, self._end
        answer = listener.receive(question, end=end, strict=strict, patient=patient)
        while answer is not None and late.is_of_earlier(question, places, answer):
            answer = listener.receive(question, end=end, strict=strict, patient=patient, again=True)
        if answer is not None:
            answer = late.without_earlier(question, places, answer)
        if answer is not None and answer.whole:
            late.catch_up(listener.before, self._begun)
        if answer is not None:
            since = self._sent_at if late.open else inf
            self._believed.admit(places, answer, min(listener.sent_at, self.wire.now()), open_since=since)
        if answer is None or not answer.whole:
            late.missed(question)
        return answer is not None and answer.whole

    def _repair(self) -> None:
        """Uses what is left of the cycle: asks again who is missing, sets cells anew, tries a silent servo."""
        believed, polling, listener = self._believed, self._polling, self._listener
        if believed.fresh.all():
            return
        for _ in range(ROUNDS):
            missing = [k for k in polling.order if not believed.fresh[k] and k not in believed.forgetful]
            # who is missing first may have cut off the others: he is asked last
            suspect_last = (*missing[1:], *missing[:1])
            mute = listener.mute
            if not missing or not self._request(suspect_last[: self._room()]):
                break
            if mute and not listener.mute:
                # what was only lost is made good now; what was late has been spoilt by asking again
                listener.tardy = 2 * int(believed.fresh.sum()) < len(missing)
            self._look_again()
        for place in tuple(believed.forgetful):
            self._remind(place)
        if not believed.fresh.all():
            self._late.catch_up(self._listener.received, self._begun)
        alone = polling.next_alone(self.wire.now())
        if alone is not None and self._request((alone[0],), must=alone[1]):
            polling.note_alone(alone[0], self.wire.now())
            if not believed.fresh[alone[0]]:
                self._late.keep_alone(self._question_to((alone[0],)), np.array([alone[0]]), sent_at=listener.sent_at)

    def _room(self) -> int:
        spoken, each = self._listener.spoken, packet.STATUS_OVERHEAD + SIZE + 1
        left = self._end - self.wire.now() - self._listener.slack.usual - spoken(ASKING)
        return max(1, int(left / spoken(BLOCK.itemsize + 1 if self.fast else each)))

    def _request(self, places: tuple[int, ...], *, must: bool = False) -> bool:
        """Asks some servos again if the cycle has time for it, and returns whether it had."""
        question = self._question_to(places)
        listener = self._listener
        ends = self.wire.now() + listener.spoken(len(question.data) + question.length) + listener.slack.usual
        if ends > self._end and not must:
            return False
        listener.send(question.data)
        self._receive(question, np.array(places), strict=not must)
        return True

    def _remind(self, place: int) -> None:
        """Sets the cells of a servo that has rebooted, once it is sure that it has."""
        servo, exchange = self.servos[place], self._listener.exchange
        cells = servo.model.cells[0].addresses
        shown = exchange(packet.read_packet(servo.id, cells, len(CELLS)), servo.id, len(CELLS))
        if shown is None:
            return
        if shown != CELLS:
            self._rebooted.add(place)
            if exchange(packet.write_packet(servo.id, cells, CELLS), servo.id, 0) is None:
                return  # the servo may have heard it all the same
        if place in self._rebooted:
            self._rebooted.discard(place)
            self._believed.forget(place)
            self._report(servo.id, "rebooted", "its RAM is as at power-on: torque off, no profile, no watchdog")
        self._believed.forgetful.discard(place)

    def _look_again(self) -> None:
        """Takes the rest of the answer to all, which may have come while others were asked again."""
        answer, believed = self._question.answer(self._listener.received), self._believed
        if not answer.whole:
            answer = self._late.without_earlier(self._question, self._places, answer)
        news = answer.found & ~believed.fresh[self._places]
        if news.any():
            believed.admit(self._places, answer._replace(found=news, whole=False), self._sent_at)
        if answer.whole and not self._whole:
            self._whole = True
            self._listener.slack.took(MOST)

    def _note(self) -> None:
        """Decides who is asked next, and which events to report."""
        believed, polling = self._believed, self._polling
        if not (believed.fresh.all() and polling.whole) and not (self._lost or self._only_listens):
            gone, back = polling.note(believed.fresh | believed.late)
            for place in gone:
                self._report(self.ids[place], "silent", "no answer that can be believed in five cycles")
            for place in back:
                self._report(self.ids[place], "heard", "answers again")
            self._question, self._places = self._next_question()
        for place in believed.doubted:
            self._report(self.ids[place], "doubted", "said something surprising")
        for place, text in believed.impossible.items():
            self._report(self.ids[place], "impossible", f"{text}; not believed until it says otherwise")
        believed.doubted.clear()
        believed.impossible.clear()
        if believed.signature != self._signature:
            self._compare(self._reported, believed.blocks)
            self._signature = believed.signature
        self._reported = believed.blocks

    def _compare(self, before: Records, after: Records) -> None:
        for servo, was, now in zip(self.ids, before, after, strict=True):
            if was["hardware_error"] != now["hardware_error"]:
                self._report(
                    servo, "error", f"hardware error {was['hardware_error']:#04x} -> {now['hardware_error']:#04x}"
                )
            if was["watchdog"] != now["watchdog"] == WATCHDOG_TRIPPED:
                self._report(servo, "watchdog", "stopped: the bus was quiet for too long")
            if was["torque"] != now["torque"]:
                self._report(servo, "torque", "on" if now["torque"] else "off")

    def _lose(self, error: BusError) -> None:
        self._lost = True
        self._report(None, "port lost", str(error))

    def _regained(self) -> bool:
        """Looks for the lost port, twenty times a second at most."""
        if self._begun - self._looked < RETRY:
            return False
        self._looked = self._begun
        if self.wire.reopen():
            self._lost = False
            self._report(None, "port back", self.wire.name)
        return not self._lost

    def _next_question(self) -> tuple[Query, Place]:
        order = self._polling.order
        places: Place = slice(None) if order == tuple(range(len(self.ids))) else np.array(order)
        return self._question_to(order), places

    def _question_to(self, places: tuple[int, ...]) -> Query:
        servos = tuple(self.ids[k] for k in places)
        cells = tuple(self.servos[k].cells for k in places)
        return question_to(servos, cells, fast=self.fast)

    def _report(self, servo: int | None, kind: Happening, text: str) -> None:
        self._events.append(Event(self.wire.now(), servo, kind, text))
