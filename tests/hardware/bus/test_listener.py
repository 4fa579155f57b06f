from collections import deque

import numpy as np
import pytest

from kinesic.hardware.bus.cycle import BLOCK_DTYPE
from kinesic.hardware.bus.listener import (
    TIMEOUT_TUNING,
    USB_BURST_SIZE,
    Listener,
    TimeoutEstimate,
)
from kinesic.hardware.bus.query import FastQuery, PlainQuery
from kinesic.hardware.protocol.packet import BROADCAST_ID, PACKET_HEADER, Instruction, crc16, status

SERVO_IDS = tuple(range(1, 15))
SENT_QUERY = FastQuery(SERVO_IDS, (224,) * 14)
CYCLE_END = 0.0095  # [s] time at which the bus cycle ends


def after(excesses: list[float]) -> TimeoutEstimate:
    slack = TimeoutEstimate()
    for excess in excesses:
        slack.learn(excess)
    return slack


@pytest.mark.parametrize("usual", [0.0001, 0.001, 0.004, 0.009])
def test_reply_timeout_converges_to_the_90_percent_quantile_of_reply_delays(usual: float):
    rng = np.random.default_rng(0)
    slack = after((usual * rng.uniform(0.0, 1.0, 3000)).tolist())
    assert slack.usual == pytest.approx(0.9 * usual, abs=0.001)
    assert TIMEOUT_TUNING.min_timeout <= slack.wait <= TIMEOUT_TUNING.max_timeout
    assert slack.wait >= usual


def test_rare_late_reply_does_not_lengthen_the_reply_timeout():
    rng = np.random.default_rng(0)
    slack = after([0.012 if rng.random() < 0.05 else 0.001 for _ in range(2000)])
    assert slack.wait < 0.005


def test_reply_timeout_grows_if_two_fifths_of_the_replies_are_late():
    rng = np.random.default_rng(0)
    slack = after([0.012 if rng.random() < 0.4 else 0.001 for _ in range(2000)])
    assert slack.wait > 0.012


def test_learned_reply_timeout_of_the_bus_stays_within_its_bounds():
    assert after([1.0] * 2000).wait == TIMEOUT_TUNING.max_timeout
    assert after([-1.0] * 2000).wait == TIMEOUT_TUNING.min_timeout


class Arrivals:
    """Wire on which bytes arrive at prescribed times."""

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
    length = 1 + BLOCK_DTYPE.itemsize * len(SERVO_IDS)
    raw = bytearray(PACKET_HEADER + bytes((BROADCAST_ID, length & 0xFF, length >> 8, Instruction.STATUS)))
    for servo in SERVO_IDS:
        raw += bytes((0, servo, mark)) + bytes(17)
        raw += crc16(raw).to_bytes(2, "little")
    return bytes(raw)


def listener(*arrivals: tuple[float, bytes]) -> Listener:
    made = Listener(Arrivals(*arrivals))
    for _ in range(200):
        made.slack.learn(0.001)
    made.send(SENT_QUERY.data)
    return made


REPLY_END = 28e-5 + SENT_QUERY.length * 1e-5  # [s] time at which the last byte of the reply has been transmitted


def test_whole_bus_reply_is_returned_when_its_last_byte_arrives():
    made = listener((REPLY_END - 0.002, joint()[:186]), (REPLY_END + 0.001, joint()[186:]))
    answer = made.receive(SENT_QUERY, end=CYCLE_END)
    assert answer is not None
    assert answer.whole
    assert made.wire.now() == pytest.approx(REPLY_END + 0.001)
    assert made.received == joint()
    assert not made.mute
    assert not made.early


def test_missing_reply_times_out_early_enough_for_a_repeated_query():
    made = listener()
    assert made.receive(SENT_QUERY, end=CYCLE_END) is None
    assert made.mute
    assert made.wire.now() < REPLY_END + 0.001


def test_reception_of_a_truncated_reply_ends_when_its_last_byte_was_due():
    made = listener((0.002, joint()[:USB_BURST_SIZE]))
    answer = made.receive(SENT_QUERY, end=CYCLE_END)
    assert answer is not None
    assert answer.received.sum() == 2
    assert made.wire.now() == pytest.approx(REPLY_END)


