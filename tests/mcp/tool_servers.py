"""`kinesic mcp` in separate processes, with official clients over both transports."""

import asyncio
import socket
import subprocess
import sys
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager, contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from threading import Thread
from time import monotonic, sleep

from kinesic.serve.priority import raise_priority

COMMAND = (sys.executable, "-m", "kinesic", "mcp", "--voice", "durations")
PENDING_CALLS = 50  # smallest number of pending calls at each stop
SENT_CALLS = 60  # number of calls sent before each stop; a few of these calls are answered before the stop
LONG_TEXT = "It was a large and heavy thing, and nobody knew what to do about it. " * 25
MAX_START_TIME = 120.0  # [s] longest start of a server
MAX_STOP_LATENCY = 0.1  # [s] longest time from the stop call to its answer
MAX_END_DELAY = 12.0  # [s] longest time until a server ends; it would be killed later


@dataclass(frozen=True)
class StopTiming:
    """Timing of a stop during pending calls."""

    latency: float  # [s] time from the stop call to its answer
    pending: int  # calls without an answer when the stop was sent
    refusals: tuple[str, ...]  # answers to the pending calls


def text_of(result) -> str:
    """Return the text of a tool's answer."""
    return "".join(item.text for item in result.content)


@contextmanager
def http_server(*options: str) -> Iterator[str]:
    """Serve tools over HTTP on a free loopback port and yield the URL."""
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


def stdio_client(folder: Path, *options: str) -> AbstractAsyncContextManager:
    """Open a client that starts the server itself."""
    mcp = import_module("mcp")
    return mcp.Client(mcp.StdioServerParameters(command=COMMAND[0], args=[*COMMAND[1:], *options], cwd=folder))


def http_client(url: str, *, mode: str = "legacy") -> AbstractAsyncContextManager:
    """Open an HTTP client; `legacy` opens a session, as most programs do."""
    return import_module("mcp").Client(url, mode=mode)


@asynccontextmanager
async def many_clients(url: str, count: int) -> AsyncIterator[list]:
    """Open a number of HTTP clients, each with a session."""
    async with http_client(url) as client:
        if count == 1:
            yield [client]
        else:
            async with many_clients(url, count - 1) as others:
                yield [client, *others]


async def time_stops(stopper, callers, *, count: int) -> list[StopTiming]:
    """Measure the timing of successive stops, without the first stop."""
    with raise_priority():  # same priority as the server, so that other processes do not distort the timing
        timings = [await _time_stop(stopper, callers, round_number=k) for k in range(count + 1)]
    return timings[1:]


async def _time_stop(stopper, callers, *, round_number: int) -> StopTiming:
    """Send moving calls, measure a stop, and resume."""
    calls = []
    for k in range(SENT_CALLS):
        caller, name = callers[k % len(callers)], f"r{round_number}-{k}"
        if k % 2:
            arguments = {"document": {"id": name, "behaviours": [{"type": "speech", "id": "s", "text": [LONG_TEXT]}]}}
            calls.append(asyncio.create_task(caller.call_tool("perform", arguments)))
        else:
            calls.append(asyncio.create_task(caller.call_tool("say", {"text": LONG_TEXT})))
    for caller in callers:
        await caller.list_tools()  # answered after the previous calls were read
    pending = sum(not call.done() for call in calls)
    begun = monotonic()
    await stopper.call_tool("stop", {})
    latency = monotonic() - begun
    answers = await asyncio.gather(*calls)
    await stopper.call_tool("resume", {})
    return StopTiming(latency, pending, tuple(text_of(answer) for answer in answers if answer.is_error))


def find_server(process: int) -> int:
    """Return the process id of the serving child, or 0."""
    serving = (child for child in children_of(process) if b"--listen" in Path(f"/proc/{child}/cmdline").read_bytes())
    return next(serving, 0)


def children_of(process: int) -> list[int]:
    """Return the child processes of a process."""
    tasks = Path(f"/proc/{process}/task").iterdir()
    return [int(child) for task in tasks for child in (task / "children").read_text().split()]


def command_lines(pid: int) -> list[bytes]:
    """Return the command lines of a process and of all its descendants."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [
        Path(f"/proc/{pid}/cmdline").read_bytes(),
        *(command_line for child in children for command_line in command_lines(int(child))),
    ]


def is_running(process: int) -> bool:
    """Return whether a process has not ended."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def wait_for(condition: Callable[[], int]) -> int:
    """Wait until a condition holds."""
    until = monotonic() + MAX_END_DELAY
    while not (conditioned := condition()):
        assert monotonic() < until
        sleep(0.05)
    return conditioned
