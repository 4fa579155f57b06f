from collections import deque

import numpy as np
import pytest

from kinesic.hardware.bus.cycle import BLOCK
from kinesic.hardware.bus.listener import BURST, LEAST, MOST, RESTLESS, Listener, TimeoutEstimate
from kinesic.hardware.bus.query import FastQuery, PlainQuery
from kinesic.hardware.protocol.packet import BROADCAST, HEADER, Instruction, crc16, status

SERVOS = tuple(range(1, 15))
QUESTION = FastQuery(SERVOS, (224,) * 14)
END = 0.0095


def after(excesses: list[float]) -> TimeoutEstimate:
    slack = TimeoutEstimate()
    for excess in excesses:
        slack.took(excess)
    return slack


@pytest.mark.parametrize("usual", [0.0001, 0.001, 0.004, 0.009])
def test_it_finds_what_nine_in_ten_take(usual: float):
    rng = np.random.default_rng(0)
    slack = after((usual * rng.uniform(0.0, 1.0, 3000)).tolist())
    assert slack.usual == pytest.approx(0.9 * usual, abs=0.001)
    assert LEAST <= slack.wait <= MOST
    assert slack.wait >= usual


def test_a_rare_late_answer_does_not_hold_up_the_others():
    rng = np.random.default_rng(0)
    slack = after([0.012 if rng.random() < 0.05 else 0.001 for _ in range(2000)])
    assert slack.wait < 0.005


def test_answers_that_are_mostly_late_are_waited_for():
    rng = np.random.default_rng(0)
    slack = after([0.012 if rng.random() < 0.4 else 0.001 for _ in range(2000)])
    assert slack.wait > 0.012


def test_it_stays_within_bounds():
    assert after([1.0] * 2000).wait == MOST
    assert after([-1.0] * 2000).wait == LEAST


class Arrivals:
    """A wire on which bytes arrive at times set beforehand."""

    name, baud = "arrivals", 1_000_000

    def __init__(self, *arrivals: tuple[float, bytes]) -> None:
        self._coming, self._time = deque(arrivals), 0.0

    def now(self) -> float:
        return self._time

    def write(self, data: bytes | bytearray, /) -> None:
        pass

    def read(self, deadline: float, /) -> bytes:
        due = self._coming[0][0] if self._coming else deadline
        self._time = max(self._time, min(due, deadline))
        came = b""
        while self._coming and self._coming[0][0] <= self._time:
            came += self._coming.popleft()[1]
        return came

    def sleep(self, until: float, /) -> None:
        self._time = max(self._time, until)

    def reopen(self) -> bool:
        return True

    def close(self) -> None:
        pass


def joint(mark: int = 0) -> bytes:
    length = 1 + BLOCK.itemsize * len(SERVOS)
    raw = bytearray(HEADER + bytes((BROADCAST, length & 0xFF, length >> 8, Instruction.STATUS)))
    for servo in SERVOS:
        raw += bytes((0, servo, mark)) + bytes(17)
        raw += crc16(raw).to_bytes(2, "little")
    return bytes(raw)


def listener(*arrivals: tuple[float, bytes]) -> Listener:
    made = Listener(Arrivals(*arrivals))
    for _ in range(200):
        made.slack.took(0.001)
    made.send(QUESTION.data)
    return made


READY = 28e-5 + QUESTION.length * 1e-5  # [s] when the last byte is out


def test_an_answer_in_time_is_heard_when_it_has_come():
    made = listener((READY - 0.002, joint()[:186]), (READY + 0.001, joint()[186:]))
    answer = made.receive(QUESTION, end=END)
    assert answer is not None
    assert answer.whole
    assert made.wire.now() == pytest.approx(READY + 0.001)
    assert made.received == joint()
    assert not made.mute
    assert not made.early


def test_an_answer_that_does_not_begin_is_given_up_in_time_to_ask_again():
    made = listener()
    assert made.receive(QUESTION, end=END) is None
    assert made.mute
    assert made.wire.now() < READY + 0.001


def test_an_answer_that_breaks_off_is_given_up_when_its_bytes_should_be_here():
    made = listener((0.002, joint()[:BURST]))
    answer = made.receive(QUESTION, end=END)
    assert answer is not None
    assert answer.found.sum() == 2
    assert made.wire.now() == pytest.approx(READY)


def test_where_time_is_short_an_answer_that_breaks_off_is_given_up_at_once():
    made = listener((28e-5 + BURST * 1e-5, joint()[:BURST]), (0.0018, joint()[BURST:100]))
    answer = made.receive(QUESTION, end=READY + 0.003)
    assert answer is not None
    assert answer.found.sum() == 4
    assert made.wire.now() < READY - 0.0005


def test_an_answer_to_which_bytes_were_added_is_heard_to_its_end():
    at = 8 + 22 * 3
    longer = joint()[: at + 22] + joint()[at:]
    made = listener((READY - 0.001, longer[:300]), (READY, longer[300 : len(joint())]), (READY + 0.0013, longer[-22:]))
    answer = made.receive(QUESTION, end=END)
    assert answer is not None
    assert answer.whole


def test_after_a_damaged_answer_every_burst_is_looked_at():
    made = listener((0.002, joint()[:BURST]), (0.0085, joint()[:30]), (0.2, b""))
    made.receive(QUESTION, end=END)
    made.send(QUESTION.data)
    began = made.wire.now()
    made.receive(QUESTION, end=began + END)
    assert made.wire.now() < began + 0.0065


def test_it_calms_down():
    answers = [((k + 1) * 0.01 - 0.0005, joint()) for k in range(RESTLESS + 3)]
    made = Listener(Arrivals((0.0, b"\xff"), *answers))
    for k in range(RESTLESS + 2):
        made.wire.sleep(k * 0.01 + 0.005)
        made.send(QUESTION.data)
        answer = made.receive(QUESTION, end=k * 0.01 + 0.0149)
        assert answer is not None


def test_a_patient_one_waits_to_the_end():
    made = listener((0.009, joint()))
    answer = made.receive(QUESTION, end=END, patient=True)
    assert answer is not None
    assert answer.whole


def test_two_answers_at_once_are_heard_one_after_the_other():
    made = listener((0.002, joint(1)[:200]), (READY + 0.001, joint(1)[200:] + joint(0)))
    first = made.receive(QUESTION, end=END)
    second = made.receive(QUESTION, end=END, again=True)
    assert first is not None
    assert second is not None
    assert (first.blocks["torque"][0], second.blocks["torque"][0]) == (1, 0)
    assert made.receive(QUESTION, end=END, again=True) is None


def test_an_answer_before_its_time_is_an_earlier_one():
    single = PlainQuery((1,), (224,))
    made = Listener(Arrivals((1e-5, status(1, 0, bytes(18)))))
    made.send(single.data)
    made._restless = 1
    assert made.receive(single, end=END) is not None
    assert made.early


def test_one_servo_is_asked_and_heard():
    made = Listener(Arrivals((0.001, status(2, 0, b"\x01")), (0.0015, status(1, 0, b"\x02"))))
    assert made.exchange(b"question", 1, 1) == b"\x02"
    assert made.exchange(b"question", 1, 1) is None
