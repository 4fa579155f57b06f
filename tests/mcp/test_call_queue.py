"""Queue of moving calls: order, limits, stops and disconnected clients."""

import asyncio
from collections.abc import Awaitable, Callable
from time import monotonic

import pytest

from kinesic.mcp.call_queue import MAX_CALLS, MIN_CALL_INTERVAL, REFUSAL_DELAY, CallQueue, request_end
from kinesic.mcp.errors import RefusedError
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS


class Calls:
    """Tool calls that wait for their turn and end when the test allows it."""

    def __init__(self, queue: CallQueue) -> None:
        self.queue, self.began, self.ended = queue, [], []
        self.may_end = asyncio.Event()

    def start(self, name: str) -> asyncio.Task[str]:
        return asyncio.create_task(self.queue.run(lambda: self._act(name)))

    async def _act(self, name: str) -> str:
        async with self.queue.turn():
            self.began.append(name)
            await self.may_end.wait()
            self.ended.append(name)
        return name


def during(act: Callable[[Calls], Awaitable[None]], **settings: float) -> None:
    async def run() -> None:
        await act(Calls(CallQueue(**{"interval": 0.0, "refusal_delay": 0.0, **settings})))

    asyncio.run(asyncio.wait_for(run(), 20))


async def settle() -> None:
    for _ in range(20):
        await asyncio.sleep(0)


async def is_refused(call: asyncio.Task[str], reason: str) -> None:
    with pytest.raises(RefusedError, match=reason):
        await call


def test_tool_calls_run_sequentially_in_order_of_arrival():
    async def act(calls: Calls) -> None:
        tasks = [calls.start(name) for name in "abc"]
        await settle()
        assert calls.began == ["a"]
        calls.may_end.set()
        assert await asyncio.gather(*tasks) == ["a", "b", "c"]
        assert calls.ended == ["a", "b", "c"]

    during(act)


def test_full_queue_of_tool_calls_refuses_a_call_at_once_with_the_pending_count_and_a_remedy():
    async def act(calls: Calls) -> None:
        tasks = [calls.start(str(k)) for k in range(3)]
        await settle()
        await is_refused(calls.start("more"), r"^3 calls .* are pending.*wait for their answers.*or call stop")
        calls.may_end.set()
        await asyncio.gather(*tasks)
        assert await calls.start("later") == "later"

    during(act, max_calls=3)


def test_queue_of_tool_calls_holds_64_calls_sent_at_less_than_half_the_server_rate_limit():
    assert MAX_CALLS == 64
    assert DEFAULT_QUOTAS.rate > 2 / MIN_CALL_INTERVAL
    assert 0.0 < REFUSAL_DELAY < 1.0


def test_cancelled_tool_call_is_removed_from_the_queue():
    async def act(calls: Calls) -> None:
        first, second = calls.start("a"), calls.start("b")
        await settle()
        second.cancel()
        await settle()
        third = calls.start("c")  # uses the free place of the second
        first.cancel()
        await settle()
        assert calls.began == ["a", "c"]
        calls.may_end.set()
        assert await third == "c"
        for item in (first, second):
            with pytest.raises(asyncio.CancelledError):
                await item

    during(act, max_calls=2)


def test_discarding_the_queue_refuses_the_running_and_the_pending_tool_calls():
    async def act(calls: Calls) -> None:
        tasks = [calls.start(name) for name in "abc"]
        await settle()
        calls.queue.discard("stopped")
        calls.may_end.set()
        for task in tasks:
            await is_refused(task, "^stopped$")
        assert (calls.began, calls.ended) == (["a"], [])
        assert await calls.start("d") == "d"

    during(act)


def test_discarded_tool_calls_free_the_full_queue_and_may_be_refused_before_the_refusal_delay():
    async def act(calls: Calls) -> None:
        tasks = [calls.start(name) for name in "ab"]
        await settle()
        begun = monotonic()
        calls.queue.discard("stopped")
        calls.may_end.set()
        assert await calls.start("c") == "c"
        assert calls.ended == ["c"]
        for task in tasks:
            await is_refused(task, "^stopped$")
        assert monotonic() - begun < 5.0

    during(act, max_calls=2, refusal_delay=10.0)


def test_discarded_tool_call_that_never_takes_its_turn_is_refused_after_the_refusal_delay():
    async def act(calls: Calls) -> None:
        async def endless() -> str:
            await asyncio.Event().wait()
            return ""

        call = asyncio.create_task(calls.queue.run(endless))
        await settle()
        begun = monotonic()
        calls.queue.discard("stopped")
        await is_refused(call, "stopped")
        assert monotonic() - begun >= 0.05

    during(act, refusal_delay=0.05)


def test_tool_call_discarded_twice_reports_the_first_reason():
    async def act(calls: Calls) -> None:
        tasks = [calls.start(name) for name in "ab"]
        await settle()
        calls.queue.discard("first")
        calls.queue.discard("second")
        for task in tasks:
            await is_refused(task, "^first$")

    during(act)


def test_tool_call_of_a_disconnected_client_is_cancelled():
    async def act(calls: Calls) -> None:
        first = calls.start("a")
        end = asyncio.get_running_loop().create_future()
        request_end.set(end)
        second = calls.start("b")
        await settle()
        end.set_result(None)
        await is_refused(second, "client is gone")
        calls.may_end.set()
        assert await first == "a"
        assert calls.began == ["a"]

    during(act)


def test_http_request_end_after_the_tool_answer_has_no_effect():
    async def act(calls: Calls) -> None:
        end = asyncio.get_running_loop().create_future()
        request_end.set(end)
        calls.may_end.set()
        assert await calls.start("a") == "a"
        request_end.set(None)
        end.set_result(None)
        await settle()
        assert await calls.start("b") == "b"

    during(act)


def test_three_tool_calls_take_at_least_two_call_intervals():
    async def act(calls: Calls) -> None:
        calls.may_end.set()
        begun = monotonic()
        await asyncio.gather(*(calls.start(name) for name in "abc"))
        assert monotonic() - begun >= 0.1

    during(act, interval=0.05)


def test_tool_call_after_a_failed_one_still_runs():
    async def act(calls: Calls) -> None:
        async def fail() -> str:
            async with calls.queue.turn():
                raise RefusedError("no BML")

        calls.may_end.set()
        with pytest.raises(RefusedError, match="no BML"):
            await calls.queue.run(fail)
        assert await calls.start("a") == "a"

    during(act)
