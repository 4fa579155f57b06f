import asyncio

from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.realizer.request import Message
from kinesic.serve.messages import Words
from kinesic.serve.queues import MINOR, MOST_TEXT, FairQueue, OutputQueue, UnreadMemory


def waiting(sender, text=b""):
    return Message(text, sender, "test")


def test_clients_take_turns():
    turns = FairQueue(9)
    for sender, text in ((1, b"a"), (1, b"b"), (1, b"c"), (2, b"d"), (3, b"e"), (2, b"f")):
        turns.add(waiting(sender, text))
    assert b"".join(turns.next().text for _ in range(6)) == b"adebfc"
    assert turns.next() is None


def test_one_client_may_have_so_many_only():
    turns = FairQueue(2)
    assert [turns.add(waiting(1)) for _ in range(3)] == [True, True, False]
    assert turns.add(waiting(2))
    assert len(turns) == 3


def test_who_waits_is_known_until_nobody_does():
    turns = FairQueue(2)
    turns.add(waiting(7))
    assert 7 in turns
    assert turns.clear() == (waiting(7),)
    assert 7 not in turns
    assert len(turns) == 0


def test_words_that_wait_are_joined_until_their_talk_ends():
    turns = FairQueue(3)
    for each in (
        Words("He", 1),
        Words("llo", 1),
        Words("!", 1, ends=True),
        Words("No", 1),
        Words("Yes", 1, instead=True),
    ):
        assert turns.add(each)
    assert not turns.add(Words("x", 1, instead=True))
    assert [(each.text, each.ends, each.instead) for each in iter(turns.next, None)] == [
        ("Hello!", True, False),
        ("No", False, False),
        ("Yes", False, True),
    ]


def test_words_are_not_joined_with_documents_nor_without_end():
    turns = FairQueue(2)
    assert turns.add(Words("a", 1))
    assert turns.add(waiting(1, b"<bml/>"))
    assert not turns.add(Words("b", 1))
    assert turns.add(Words("x" * MOST_TEXT, 2))
    assert turns.add(Words("y", 2))
    assert len(turns) == 4
    assert turns.add(Words("x" * (MOST_TEXT - 1), 3))
    assert turns.add(Words("y", 3))
    assert len(turns) == 5, "so many letters are joined"


@settings(deadline=None)
@given(st.lists(st.integers(1, 4), max_size=60))
def test_nobody_waits_for_more_than_one_block_of_each_other_client(senders):
    turns = FairQueue(100)
    for number, sender in enumerate(senders):
        turns.add(waiting(sender, b"%d" % number))
    order = [turns.next().sender for _ in senders]
    for place, sender in enumerate(order):
        before = [k for k in range(place) if order[k] == sender]
        since = order[(before[-1] + 1 if before else 0) : place]
        assert len(since) == len(set(since))
    assert sorted(order) == sorted(senders)


def drained(queue):
    async def all_of_them():
        queue.end()
        return [message async for message in _messages(queue)]

    return asyncio.run(all_of_them())


async def _messages(queue):
    while (message := await queue.take()) is not None:
        yield message


def test_messages_come_in_order():
    queue = OutputQueue(3, 100_000, UnreadMemory(100_000))
    for message in "abc":
        queue.put(message)
    assert drained(queue) == ["a", "b", "c"]


def test_of_too_many_the_oldest_minor_ones_go_first_and_the_loss_is_told():
    queue = OutputQueue(3, 100_000, UnreadMemory(100_000))
    for message in ("first", f"{MINOR} 1", f"{MINOR} 2", "second", "third", "fourth"):
        queue.put(message)
    told, *left = drained(queue)
    assert "3 messages were dropped" in told
    assert left == ["second", "third", "fourth"]


def test_it_never_holds_more_than_it_may():
    queue = OutputQueue(5, 100_000, UnreadMemory(100_000))
    for number in range(1000):
        queue.put(str(number))
    assert len(queue) == 5


def test_it_never_takes_more_memory_than_it_may():
    queue, document = (
        OutputQueue(512, 1_000_000, UnreadMemory(1_000_000)),
        "\U0001f600" + "x" * 49_999,
    )  # 200 kB in memory
    for number in range(100):
        queue.put(document + str(number))
    assert len(queue) == 4
    told, *left = drained(queue)
    assert "96 messages were dropped" in told
    assert [each[-2:] for each in left] == ["96", "97", "98", "99"]


def test_a_message_that_is_larger_than_all_may_be_is_kept_alone():
    queue = OutputQueue(5, 1000, UnreadMemory(1000))
    queue.put("small")
    queue.put("x" * 2000)
    assert drained(queue)[1:] == ["x" * 2000]


def test_one_that_waits_gets_what_comes():
    async def both():
        queue = OutputQueue(2, 100_000, UnreadMemory(100_000))
        waiting = asyncio.create_task(queue.take())
        await asyncio.sleep(0)
        queue.put("late")
        return await waiting

    assert asyncio.run(both()) == "late"


def test_nothing_goes_in_after_the_end():
    queue = OutputQueue(2, 100_000, UnreadMemory(100_000))
    queue.end()
    queue.put("a")
    assert drained(queue) == []


def test_all_clients_together_take_no_more_memory_than_they_may_and_who_has_most_to_read_loses():
    memory = UnreadMemory(1_000_000)
    slow, quick = OutputQueue(512, 900_000, memory), OutputQueue(512, 900_000, memory)
    quick.put("kept")
    for number in range(17):
        slow.put("x" * 49_000 + str(number))
    others = [OutputQueue(512, 900_000, memory) for _ in range(20)]
    for queue in others:
        queue.put("y" * 49_000)
        assert memory.bytes <= 1_000_000
    assert drained(quick) == ["kept"]
    told, *_ = drained(slow)
    assert "17 messages were dropped" in told
    assert sum(map(len, others)) >= 19


def test_a_client_that_leaves_gives_its_memory_back():
    memory = UnreadMemory(100_000)
    gone, here = OutputQueue(512, 100_000, memory), OutputQueue(512, 100_000, memory)
    gone.put("x" * 90_000)
    gone.discard()
    assert memory.bytes == 0
    here.put("y" * 90_000)
    assert drained(here) == ["y" * 90_000]
    assert memory.bytes == 0
