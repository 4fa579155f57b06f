"""Servos on one wire, at the rate of the wire: goals out and a record of every servo back, cycle by cycle.

One write holds the goals and the question; the joint reply is checked block by block, what is missing is asked again
while the cycle has time, and what stays missing is only old. Faults of servos and of the port are data: `cycle` never
raises for them. Opening, and everything that may take its time, is in `bring_up`.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

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


@dataclass(frozen=True)
class Servo:
    """One servo of a bus."""

    id: int
    model: Model

    @property
    def cells(self) -> int:
        """Where its record shows."""
        return self.model.cells[0].data


class Bus:
    """Servos that `bring_up` has prepared: their cells show the record."""

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
        self._gate = PlausibilityFilter(tuple(servo.model for servo in servos), period)
        self._roster = PollingPlan(len(servos))
        self._listener = Listener(wire)
        self._overdue = LateReplies(self._gate, self._listener)
        self._queue: deque[bytes] = deque()
        self._events: list[Event] = []
        self._told, self._signature = self._gate.blocks, self._gate.signature
        self._lost = False
        self._looked = -RETRY
        self._begun = self._asked = 0.0  # [s] this cycle, and everybody in it
        self._question, self._places = self._next_question()
        self._whole = True  # whether its answer has come
        self._mum = False  # whether nobody was asked in this cycle

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
        """Sends goals, asks everybody, and tells what came.

        Args:
            goals: (n,) GOAL_POSITION [ticks], clipped to one turn; None: asks only.
        """
        self.begin(goals)
        return self.finish()

    def begin(self, goals: Ticks | None = None) -> None:
        """The first half of a cycle, up to the question; several buses may begin before the first finishes."""
        self._begun = self.wire.now()
        self._gate.begin()
        try:
            if self._lost and not self._regained():
                self._queue.clear()
                return
            self._overdue.catch_up(self.wire.read(self._begun), self._begun)
            self._listener.forget()
            self._mum = self._overdue.in_doubt
            goal_frame = self._frame.filled(goals) if goals is not None else b""
            question = b"" if self._mum else self._question.data
            self._listener.say(b"".join((*self._queue, goal_frame, question)))
            self._asked = self._listener.asked
            self._queue.clear()
        except BusError as error:
            self._lose(error)

    def finish(self) -> Cycle:
        """The second half of a cycle."""
        if not self._lost:
            try:
                self._hear()
            except BusError as error:
                self._lose(error)
        self._note()
        ended, gate = self.wire.now(), self._gate
        events, self._events = tuple(self._events), []
        return Cycle(
            time=self._begun,
            duration=ended - self._begun,
            servos=self.ids,
            records=gate.blocks,
            times=gate.times,
            fresh=gate.fresh,
            late=gate.late,
            silent=self._roster.silent,
            lost=self._lost,
            signature=gate.signature,
            events=events,
        )

    @property
    def _end(self) -> float:
        """[s] when the cycle should be over."""
        return self._begun + max(SHARE * self.period, self.period - HOST)

    def _hear(self) -> None:
        """The answer to all, and what can be mended of it."""
        overdue, mute = self._overdue, self._listener.mute
        if self._mum:
            overdue.overhear(self._question, self._places, self._end)
            return
        self._whole = self._listen(self._question, self._places, patient=mute)
        overdue.note(fresh=bool(self._gate.fresh.any()))
        self._repair()
        if self._gate.late.any() or (mute and self._gate.fresh.any()):
            self._listener.tardy = bool(self._gate.late.any())
        overdue.keep(self._question, self._places, asked=self._asked, whole=self._whole)

    def _listen(self, question: Query, places: Place, *, strict: bool = False, patient: bool = False) -> bool:
        """Waits for the answer to what was said last, and believes what is plausible of it; whether it was whole."""
        listener, overdue, end = self._listener, self._overdue, self._end
        answer = listener.hear(question, end=end, strict=strict, patient=patient)
        while answer is not None and overdue.is_of_earlier(question, places, answer):
            answer = listener.hear(question, end=end, strict=strict, patient=patient, again=True)
        if answer is not None:
            answer = overdue.without_earlier(question, places, answer)
        if answer is not None and answer.whole:
            overdue.catch_up(listener.before, self._begun)
        if answer is None or not answer.whole:
            overdue.missed(question)
        if answer is not None:
            self._gate.admit(places, answer, min(listener.asked, self.wire.now()))
        return answer is not None and answer.whole

    def _repair(self) -> None:
        """Uses what is left of the cycle: asks again who is missing, sets cells anew, tries a silent servo."""
        gate, roster, listener = self._gate, self._roster, self._listener
        if gate.fresh.all():
            return
        for _ in range(ROUNDS):
            missing = [k for k in roster.order if not gate.fresh[k] and k not in gate.forgetful]
            # who is missing first may have cut off the others: he is asked last
            suspect_last = (*missing[1:], *missing[:1])
            mute = listener.mute
            if not missing or not self._ask(suspect_last[: self._room()]):
                break
            if mute and not listener.mute:
                # what was only lost is made good now; what was late has been spoilt by asking again
                listener.tardy = 2 * int(gate.fresh.sum()) < len(missing)
            self._look_again()
        for place in tuple(gate.forgetful):
            self._remind(place)
        if not gate.fresh.all():
            self._overdue.catch_up(self._listener.heard, self._begun)
        alone = roster.next_alone(self.wire.now())
        if alone is not None and self._ask((alone[0],), must=alone[1]):
            roster.asked_alone(alone[0], self.wire.now())

    def _room(self) -> int:
        """How many servos can be asked again in what is left of the cycle."""
        spoken, each = self._listener.spoken, packet.STATUS_OVERHEAD + SIZE + 1
        left = self._end - self.wire.now() - self._listener.slack.usual - spoken(ASKING)
        return max(1, int(left / spoken(BLOCK.itemsize + 1 if self.fast else each)))

    def _ask(self, places: tuple[int, ...], *, must: bool = False) -> bool:
        """Asks some servos again if the cycle has time for it; whether it did."""
        question = self._question_to(places)
        listener = self._listener
        ends = self.wire.now() + listener.spoken(len(question.data) + question.length) + listener.slack.usual
        if ends > self._end and not must:
            return False
        listener.say(question.data)
        self._listen(question, np.array(places), strict=not must)
        return True

    def _remind(self, place: int) -> None:
        """Sets the cells of a servo that has rebooted, once it is sure that it has."""
        servo, exchange = self.servos[place], self._listener.exchange
        cells = servo.model.cells[0].addresses
        shown = exchange(packet.read_packet(servo.id, cells, len(CELLS)), servo.id, len(CELLS))
        if shown is None:
            return
        if shown != CELLS:
            if exchange(packet.write_packet(servo.id, cells, CELLS), servo.id, 0) is None:
                return
            self._gate.forget(place)
            self._tell(servo.id, "rebooted", "its RAM is as at power-on: torque off, no profile, no watchdog")
        self._gate.forgetful.discard(place)

    def _look_again(self) -> None:
        """While others were asked again, the rest of the answer to all may have come."""
        answer, gate = self._question.answer(self._listener.heard), self._gate
        if not answer.whole:
            answer = self._overdue.without_earlier(self._question, self._places, answer)
        news = answer.found & ~gate.fresh[self._places]
        if news.any():
            gate.admit(self._places, answer._replace(found=news, whole=False), self._asked)
        if answer.whole and not self._whole:
            self._whole = True
            self._listener.slack.took(MOST)

    def _note(self) -> None:
        """Draws the conclusions of a cycle: who is asked next, and what is worth telling."""
        gate, roster = self._gate, self._roster
        if not (gate.fresh.all() and roster.whole) and not (self._lost or self._mum):
            gone, back = roster.heard(gate.fresh | gate.late)
            for place in gone:
                self._tell(self.ids[place], "silent", "no answer in five cycles")
            for place in back:
                self._tell(self.ids[place], "heard", "answers again")
            self._question, self._places = self._next_question()
        for place in gate.doubted:
            self._tell(self.ids[place], "doubted", "said something surprising")
        gate.doubted.clear()
        if gate.signature != self._signature:
            self._compare(self._told, gate.blocks)
            self._signature = gate.signature
        self._told = gate.blocks

    def _compare(self, before: Records, after: Records) -> None:
        """Tells what has changed between two cycles."""
        for servo, was, now in zip(self.ids, before, after, strict=True):
            if was["hardware_error"] != now["hardware_error"]:
                self._tell(
                    servo, "error", f"hardware error {was['hardware_error']:#04x} -> {now['hardware_error']:#04x}"
                )
            if was["watchdog"] != now["watchdog"] == WATCHDOG_TRIPPED:
                self._tell(servo, "watchdog", "stopped: the bus was quiet for too long")
            if was["torque"] != now["torque"]:
                self._tell(servo, "torque", "on" if now["torque"] else "off")

    def _lose(self, error: BusError) -> None:
        self._lost = True
        self._tell(None, "port lost", str(error))

    def _regained(self) -> bool:
        """Looks for the port, twenty times a second at most."""
        if self._begun - self._looked < RETRY:
            return False
        self._looked = self._begun
        if self.wire.reopen():
            self._lost = False
            self._tell(None, "port back", self.wire.name)
        return not self._lost

    def _next_question(self) -> tuple[Query, Place]:
        order = self._roster.order
        places: Place = slice(None) if order == tuple(range(len(self.ids))) else np.array(order)
        return self._question_to(order), places

    def _question_to(self, places: tuple[int, ...]) -> Query:
        servos = tuple(self.ids[k] for k in places)
        cells = tuple(self.servos[k].cells for k in places)
        return question_to(servos, cells, fast=self.fast)

    def _tell(self, servo: int | None, kind: Happening, text: str) -> None:
        self._events.append(Event(self.wire.now(), servo, kind, text))
