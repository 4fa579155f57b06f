import asyncio
from sys import getsizeof

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.realizer.request import Message
from kinesic.serve.messages import Words
from kinesic.serve.queues import PROGRESS_PREFIX, FairQueue, OutputQueue, UnreadMemory


def waiting(sender, text=b""):
    return Message(text, sender, "test")


def test_queued_documents_of_several_clients_alternate():
    turns = FairQueue(9)
    for sender, text in ((1, b"a"), (1, b"b"), (1, b"c"), (2, b"d"), (3, b"e"), (2, b"f")):
        turns.add(waiting(sender, text))
    assert b"".join(turns.next().text for _ in range(6)) == b"adebfc"
    assert turns.next() is None


def test_queued_documents_per_client_are_limited():
    turns = FairQueue(2)
    assert [turns.add(waiting(1)) for _ in range(3)] == [True, True, False]
    assert turns.add(waiting(2))
    assert len(turns) == 3


def test_document_queue_contains_a_client_until_it_is_cleared():
    turns = FairQueue(2)
    turns.add(waiting(7))
    assert 7 in turns
    assert turns.clear() == (waiting(7),)
    assert 7 not in turns
    assert len(turns) == 0


def test_queued_words_of_a_streamed_text_are_joined_until_the_text_ends():
    turns = FairQueue(3)
    for entry in (
        Words("He", 1),
        Words("llo", 1),
        Words("!", 1, ends=True),
        Words("No", 1),
        Words("Yes", 1, instead=True),
    ):
        assert turns.add(entry)
    assert not turns.add(Words("x", 1, instead=True))
    assert [(item.text, item.ends, item.instead) for item in iter(turns.next, None)] == [
        ("Hello!", True, False),
        ("No", False, False),
        ("Yes", False, True),
    ]


def test_queued_words_are_not_joined_with_documents_or_beyond_the_length_limit():
    turns = FairQueue(2)
    assert turns.add(Words("a", 1))
    assert turns.add(waiting(1, b"<bml/>"))
    assert not turns.add(Words("b", 1))
    assert turns.add(Words("x" * 1_000_000, 2))
    assert turns.add(Words("y", 2))
    assert len(turns) == 4
    assert turns.add(Words("x" * 999_999, 3))
    assert turns.add(Words("y", 3))
    assert len(turns) == 5, "so many letters are joined"


@settings(deadline=None)
@given(st.lists(st.integers(1, 4), max_size=60))
def test_queued_client_waits_for_at_most_one_block_of_each_other_client(senders):
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


def test_messages_queued_for_a_client_keep_their_order():
    queue = OutputQueue(3, 100_000, UnreadMemory(100_000))
    for message in "abc":
        queue.put(message)
    assert drained(queue) == ["a", "b", "c"]


def test_oldest_progress_messages_are_dropped_first_and_reported():
    queue = OutputQueue(3, 100_000, UnreadMemory(100_000))
    for message in ("first", f"{PROGRESS_PREFIX} 1", f"{PROGRESS_PREFIX} 2", "second", "third", "fourth"):
        queue.put(message)
    result, *left = drained(queue)
    assert "3 messages were dropped" in result
    assert left == ["second", "third", "fourth"]


def test_output_queue_respects_its_message_limit():
    queue = OutputQueue(5, 100_000, UnreadMemory(100_000))
    for number in range(1000):
        queue.put(str(number))
    assert len(queue) == 5


def test_output_queue_respects_its_memory_limit():
    queue, document = (
        OutputQueue(512, 1_000_000, UnreadMemory(1_000_000)),
        "\U0001f600" + "x" * 49_999,
    )  # 200 kB in memory
    for number in range(100):
        queue.put(document + str(number))
    assert len(queue) == 4
    result, *left = drained(queue)
    assert "96 messages were dropped" in result
    assert [item[-2:] for item in left] == ["96", "97", "98", "99"]


@pytest.mark.parametrize(("spare", "count"), [(0, 2), (-1, 1)])
def test_output_queue_keeps_messages_that_exactly_fill_its_memory_limit(spare, count):
    size = getsizeof("message")
    queue = OutputQueue(5, 2 * size + spare, UnreadMemory(1000))
    for _ in range(3):
        queue.put("message")
    assert len(queue) == count


def test_output_queue_keeps_a_single_message_above_its_memory_limit():
    queue = OutputQueue(5, 1000, UnreadMemory(1000))
    queue.put("small")
    queue.put("x" * 2000)
    assert drained(queue)[1:] == ["x" * 2000]


def test_waiting_reader_of_an_output_queue_gets_the_next_message():
    async def both():
        queue = OutputQueue(2, 100_000, UnreadMemory(100_000))
        waiting = asyncio.create_task(queue.take())
        await asyncio.sleep(0)
        queue.put("late")
        return await waiting

    assert asyncio.run(both()) == "late"


def test_ended_output_queue_accepts_no_messages():
    queue = OutputQueue(2, 100_000, UnreadMemory(100_000))
    queue.end()
    queue.put("a")
    assert drained(queue) == []


def test_total_memory_limit_drops_messages_of_the_largest_queue():
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
    result, *_ = drained(slow)
    assert "17 messages were dropped" in result
    assert sum(map(len, others)) >= 19


def test_memory_of_unread_messages_is_released_when_a_client_leaves():
    memory = UnreadMemory(100_000)
    gone, here = OutputQueue(512, 100_000, memory), OutputQueue(512, 100_000, memory)
    gone.put("x" * 90_000)
    gone.discard()
    assert memory.bytes == 0
    here.put("y" * 90_000)
    assert drained(here) == ["y" * 90_000]
    assert memory.bytes == 0
