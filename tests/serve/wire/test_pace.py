"""Connections that send much are read in turns; one that sends little never waits."""

import asyncio

import pytest

from kinesic.serve.wire import pace, quotas
from kinesic.serve.wire.pace import TURN, Pace
from kinesic.serve.wire.quotas import TokenBucket


@pytest.fixture
def waits(monkeypatch):
    """For how long is waited each time; time itself stands still until all have asked."""
    found = []
    release = asyncio.Event()

    async def sleep(seconds):
        found.append(seconds)
        await release.wait()

    monkeypatch.setattr(pace, "sleep", sleep)
    monkeypatch.setattr(quotas, "monotonic", lambda: 0.0)
    found.append(release)
    return found


def test_a_connection_that_sends_little_never_waits(waits):
    async def read():
        for _ in range(3):
            await Pace().await_turn(TokenBucket(1.0, 3))

    asyncio.run(read())
    assert waits[1:] == []


def test_the_more_send_much_the_longer_each_of_them_waits(waits):
    async def read():
        release, shared = waits.pop(0), Pace()
        spent = [TokenBucket(100.0, 1) for _ in range(20)]
        for bucket in spent:
            await shared.await_turn(bucket)
        assert waits == []
        readers = [asyncio.create_task(shared.await_turn(bucket)) for bucket in spent]
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        await shared.await_turn(TokenBucket(100.0, 1))  # a quiet one, meanwhile
        release.set()
        await asyncio.gather(*readers)

    asyncio.run(read())
    assert waits == [max(0.01, TURN * number) for number in range(1, 21)]


def test_all_that_always_have_something_to_say_are_read_two_hundred_times_a_second_together(monkeypatch):
    """A hundred connections for twenty seconds: the first bursts apart, a turn is no beginning of another burst."""
    seconds, burst, connections = 20.0, 20, 100
    loop = asyncio.new_event_loop()
    now = [loop.time()]

    def skip(timeout: float | None) -> list[object]:
        now[0] += timeout or 0.0
        return []

    monkeypatch.setattr(loop, "time", lambda: now[0])
    monkeypatch.setattr(loop._selector, "select", skip)
    monkeypatch.setattr(quotas, "monotonic", lambda: now[0])
    reads, end, shared = [], now[0] + seconds, Pace()

    async def read():
        bucket = TokenBucket(50.0, burst)
        while now[0] < end:
            await shared.await_turn(bucket)
            reads.append(now[0])

    async def read_all():
        await asyncio.gather(*(read() for _ in range(connections)))

    loop.run_until_complete(read_all())
    loop.close()
    assert len(reads) <= connections * burst + 1.1 * seconds / TURN
    assert len(reads) >= connections * burst + 0.8 * seconds / TURN
