import numpy as np

from kinesic.hardware.bus.polling import MAX_MISSES, MAX_POLL_INTERVAL, PollingPlan


def missing(count: int, *places: int) -> np.ndarray:
    fresh = np.ones(count, dtype=np.bool_)
    fresh[list(places)] = False
    return fresh


def test_all_servos_are_queried_in_order_while_all_answer():
    roster = PollingPlan(4)
    assert roster.note(missing(4)) == ((), ())
    assert roster.order == (0, 1, 2, 3)
    assert roster.is_natural
    assert roster.next_alone(0.0) is None


def test_servo_that_missed_a_reply_is_queried_last():
    roster = PollingPlan(4)
    roster.note(missing(4, 1))
    assert roster.order == (0, 2, 3, 1)
    assert not roster.is_natural
    roster.note(missing(4))
    assert roster.order == (0, 1, 2, 3)


def test_only_the_first_servo_without_a_reply_moves_to_the_end_of_the_query_order():
    roster = PollingPlan(5)
    roster.note(missing(5, 1, 3, 4))
    assert roster.order == (0, 2, 3, 4, 1)
    roster.note(missing(5, 4, 1))
    assert roster.order == (0, 2, 3, 1, 4)


def test_servo_with_five_missing_replies_is_queried_alone():
    roster = PollingPlan(3)
    results = [roster.note(missing(3, 1)) for _ in range(MAX_MISSES)]
    assert results[-1] == ((1,), ())
    assert results[:-1] == [((), ())] * (MAX_MISSES - 1)
    assert roster.order == (0, 2)
    assert roster.silent.tolist() == [False, True, False]


def test_silent_servo_rejoins_the_query_order_after_one_reply():
    roster = PollingPlan(3)
    for _ in range(MAX_MISSES + 20):
        roster.note(missing(3, 1))
    assert roster.note(missing(3)) == ((), (1,))
    assert roster.order == (0, 1, 2)


def test_silent_servos_are_queried_in_turn():
    roster = PollingPlan(4)
    for _ in range(MAX_MISSES):
        roster.note(missing(4, 0, 2))
    turns = []
    for k in range(6):
        now = 10.0 + k * 0.01
        alone = roster.next_alone(now)
        assert alone is not None
        turns.append(alone)
        roster.note_alone(alone[0], now)
    assert [place for place, _ in turns] == [0, 2, 0, 2, 0, 2]
    assert [must for _, must in turns] == [True, True, False, False, False, False]
    assert roster.next_alone(10.05 + MAX_POLL_INTERVAL) == (0, True)


def test_no_servo_is_excluded_when_all_are_silent():
    roster = PollingPlan(2)
    for _ in range(3 * MAX_MISSES):
        assert roster.note(missing(2, 0, 1)) == ((), ())
    assert sorted(roster.order) == [0, 1]
    assert roster.next_alone(0.0) is None
