"""Emergency stops by MCP clients during fifty pending calls."""

import asyncio
from collections.abc import Callable, Coroutine
from importlib.util import find_spec
from pathlib import Path

import pytest

from ..mcp.tool_servers import (
    MAX_STOP_LATENCY,
    PENDING_CALLS,
    StopTiming,
    http_client,
    http_server,
    many_clients,
    stdio_client,
    time_stops,
)

pytestmark = [
    pytest.mark.soak,
    pytest.mark.realtime,
    pytest.mark.skipif(find_spec("mcp") is None, reason="pip install 'kinesic[mcp]'"),
]

STOP_COUNT = 100


async def over_stdio(folder: Path) -> list[StopTiming]:
    async with stdio_client(folder) as client:
        return await time_stops(client, [client], count=STOP_COUNT)


async def over_http_sessions(_folder: Path) -> list[StopTiming]:
    with http_server() as url:
        async with many_clients(url, 5) as clients:
            return await time_stops(clients[0], clients[1:], count=STOP_COUNT)


async def over_http_without_session(_folder: Path) -> list[StopTiming]:
    with http_server() as url:
        async with http_client(url, mode="auto") as client:
            return await time_stops(client, [client], count=STOP_COUNT)


@pytest.mark.parametrize("transport", [over_stdio, over_http_sessions, over_http_without_session])
def test_99_percent_of_emergency_stops_of_mcp_clients_are_answered_within_0_1_s(
    transport: Callable[[Path], Coroutine[None, None, list[StopTiming]]],
    tmp_path: Path,
    record_property: Callable[[str, object], None],
):
    timings = asyncio.run(transport(tmp_path))
    latencies = sorted(timing.latency for timing in timings)
    record_property("latencies_ms", [round(1e3 * latency, 1) for latency in latencies])
    assert min(min(timing.pending, len(timing.refusals)) for timing in timings) >= PENDING_CALLS
    assert latencies[-2] <= MAX_STOP_LATENCY, f"p99 of {STOP_COUNT}"
