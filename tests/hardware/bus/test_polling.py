import numpy as np

from kinesic.hardware.bus.polling import MAX_POLL_INTERVAL, PATIENCE, PollingPlan


def missing(count: int, *places: int) -> np.ndarray:
    fresh = np.ones(count, dtype=np.bool_)
    fresh[list(places)] = False
    return fresh


def test_all_are_asked_in_order_while_all_answer():
    roster = PollingPlan(4)
    assert roster.note(missing(4)) == ((), ())
    assert roster.order == (0, 1, 2, 3)
    assert roster.whole
    assert roster.next_alone(0.0) is None


def test_who_missed_is_asked_last():
    roster = PollingPlan(4)
    roster.note(missing(4, 1))
    assert roster.order == (0, 2, 3, 1)
    assert not roster.whole
    roster.note(missing(4))
    assert roster.order == (0, 1, 2, 3)


def test_the_first_who_is_missing_is_asked_last_of_all():
    roster = PollingPlan(5)
    roster.note(missing(5, 1, 3, 4))
    assert roster.order == (0, 2, 3, 4, 1)
    roster.note(missing(5, 4, 1))
    assert roster.order == (0, 2, 3, 1, 4)


def test_who_misses_five_times_is_asked_alone():
    roster = PollingPlan(3)
    told = [roster.note(missing(3, 1)) for _ in range(PATIENCE)]
    assert told[-1] == ((1,), ())
    assert told[:-1] == [((), ())] * (PATIENCE - 1)
    assert roster.order == (0, 2)
    assert roster.silent.tolist() == [False, True, False]


def test_one_answer_brings_back():
    roster = PollingPlan(3)
    for _ in range(PATIENCE + 20):
        roster.note(missing(3, 1))
    assert roster.note(missing(3)) == ((), (1,))
    assert roster.order == (0, 1, 2)


def test_the_silent_take_turns():
    roster = PollingPlan(4)
    for _ in range(PATIENCE):
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


def test_nobody_is_silent_when_all_are():
    roster = PollingPlan(2)
    for _ in range(3 * PATIENCE):
        assert roster.note(missing(2, 0, 1)) == ((), ())
    assert sorted(roster.order) == [0, 1]
    assert roster.next_alone(0.0) is None
