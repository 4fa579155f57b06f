import asyncio

from kinesic.serve.outbox import MINOR, Outbox


def drained(outbox):
    async def all_of_them():
        outbox.end()
        return [message async for message in _messages(outbox)]

    return asyncio.run(all_of_them())


async def _messages(outbox):
    while (message := await outbox.take()) is not None:
        yield message


def test_messages_come_in_order():
    outbox = Outbox(3)
    for message in "abc":
        outbox.put(message)
    assert drained(outbox) == ["a", "b", "c"]


def test_of_too_many_the_oldest_minor_ones_go_first_and_the_loss_is_told():
    outbox = Outbox(3)
    for message in ("first", f"{MINOR} 1", f"{MINOR} 2", "second", "third", "fourth"):
        outbox.put(message)
    told, *left = drained(outbox)
    assert "3 messages were dropped" in told
    assert left == ["second", "third", "fourth"]


def test_it_never_holds_more_than_it_may():
    outbox = Outbox(5)
    for number in range(1000):
        outbox.put(str(number))
    assert len(outbox) == 5


def test_one_that_waits_gets_what_comes():
    async def both():
        outbox = Outbox(2)
        waiting = asyncio.create_task(outbox.take())
        await asyncio.sleep(0)
        outbox.put("late")
        return await waiting

    assert asyncio.run(both()) == "late"


def test_nothing_goes_in_after_the_end():
    outbox = Outbox(2)
    outbox.end()
    outbox.put("a")
    assert drained(outbox) == []