def test_truncated_reply_is_parsed_immediately_if_the_cycle_has_no_spare_time():
    made = listener((28e-5 + USB_BURST_SIZE * 1e-5, joint()[:USB_BURST_SIZE]), (0.0018, joint()[USB_BURST_SIZE:100]))
    answer = made.receive(SENT_QUERY, end=REPLY_END + 0.003)
    assert answer is not None
    assert answer.received.sum() == 4
    assert made.wire.now() < REPLY_END - 0.0005


def test_fast_reply_with_a_repeated_servo_block_is_received_to_its_end():
    at = 8 + 22 * 3
    longer = joint()[: at + 22] + joint()[at:]
    made = listener(
        (REPLY_END - 0.001, longer[:300]), (REPLY_END, longer[300 : len(joint())]), (REPLY_END + 0.0013, longer[-22:])
    )
    answer = made.receive(SENT_QUERY, end=CYCLE_END)
    assert answer is not None
    assert answer.whole


def test_fast_reply_that_lacks_its_first_byte_still_counts_as_complete():
    made = listener((REPLY_END, joint()[1:]))
    answer = made.receive(SENT_QUERY, end=CYCLE_END)
    assert answer is not None
    assert answer.whole
    assert made.before == b""


def test_after_a_damaged_reply_the_listener_examines_each_usb_burst():
    made = listener((0.002, joint()[:USB_BURST_SIZE]), (0.0085, joint()[:30]), (0.2, b""))
    made.receive(SENT_QUERY, end=CYCLE_END)
    made.send(SENT_QUERY.data)
    began = made.wire.now()
    made.receive(SENT_QUERY, end=began + CYCLE_END)
    assert made.wire.now() < began + 0.0065


def test_listener_stops_examining_usb_bursts_after_several_intact_replies():
    answers = [((k + 1) * 0.01 - 0.0005, joint()) for k in range(TIMEOUT_TUNING.alert_replies + 3)]
    made = Listener(Arrivals((0.0, b"\xff"), *answers))
    for k in range(TIMEOUT_TUNING.alert_replies + 2):
        made.wire.sleep(k * 0.01 + 0.005)
        made.send(SENT_QUERY.data)
        answer = made.receive(SENT_QUERY, end=k * 0.01 + 0.0149)
        assert answer is not None
        assert made._alert_replies == max(0, TIMEOUT_TUNING.alert_replies - k)


def test_listener_that_waits_for_the_whole_cycle_accepts_a_reply_shortly_before_its_end():
    made = listener((0.009, joint()))
    answer = made.receive(SENT_QUERY, end=CYCLE_END, patient=True)
    assert answer is not None
    assert answer.whole


def test_two_replies_received_at_once_are_parsed_in_order():
    made = listener((0.002, joint(1)[:200]), (REPLY_END + 0.001, joint(1)[200:] + joint(0)))
    first = made.receive(SENT_QUERY, end=CYCLE_END)
    second = made.receive(SENT_QUERY, end=CYCLE_END, again=True)
    assert first is not None
    assert second is not None
    assert (first.blocks["torque"][0], second.blocks["torque"][0]) == (1, 0)
    assert made.receive(SENT_QUERY, end=CYCLE_END, again=True) is None


def test_reply_before_its_earliest_time_belongs_to_an_earlier_query():
    single = PlainQuery((1,), (224,))
    made = Listener(Arrivals((1e-5, status(1, 0, bytes(18)))))
    made.send(single.data)
    made._alert_replies = 1
    assert made.receive(single, end=CYCLE_END) is not None
    assert made.early


def test_exchange_with_one_servo_returns_only_replies_of_its_id():
    made = Listener(Arrivals((0.001, status(2, 0, b"\x01")), (0.0015, status(1, 0, b"\x02"))))
    assert made.exchange(b"question", 1, 1) == b"\x02"
    assert made.exchange(b"question", 1, 1) is None
