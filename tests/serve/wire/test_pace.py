"""Fair reads: busy connections take turns, others never wait."""

import asyncio

import pytest

from kinesic.serve.wire import pace, quotas
from kinesic.serve.wire.pace import TURN_PERIOD, ReadPace
from kinesic.serve.wire.quotas import TokenBucket


@pytest.fixture
def waits(monkeypatch):
    """Recorded delays; simulated time advances only when all connections wait."""
    results = []
    release = asyncio.Event()

    async def sleep(seconds):
        results.append(seconds)
        await release.wait()

    monkeypatch.setattr(pace, "sleep", sleep)
    monkeypatch.setattr(quotas, "monotonic", lambda: 0.0)
    results.append(release)
    return results


def test_connection_reads_within_their_burst_do_not_wait(waits):
    async def read():
        for _ in range(3):
            await ReadPace().await_turn(TokenBucket(1.0, 3))

    asyncio.run(read())
    assert waits[1:] == []


def test_delay_between_reads_grows_with_the_number_of_busy_connections(waits):
    async def read():
        release, shared = waits.pop(0), ReadPace()
        spent = [TokenBucket(100.0, 1) for _ in range(20)]
        for bucket in spent:
            await shared.await_turn(bucket)
        assert waits == []
        readers = [asyncio.create_task(shared.await_turn(bucket)) for bucket in spent]
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        await shared.await_turn(TokenBucket(100.0, 1))  # a quiet connection at the same time
        release.set()
        await asyncio.gather(*readers)

    asyncio.run(read())
    assert waits == [max(0.01, TURN_PERIOD * number) for number in range(1, 21)]


def test_busy_connections_get_two_hundred_reads_per_second_in_total(monkeypatch):
    """For 100 connections over 20 s: after the first bursts, a turn starts no new burst."""
    seconds, burst, connections = 20.0, 20, 100
    loop = asyncio.new_event_loop()
    now = [loop.time()]

    def skip(timeout: float | None) -> list[object]:
        now[0] += timeout or 0.0
        return []

    monkeypatch.setattr(loop, "time", lambda: now[0])
    monkeypatch.setattr(loop._selector, "select", skip)
    monkeypatch.setattr(quotas, "monotonic", lambda: now[0])
    reads, end, shared = [], now[0] + seconds, ReadPace()

    async def read():
        bucket = TokenBucket(50.0, burst)
        while now[0] < end:
            await shared.await_turn(bucket)
            reads.append(now[0])

    async def read_all():
        await asyncio.gather(*(read() for _ in range(connections)))

    loop.run_until_complete(read_all())
    loop.close()
    assert len(reads) <= connections * burst + 1.1 * seconds / TURN_PERIOD
    assert len(reads) >= connections * burst + 0.8 * seconds / TURN_PERIOD
