"""`kinesic mcp` as a process of its own, and clients of the official package over both transports."""

import asyncio
import socket
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager, contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from threading import Thread
from time import monotonic

from kinesic.serve.priority import urgent

COMMAND = (sys.executable, "-m", "kinesic", "mcp", "--voice", "durations")
PENDING_CALLS = 50
LONG_TEXT = "It was a large and heavy thing, and nobody knew what to do about it. " * 25
MAX_START_TIME = 120.0  # [s]
MAX_STOP_LATENCY = 0.1  # [s]


@dataclass(frozen=True)
class StopTiming:
    """A stop that was sent while other calls were pending."""

    latency: float  # [s] from the call to its answer
    pending: int  # calls without an answer when the stop was sent
    refusals: tuple[str, ...]  # of these calls, afterwards


def text_of(result) -> str:
    """The text of a tool's answer."""
    return "".join(each.text for each in result.content)


@contextmanager
def http_server(*options: str) -> Iterator[str]:
    """Serve tools over HTTP on a free port of the loopback; gives the URL."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{free.getsockname()[1]}"
    with subprocess.Popen([*COMMAND, "--http", address, *options], stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            begun = monotonic()
            for line in process.stderr:
                if line.startswith("tools at"):
                    break
                assert monotonic() - begun < MAX_START_TIME
            Thread(target=process.stderr.read, daemon=True).start()
            _wait_until_open(address)
            yield f"http://{address}/mcp"
        finally:
            process.terminate()
            process.wait(60)


def _wait_until_open(address: str) -> None:
    host, _, port = address.rpartition(":")
    end = monotonic() + MAX_START_TIME
    while monotonic() < end:
        try:
            socket.create_connection((host, int(port)), 1.0).close()
        except OSError:
            continue
        return
    raise AssertionError(f"nobody listens at {address}")


def stdio_client(folder: Path) -> AbstractAsyncContextManager:
    """A client that starts the server by itself."""
    mcp = import_module("mcp")
    return mcp.Client(mcp.StdioServerParameters(command=COMMAND[0], args=list(COMMAND[1:]), cwd=folder))


def http_client(url: str, *, mode: str = "legacy") -> AbstractAsyncContextManager:
    """A client over HTTP; `legacy` opens a session, as most programs do."""
    return import_module("mcp").Client(url, mode=mode)


@asynccontextmanager
async def many_clients(url: str, count: int) -> AsyncIterator[list]:
    """As many clients over HTTP, each with a session of its own."""
    async with http_client(url) as client:
        if count == 1:
            yield [client]
        else:
            async with many_clients(url, count - 1) as others:
                yield [client, *others]


async def time_stops(stopper, callers, *, count: int) -> list[StopTiming]:
    """Measure stops one after the other, after one that is not counted."""
    with urgent():  # as the server, so that other work of the machine is not measured
        timings = [await _time_stop(stopper, callers, round_number=k) for k in range(count + 1)]
    return timings[1:]


async def _time_stop(stopper, callers, *, round_number: int) -> StopTiming:
    """Send 50 calls that move the robot, measure a stop, and resume."""
    calls = []
    for k in range(PENDING_CALLS):
        caller, name = callers[k % len(callers)], f"r{round_number}-{k}"
        if k % 2:
            arguments = {"document": {"id": name, "behaviours": [{"type": "speech", "id": "s", "text": [LONG_TEXT]}]}}
            calls.append(asyncio.create_task(caller.call_tool("perform", arguments)))
        else:
            calls.append(asyncio.create_task(caller.call_tool("say", {"text": LONG_TEXT})))
    for caller in callers:
        await caller.list_tools()  # answered when the calls before it have been read
    pending = sum(not call.done() for call in calls)
    begun = monotonic()
    await stopper.call_tool("stop", {})
    latency = monotonic() - begun
    answers = await asyncio.gather(*calls)
    await stopper.call_tool("resume", {})
    return StopTiming(latency, pending, tuple(text_of(each) for each in answers if each.is_error))
