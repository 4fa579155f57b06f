"""The emergency stop under floods: when it is acknowledged, and when the goals are still.

The server runs in a process of its own and the flood in another. An operator stops a moving robot again and again: by a
connection that is there, by a new one, by WebSocket, by standard input, by a stop line.
"""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import monotonic, sleep
from typing import IO

import numpy as np
from websockets.sync.client import connect

from kinesic.bench.bml import flood, witnessed_server
from kinesic.bench.bml.witnessed_server import read_goals
from kinesic.bench.figure import Figure
from kinesic.body.robot import Robot
from kinesic.client import Client, StopLine

BLOCK = '<bml id="{}"><gesture id="l" lexeme="BEAT" mode="LEFT_HAND" start="0"/><gesture id="r" lexeme="BEAT" ' + (
    'mode="RIGHT_HAND" start="0"/><head id="h" lexeme="NOD" start="0"/></bml>'
)
STOP = '{"do": "stop"}'
IDLE = "idle"
ACKNOWLEDGED, STILL = 50.0, 150.0  # [ms] at most
STOPS = 24  # of the bench, for each flood; more are asked for by `measure_stops`
QUIET = 0.35  # [s] after which goals are looked at
TICK = 2.0 * np.pi / 4096.0  # [rad] by which a goal of a servo can change at all
MOVING = 0.01  # [rad] in two commands: half a radian a second
STARTING = 3.0  # [s] that a motion is waited for
PATIENCE = 30.0  # [s]
RISING = 1.0  # [s] until a flood is one


@dataclass(frozen=True)
class Stopping:
    """What came of one emergency stop, from when it was sent [ms]."""

    acknowledged: float
    still: float | None  # when the last goal came that was not the final one; None: nothing moved


@dataclass(frozen=True, eq=False)
class WatchedServer:
    """A server that writes its goals down."""

    process: subprocess.Popen[str]
    port: int
    goals: Path
    joints: int

    def is_moving(self) -> bool:
        """Whether goals have just changed."""
        last = read_goals(self.goals, self.joints, 3)[:, 1:]
        return len(last) == 3 and float(np.abs(last[-1] - last[0]).max()) > MOVING


def bench() -> list[Figure]:
    """Stops without a flood and under each."""
    found = []
    for name in (IDLE, *flood.FLOODS):
        with watched_server() as server:
            found += stop_figures(name, measure_stops(server, name, STOPS))
    return found


def stop_figures(name: str, stops: list[Stopping]) -> list[Figure]:
    """The worst hundredth of stops under a flood, beside the goals."""
    acknowledged = [each.acknowledged for each in stops]
    still = [each.still for each in stops if each.still is not None]
    load = f"load {os.getloadavg()[0]:.1f}"
    return [
        _p99(f"bml.stop.acknowledged_p99.{name}", acknowledged, ACKNOWLEDGED, load),
        _p99(f"bml.stop.still_p99.{name}", still, STILL, load),
    ]


@contextmanager
def watched_server() -> Iterator[WatchedServer]:
    """Opens a server on a free port; it is killed at the end."""
    joints = len(Robot.load("upper22").skeleton.rest)
    with TemporaryDirectory() as folder:
        goals = Path(folder) / "goals"
        command = [sys.executable, "-m", witnessed_server.__name__, str(goals)]
        pipe = subprocess.PIPE
        with subprocess.Popen(command, text=True, stdin=pipe, stdout=pipe, stderr=pipe) as process:
            try:
                yield WatchedServer(process, _port(process.stderr), goals, joints)
            finally:
                process.kill()


@contextmanager
def flooding(name: str, port: int) -> Iterator[None]:
    """Floods a server meanwhile."""
    if name == IDLE:
        yield
        return
    with subprocess.Popen([sys.executable, flood.__file__, name, str(port)]) as process:
        try:
            sleep(RISING)
            yield
        finally:
            process.kill()


def measure_stops(server: WatchedServer, name: str, stops: int) -> list[Stopping]:
    """Stops the moving robot so many times under a flood, each time in another way."""
    random, numbers, found = Random(7), count(), list[Stopping]()
    with Client(port=server.port) as client, _ways(server) as ways, flooding(name, server.port):
        for k in range(stops):
            client.do("resume")
            client.send(BLOCK.format(f"moves{next(numbers)}"))
            end = monotonic() + STARTING
            while not server.is_moving() and monotonic() < end:
                sleep(0.01)
            sleep(random.uniform(0.0, 0.2))
            found.append(_stop(server, ways[k % len(ways)]))
            while client.receive(0.0):
                pass
    return found


def _stop(server: WatchedServer, way: Callable[[], None]) -> Stopping:
    sent = monotonic()
    way()
    acknowledged = monotonic() - sent
    sleep(max(0.0, QUIET - acknowledged))
    commands = read_goals(server.goals, server.joints, round(200 * (QUIET + acknowledged)))
    times, goals = commands[:, 0] - sent, commands[:, 1:]
    moved = np.abs(goals - goals[-1]).max(axis=1) > TICK
    moved[:-1] |= np.abs(np.diff(goals, axis=0)).max(axis=1) > TICK
    late = times[moved & (times > 0.0)]
    return Stopping(1000.0 * acknowledged, 1000.0 * float(late.max()) if len(late) else None)


@contextmanager
def _ways(server: WatchedServer) -> Iterator[tuple[Callable[[], None], ...]]:
    """Ways to stop; each returns when the stop is acknowledged."""
    with (
        Client(port=server.port) as present,
        connect(f"ws://127.0.0.1:{server.port}") as web,
        StopLine(port=server.port) as line,
    ):

        def by_tcp() -> None:
            present.stop()
            _await(lambda: present.receive(PATIENCE))

        def by_new_connection() -> None:
            with Client(port=server.port, timeout=PATIENCE) as client:
                client.stop()
                _await(lambda: client.receive(PATIENCE))

        def by_websocket() -> None:
            web.send(STOP)
            _await(lambda: str(web.recv(PATIENCE)))

        def by_standard_input() -> None:
            if server.process.stdin is not None and server.process.stdout is not None:
                server.process.stdin.write(STOP + "\0")
                server.process.stdin.flush()
                _await(server.process.stdout.readline)

        def by_stop_line() -> None:
            line.stop(PATIENCE)

        yield by_tcp, by_new_connection, by_websocket, by_standard_input, by_stop_line


def _await(receive: Callable[[], str | None]) -> None:
    while (message := receive()) is not None:
        if message.startswith("{") and json.loads(message).get("told") == "stopped":
            return
    raise RuntimeError("the stop was not acknowledged")


def _port(said: IO[str] | None) -> int:
    line = said.readline() if said is not None else ""
    found = re.search(r"listening at \S*:(\d+)", line)
    if found is None:
        raise RuntimeError(f"the server did not open: {line}")
    return int(found[1])


def _p99(name: str, values: list[float], goal: float, load: str) -> Figure:
    if not values:
        return Figure(name, None, "ms", goal, "lower", why="nothing moved")
    why = f"median {np.median(values):.0f}, of {len(values)}, {load}"
    return Figure(name, float(np.percentile(values, 99)), "ms", goal, "lower", why=why)
