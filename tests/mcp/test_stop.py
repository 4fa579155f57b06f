"""A stop with 50 pending calls, by the clients of the official package, over standard input and over HTTP."""

import asyncio
from contextlib import AsyncExitStack
from importlib.util import find_spec
from pathlib import Path

import pytest

from .tool_servers import (
    MAX_STOP_LATENCY,
    PENDING_CALLS,
    StopTiming,
    http_server,
    many_clients,
    stdio_client,
    time_stops,
)

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(find_spec("mcp") is None, reason="pip install 'kinesic[mcp]'"),
]

FEW_STOPS = 4


def judge(timings: list[StopTiming]) -> None:
    for each in timings:
        assert each.pending == PENDING_CALLS
        assert len(each.refusals) == PENDING_CALLS, "no call that was pending moves the robot"
        assert all("an emergency stop" in refusal for refusal in each.refusals), each.refusals
    latencies = sorted(each.latency for each in timings)
    assert latencies[len(latencies) // 2] <= MAX_STOP_LATENCY


def test_stop_over_standard_input_waits_for_none_of_fifty_calls(tmp_path: Path):
    async def run() -> list[StopTiming]:
        async with stdio_client(tmp_path) as client:
            return await time_stops(client, [client], count=FEW_STOPS)

    judge(asyncio.run(run()))


def test_stop_over_http_waits_for_none_of_fifty_calls_of_other_clients():
    async def run(url: str) -> list[StopTiming]:
        async with AsyncExitStack() as opened:
            clients = await opened.enter_async_context(many_clients(url, 5))
            return await time_stops(clients[0], clients[1:], count=FEW_STOPS)

    with http_server() as url:
        judge(asyncio.run(run(url)))
