"""The live server, from outside: how soon a block begins, and whether anything is lost or grows under many of them.

A server runs in a process of its own; clients speak to it by TCP. A block's first command is out when its blockProgress
`start` is told, so that this message's arrival is an upper bound for it.
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

from kinesic.bench.figure import Figure
from kinesic.client import Client

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
LONG = "".join(f'<gesture id="g{k}" lexeme="BEAT" mode="LEFT_HAND" stroke="{1 + 1.5 * k}"/>' for k in range(4))
SMALL = (
    '<head id="h" lexeme="NOD" start="0"/>',
    '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" start="0"/>',
    '<speech id="s"><text>Yes, <sync id="m"/>indeed.</text></speech><head id="h" lexeme="NOD" stroke="s:m"/>',
)
EVERY = 1.0  # [s] between blocks whose latency is measured
CALMS = 5.0  # [s] without the end of a block, after which none is expected
LOOK = 0.05  # [s] between two looks at whether the server is open
RATE = 10  # [1/s] of blocks in the endurance run
SETTLED = 0.25  # share of the endurance run after which memory counts
FIRST_COMMAND, FIRST_FEEDBACK, FLAT = 100.0, 20.0, 5.0  # [ms], [ms], [%]
NO_MEMORY = "this system does not tell what a process holds"
BLOCKS, SECONDS = 40, 20.0  # of the bench; soak asks for more

Verb = Literal["serve", "studio"]


@dataclass(frozen=True)
class Server:
    """A server in its own process."""

    process: subprocess.Popen[bytes]
    port: int

    @property
    def memory(self) -> int | None:
        """[bytes] that it and its children hold; None where the system does not tell."""
        found = [_resident(pid) for pid in _family(self.process.pid)]
        return None if not found or None in found else sum(size for size in found if size is not None)


@dataclass(frozen=True)
class FeedbackLatency:
    """How soon a block is answered, from when it is sent [ms]."""

    feedback: float  # to its first feedback
    command: float  # to its start


@dataclass(frozen=True)
class Endurance:
    """What came of many blocks a second."""

    sent: int
    lost: int  # blocks whose end was never told
    growth: float | None  # [%] of memory after it had settled
    late: int  # ticks of the loop that came late


def bench() -> list[Figure]:
    """Latencies at one block a second beside another one that plays, then ten blocks a second."""
    with open_server() as server:
        found = latencies(server, BLOCKS)
        lasting = endurance(server, SECONDS)
    return [
        _p95("bml.live.first_command_p95", [each.command for each in found], FIRST_COMMAND),
        _p95("bml.live.first_feedback_p95", [each.feedback for each in found], FIRST_FEEDBACK),
        Figure("bml.live.lost", float(lasting.lost), "blocks", 0.0, "lower", why=f"of {lasting.sent}"),
        Figure(
            "bml.live.memory", lasting.growth, "%", FLAT, "lower", why="" if lasting.growth is not None else NO_MEMORY
        ),
    ]


@contextmanager
def open_server(*options: str, cwd: Path | None = None, verb: Verb = "serve") -> Iterator[Server]:
    """Opens a server on a free port, with more options of its verb; it is stopped at the end."""
    command = [sys.executable, "-m", "kinesic", verb, "--listen", "127.0.0.1:0", *options]
    with (
        TemporaryFile("w+") as said,
        subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=said, cwd=cwd) as process,
    ):
        try:
            yield Server(process, _port(process, said))
        finally:
            process.terminate()


def _port(process: subprocess.Popen[bytes], said: IO[str]) -> int:
    """Where a server listens, as soon as it says so."""
    while True:
        said.seek(0)
        text = said.read()
        if (found := re.search(r"listening at \S*:(\d+)", text)) is not None:
            return int(found[1])
        if process.poll() is not None:
            raise RuntimeError(f"the server did not open: {text}")
        sleep(LOOK)


def latencies(server: Server, blocks: int) -> list[FeedbackLatency]:
    """Sends small blocks, one a second, while another one plays."""
    found: list[FeedbackLatency] = []
    with Client(port=server.port) as other, Client(port=server.port) as client:
        for k in range(blocks):
            if k % 5 == 0:
                other.send(BLOCK.format(f"long{k}", LONG))
                sleep(EVERY)  # till it plays
            began = monotonic()
            while other.receive(0.0):
                pass
            found.append(_latency(client, f"small{k}", SMALL[k % len(SMALL)]))
            sleep(max(0.0, began + EVERY - monotonic()))
    return found


def _latency(client: Client, name: str, behaviours: str) -> FeedbackLatency:
    began, first = monotonic(), None
    for message in client.perform(BLOCK.format(name, behaviours)):
        if first is None and f'id="{name}"' in message:
            first = monotonic()
        if f'id="{name}:start"' in message and first is not None:
            return FeedbackLatency(1000 * (first - began), 1000 * (monotonic() - began))
    raise RuntimeError(f"{name} never began")


def endurance(server: Server, seconds: float) -> Endurance:
    """Sends ten blocks a second, of a nod or a beat each, and counts those that end."""
    ended, late = set[str](), 0
    memory: list[tuple[float, int]] = []
    with Client(port=server.port) as client:
        began = monotonic()
        for number in count():
            time = number / RATE
            if time >= seconds:
                break
            _receive_ends(client, began + time, ended)
            client.send(BLOCK.format(f"many{number}", SMALL[number % 2]))
            if number % RATE == 0 and (size := server.memory) is not None:
                memory.append((time, size))
        sent = number
        before = -1
        while before < len(ended) < sent:  # as long as some still end
            before = len(ended)
            _receive_ends(client, monotonic() + CALMS, ended, enough=sent)
        client.do("status")
        while (message := client.receive(CALMS)) is not None and '"late":' not in message:
            pass
        late = int(re.findall(r'"late":(\d+)', message or '"late":0')[0])
    return Endurance(sent, sent - len(ended), _grown(memory, seconds), late)


def _receive_ends(client: Client, until: float, ended: set[str], *, enough: float = inf) -> None:
    """Notes whose end is told, until a time or until enough have ended."""
    while len(ended) < enough and (left := until - monotonic()) > 0.0:
        message = client.receive(left)
        found = re.search(r'<blockProgress[^>]* id="(many\d+):end"', message or "")
        if found is not None:
            ended.add(found[1])


def _grown(memory: list[tuple[float, int]], seconds: float) -> float | None:
    """[%] by which the last tenth is above what the first settled tenth was."""
    early = [size for time, size in memory if SETTLED <= time / seconds <= SETTLED + 0.1]
    last = [size for time, size in memory if time / seconds >= 0.9]
    return 100.0 * (float(np.median(last)) / float(np.median(early)) - 1.0) if early and last else None


def _family(pid: int) -> list[int]:
    """A process and all its descendants; empty where the system does not tell."""
    tasks = Path(f"/proc/{pid}/task")
    if not tasks.is_dir():
        return []
    children = [int(child) for task in tasks.iterdir() for child in (task / "children").read_text().split()]
    return [pid, *(each for child in children for each in _family(child))]


def _resident(pid: int) -> int | None:
    found = re.search(r"VmRSS:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
    return 1024 * int(found[1]) if found else None


def _p95(name: str, values: list[float], goal: float) -> Figure:
    return Figure(name, float(np.percentile(values, 95)), "ms", goal, "lower", why=f"median {np.median(values):.1f}")
