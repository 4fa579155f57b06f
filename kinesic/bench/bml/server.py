"""Benchmark of a running server, measured by connected client programs.

It measures latency, lost blocks and memory growth.

The server runs in a process of its own; clients connect by TCP. A block's first command has been sent when its
blockProgress `start` is reported, so this message's arrival is an upper bound of the latency.
"""

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from math import inf
from pathlib import Path
from tempfile import TemporaryFile
from time import monotonic, sleep
from typing import IO, Literal

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.client import Client

BLOCK_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
LONG_BEHAVIOURS = "".join(
    f'<gesture id="g{k}" lexeme="BEAT" mode="LEFT_HAND" stroke="{1 + 1.5 * k}"/>' for k in range(4)
)
SMALL_BEHAVIOURS = (
    '<head id="h" lexeme="NOD" start="0"/>',
    '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" start="0"/>',
    '<speech id="s"><text>Yes, <sync id="m"/>indeed.</text></speech><head id="h" lexeme="NOD" stroke="s:m"/>',
)
BLOCK_INTERVAL = 1.0  # [s] interval between blocks of the latency measurement
END_TIMEOUT = 5.0  # [s] longest wait for block ends and for the status reply, after the endurance run
POLL_INTERVAL = 0.05  # [s] interval between checks whether the server is listening
ENDURANCE_RATE = 10  # [1/s] block rate of the endurance run
SETTLED_FRACTION = 0.25  # fraction of the endurance run after which the initial memory is measured
MAX_COMMAND_LATENCY = 100.0  # [ms] goal of the 95th percentile of delays from a block to its first command
MAX_FEEDBACK_LATENCY = 20.0  # [ms] goal of the 95th percentile of delays from a block to its first feedback
MAX_MEMORY_GROWTH = 5.0  # [%] goal of the server's memory growth in the endurance run
MEMORY_UNKNOWN = "this system does not report the memory of a process"
LATENCY_BLOCKS = 40  # number of blocks whose latencies are measured
ENDURANCE_SECONDS = 20.0  # [s] duration of the endurance run

Verb = Literal["serve", "studio"]


@dataclass(frozen=True)
class Server:
    """kinesic server in a process of its own."""

    process: subprocess.Popen[bytes]
    port: int

    @property
    def memory(self) -> int | None:
        """Resident memory [bytes] of the server and its children.

        The result is None if not available.
        """
        sizes = [_resident(pid) for pid in _list_process_tree(self.process.pid)]
        return None if not sizes or None in sizes else sum(size for size in sizes if size is not None)


@dataclass(frozen=True)
class FeedbackLatency:
    """Delays from sending a block to its first feedback and start [ms]."""

    feedback: float  # [ms] delay until the block's first feedback
    command: float  # [ms] delay until the block's start


@dataclass(frozen=True)
class Endurance:
    """Result of an endurance run with many blocks per second."""

    sent: int  # number of sent blocks
    lost: int  # number of blocks without a reported end
    growth: float | None  # [%] growth of the memory after it had settled
    late: int  # number of late ticks of the server's loop


def bench() -> list[Metric]:
    """Measure latencies, lost blocks and memory growth of the server."""
    with open_server() as server:
        latencies = measure_latencies(server, LATENCY_BLOCKS)
        run = run_endurance(server, ENDURANCE_SECONDS)
    return [
        _p95("bml.live.first_command_p95", [latency.command for latency in latencies], MAX_COMMAND_LATENCY),
        _p95("bml.live.first_feedback_p95", [latency.feedback for latency in latencies], MAX_FEEDBACK_LATENCY),
        Metric("bml.live.lost", float(run.lost), "blocks", 0.0, "lower", why=f"of {run.sent} blocks"),
        Metric(
            "bml.live.memory",
            run.growth,
            "%",
            MAX_MEMORY_GROWTH,
            "lower",
            why="" if run.growth is not None else MEMORY_UNKNOWN,
        ),
    ]


@contextmanager
def open_server(*options: str, cwd: Path | None = None, verb: Verb = "serve") -> Iterator[Server]:
    """Start a server on a free port and stop it on exit.

    `options` are further options of its command `verb`.
    """
    command = [sys.executable, "-m", "kinesic", verb, "--listen", "127.0.0.1:0", *options]
    with (
        TemporaryFile("w+") as stderr,
        subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=stderr, cwd=cwd) as process,
    ):
        try:
            yield Server(process, _wait_for_port(process, stderr))
        finally:
            process.terminate()


