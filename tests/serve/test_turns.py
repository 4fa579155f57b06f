from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.serve.turns import Turns, Waiting


def waiting(sender, text=b""):
    return Waiting(text, sender, "test")


def test_clients_take_turns():
    turns = Turns(9)
    for sender, text in ((1, b"a"), (1, b"b"), (1, b"c"), (2, b"d"), (3, b"e"), (2, b"f")):
        turns.add(waiting(sender, text))
    assert b"".join(turns.next().text for _ in range(6)) == b"adebfc"
    assert turns.next() is None


def test_one_client_may_have_so_many_only():
    turns = Turns(2)
    assert [turns.add(waiting(1)) for _ in range(3)] == [True, True, False]
    assert turns.add(waiting(2))
    assert len(turns) == 3


def test_who_waits_is_known_until_nobody_does():
    turns = Turns(2)
    turns.add(waiting(7))
    assert 7 in turns
    assert turns.clear() == (waiting(7),)
    assert 7 not in turns
    assert len(turns) == 0


@settings(deadline=None)
@given(st.lists(st.integers(1, 4), max_size=60))
def test_nobody_waits_for_more_than_one_block_of_each_other_client(senders):
    turns = Turns(100)
    for number, sender in enumerate(senders):
        turns.add(waiting(sender, b"%d" % number))
    order = [turns.next().sender for _ in senders]
    for place, sender in enumerate(order):
        before = [k for k in range(place) if order[k] == sender]
        since = order[(before[-1] + 1 if before else 0) : place]
        assert len(since) == len(set(since))
    assert sorted(order) == sorted(senders)
