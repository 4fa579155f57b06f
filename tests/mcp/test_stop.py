"""Emergency stops of tool servers in separate processes during pending calls."""

import asyncio
import json
import os
import threading
from contextlib import AsyncExitStack
from importlib.util import find_spec
from pathlib import Path

import pytest

from .test_server import STORY
from .tool_servers import (
    MAX_STOP_LATENCY,
    PENDING_CALLS,
    StopTiming,
    children_of,
    command_lines,
    find_server,
    http_server,
    is_running,
    many_clients,
    stdio_client,
    text_of,
    time_stops,
    wait_for,
)

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(find_spec("mcp") is None, reason="pip install 'kinesic[mcp]'"),
    pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs the /proc of Linux"),
]

TOKEN = "open-sesame-1234"
FEW_STOPS = 3  # number of emergency stops in every run; `make soak` tests 100


def judge(timings: list[StopTiming]) -> None:
    for each in timings:
        assert min(each.pending, len(each.refusals)) >= PENDING_CALLS
        assert all("an emergency stop" in refusal for refusal in each.refusals), each.refusals
    latencies = sorted(timing.latency for timing in timings)
    assert latencies[len(latencies) // 2] <= MAX_STOP_LATENCY


def test_mcp_server_on_stdio_stops_at_once_hides_its_token_and_ends_with_its_client(tmp_path: Path):
    async def run() -> tuple[list[str], list[StopTiming], int, list[bytes]]:
        async with stdio_client(tmp_path, "--token", TOKEN) as client:
            calls = (("perform", {"document": STORY}), ("stop", {}), ("resume", {}))
            answers = [text_of(await client.call_tool(name, arguments)) for name, arguments in calls]
            timings = await time_stops(client, [client], count=FEW_STOPS)
            tools = next(filter(find_server, children_of(os.getpid())))
            return answers, timings, find_server(tools), command_lines(tools)

    answers, timings, server, lines = asyncio.run(run())
    wait_for(lambda: not is_running(server))
    assert sum(b"\0serve\0" in line for line in lines) == 1
    assert not [line for line in lines if TOKEN.encode() in line]
    assert json.loads(answers[0])["block"] == "story1"
    assert answers[1:] == ["stopped", "resumed"]
    assert threading.active_count() < 50
    judge(timings)


@pytest.mark.soak
def test_http_stop_is_not_delayed_by_fifty_calls_of_other_clients():
    async def run(url: str) -> list[StopTiming]:
        async with AsyncExitStack() as opened:
            clients = await opened.enter_async_context(many_clients(url, 5))
            return await time_stops(clients[0], clients[1:], count=FEW_STOPS)

    with http_server() as url:
        judge(asyncio.run(run(url)))