def _wait_for_port(process: subprocess.Popen[bytes], stderr: IO[str]) -> int:
    """Wait until the server reports its port, and return it.

    Raises:
        RuntimeError: the server ended before.
    """
    while True:
        stderr.seek(0)
        text = stderr.read()
        if (port := re.search(r"listening at \S*:(\d+)", text)) is not None:
            return int(port[1])
        if process.poll() is not None:
            raise RuntimeError(f"the server did not open: {text}")
        sleep(POLL_INTERVAL)


def measure_latencies(server: Server, blocks: int) -> list[FeedbackLatency]:
    """Measure latencies of small blocks, one per second, while another block plays."""
    latencies: list[FeedbackLatency] = []
    with Client(port=server.port) as other, Client(port=server.port) as client:
        for k in range(blocks):
            if k % 5 == 0:
                other.send(BLOCK_TEMPLATE.format(f"long{k}", LONG_BEHAVIOURS))
                sleep(BLOCK_INTERVAL)  # until it plays
            began = monotonic()
            while other.receive(0.0):
                pass
            latencies.append(_measure_latency(client, f"small{k}", SMALL_BEHAVIOURS[k % len(SMALL_BEHAVIOURS)]))
            sleep(max(0.0, began + BLOCK_INTERVAL - monotonic()))
    return latencies


def _measure_latency(client: Client, name: str, behaviours: str) -> FeedbackLatency:
    began, first = monotonic(), None
    for message in client.perform(BLOCK_TEMPLATE.format(name, behaviours)):
        if first is None and f'id="{name}"' in message:
            first = monotonic()
        if f'id="{name}:start"' in message and first is not None:
            return FeedbackLatency(1000 * (first - began), 1000 * (monotonic() - began))
    raise RuntimeError(f"{name} never began")


def run_endurance(server: Server, seconds: float) -> Endurance:
    """Measure lost blocks, memory growth and late ticks under steady small blocks.

    Blocks are sent at `ENDURANCE_RATE` for `seconds`. A block without a reported end is lost.
    """
    ended, late = set[str](), 0
    memory: list[tuple[float, int]] = []
    with Client(port=server.port) as client:
        began = monotonic()
        for number in count():
            time = number / ENDURANCE_RATE
            if time >= seconds:
                break
            _receive_ends(client, began + time, ended)
            client.send(BLOCK_TEMPLATE.format(f"many{number}", SMALL_BEHAVIOURS[number % 2]))
            if number % ENDURANCE_RATE == 0 and (size := server.memory) is not None:
                memory.append((time, size))
        sent = number
        before = -1
        while before < len(ended) < sent:  # while blocks still end
            before = len(ended)
            _receive_ends(client, monotonic() + END_TIMEOUT, ended, max_count=sent)
        client.do("status")
        while (message := client.receive(END_TIMEOUT)) is not None and '"late":' not in message:
            pass
        late = int(re.findall(r'"late":(\d+)', message or '"late":0')[0])
    return Endurance(sent, sent - len(ended), _compute_memory_growth(memory, seconds), late)


def _receive_ends(client: Client, deadline: float, ended: set[str], *, max_count: float = inf) -> None:
    """Record the ids of ended blocks until a deadline or maximum count."""
    while len(ended) < max_count and (remaining := deadline - monotonic()) > 0.0:
        message = client.receive(remaining)
        end = re.search(r'<blockProgress[^>]* id="(many\d+):end"', message or "")
        if end is not None:
            ended.add(end[1])


def _compute_memory_growth(memory: list[tuple[float, int]], seconds: float) -> float | None:
    """Return memory growth [%] between early and last samples, None if missing."""
    early = [size for time, size in memory if SETTLED_FRACTION <= time / seconds <= SETTLED_FRACTION + 0.1]
    last = [size for time, size in memory if time / seconds >= 0.9]
    return 100.0 * (float(np.median(last)) / float(np.median(early)) - 1.0) if early and last else None


def _list_process_tree(pid: int) -> list[int]:
    """Return the ids of a process and all its descendants.

    The result is empty if not available.
    """
    tasks = Path(f"/proc/{pid}/task")
    if not tasks.is_dir():
        return []
    children = [int(child) for task in tasks.iterdir() for child in (task / "children").read_text().split()]
    return [pid, *(descendant for child in children for descendant in _list_process_tree(child))]


def _resident(pid: int) -> int | None:
    resident = re.search(r"VmRSS:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
    return 1024 * int(resident[1]) if resident else None


def _p95(name: str, values: list[float], goal: float) -> Metric:
    return Metric(name, float(np.percentile(values, 95)), "ms", goal, "lower", why=f"median {np.median(values):.1f}")
