"""Dedicated connections: joint requests and replacement of broken connections."""

import asyncio
from collections.abc import Callable
from threading import Event
from time import monotonic

import pytest

from kinesic.mcp.direct_line import DirectLine


class Wire:
    """Stub connection that counts requests and fails as scripted."""

    def __init__(self, number: int) -> None:
        self.number, self.closed = number, False

    def close(self) -> None:
        self.closed = True


class Server:
    """Record of opened connections and requests."""

    def __init__(self, *, failures: int = 0, interval: float = 0.0) -> None:
        self.wires: list[Wire] = []
        self.times: list[float] = []
        self.failures, self.may_answer = failures, Event()
        self.may_answer.set()
        self.line = DirectLine(self.connect, self.request, name="test", interval=interval)

    def connect(self) -> Wire:
        self.wires.append(Wire(len(self.wires)))
        return self.wires[-1]

    def request(self, wire: Wire) -> int:
        self.times.append(monotonic())
        assert self.may_answer.wait(12)
        if self.failures:
            self.failures -= 1
            raise ConnectionError(f"wire {wire.number} is broken")
        return wire.number


def becomes(condition: Callable[[], bool]) -> bool:
    end = monotonic() + 20
    while not condition() and monotonic() < end:
        pass
    return condition()


def test_callers_that_wait_for_a_running_server_request_use_one_common_next_request():
    server = Server()

    async def run() -> None:
        server.may_answer.clear()
        first = asyncio.create_task(server.line.request())
        await asyncio.sleep(0)
        assert becomes(lambda: len(server.times) == 1)
        others = [asyncio.create_task(server.line.request()) for _ in range(50)]
        await asyncio.sleep(0.05)
        assert len(server.times) == 1  # one request at a time
        server.may_answer.set()
        assert await asyncio.gather(first, *others) == [0] * 51
        assert len(server.times) == 2  # later callers do not get the first result
        assert await server.line.request() == 0
        assert len(server.times) == 3

    asyncio.run(run())


def test_server_request_of_a_cancelled_caller_is_still_executed():
    server = Server()

    async def run() -> None:
        server.may_answer.clear()
        first = asyncio.create_task(server.line.request())
        await asyncio.sleep(0)
        assert becomes(lambda: len(server.times) == 1)
        second = asyncio.create_task(server.line.request())
        await asyncio.sleep(0)
        second.cancel()
        server.may_answer.set()
        await first
        assert becomes(lambda: len(server.times) == 2)

    asyncio.run(run())


def test_broken_server_connection_is_replaced_once_per_request():
    server = Server(failures=1)
    assert asyncio.run(server.line.request()) == 1
    assert [wire.closed for wire in server.wires] == [True, False]
    assert asyncio.run(server.line.request()) == 1
    server.failures = 2
    with pytest.raises(ConnectionError, match="wire 2"):
        asyncio.run(server.line.request())
    assert [wire.closed for wire in server.wires] == [True, True, True]
    assert asyncio.run(server.line.request()) == 3


def test_requests_to_the_robot_server_start_at_least_one_interval_apart():
    server = Server(interval=0.05)
    for _ in range(3):
        asyncio.run(server.line.request())
    first, second, third = server.times
    assert second - first >= 0.049
    assert third - second >= 0.049


def test_closing_a_direct_line_closes_its_server_connections():
    server = Server()
    server.line.close()
    assert server.wires[0].closed
    with pytest.raises(RuntimeError):
        asyncio.run(server.line.request())
    broken = Server(failures=2)
    with pytest.raises(ConnectionError):
        asyncio.run(broken.line.request())
    broken.line.close()
    assert all(wire.closed for wire in broken.wires)


def test_failure_to_open_a_connection_to_the_robot_server_is_raised():
    def connect() -> Wire:
        raise ConnectionRefusedError("nobody is there")

    with pytest.raises(ConnectionRefusedError, match="nobody"):
        DirectLine(connect, lambda wire: wire.number, name="test")


def test_closing_a_server_connection_does_not_wait_for_a_running_request():
    server = Server()

    async def run() -> None:
        server.may_answer.clear()
        request = asyncio.create_task(server.line.request())
        await asyncio.sleep(0)
        assert becomes(lambda: len(server.times) == 1)
        begun = monotonic()
        server.line.close()
        assert monotonic() - begun < 10
        server.may_answer.set()
        await request

    asyncio.run(run())
