"""Benchmark of the emergency stop under floods: delay until acknowledgement and standstill.

The server and the flood run in processes of their own. An operator stops a moving robot repeatedly: by an open
connection, by a new one, by WebSocket, by standard input and by a stop line.
"""

import json
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
from kinesic.bench.metric import Metric
from kinesic.body.robot import Robot
from kinesic.client import Client, StopLine
from kinesic.host import processor_load

BLOCK_TEMPLATE = (
    '<bml id="{}"><gesture id="l" lexeme="BEAT" mode="LEFT_HAND" start="0"/><gesture id="r" lexeme="BEAT" '
    + ('mode="RIGHT_HAND" start="0"/><head id="h" lexeme="NOD" start="0"/></bml>')
)
STOP_MESSAGE = '{"do": "stop"}'
NO_FLOOD = "idle"  # name of the measurement without a flood
MAX_ACKNOWLEDGE_DELAY = 50.0  # [ms] goal of the 99th percentile of delays from a stop to its acknowledgement
MAX_STILL_DELAY = 150.0  # [ms] goal of the 99th percentile of delays from a stop to standstill
STOPS_PER_FLOOD = 24  # emergency stops measured under each kind of network flood
SETTLING_TIME = 0.35  # [s] wait after a stop before goals are read
GOAL_RESOLUTION = 2.0 * np.pi / 4096.0  # [rad] resolution of a servo's goal
MOTION_THRESHOLD = 0.01  # [rad] smallest goal change over two command periods that counts as motion: 0.5 rad/s
MOTION_TIMEOUT = 3.0  # [s] time limit for a motion to start
ACKNOWLEDGE_TIMEOUT = 30.0  # [s] time limit of an acknowledgement
FLOOD_START_TIME = 1.0  # [s] wait after a flood starts, before the first stop


@dataclass(frozen=True)
class StopDelay:
    """Delays [ms] from sending an emergency stop to acknowledgement and standstill."""

    acknowledged: float  # [ms] delay until the acknowledgement
    still: float | None  # [ms] delay until the last goal that differs from the final goal; None: nothing moved


@dataclass(frozen=True, eq=False)
class WatchedServer:
    """Server process that records the servo goals which it sends."""

    process: subprocess.Popen[str]
    port: int
    goals: Path
    joints: int

    def is_moving(self) -> bool:
        """Return whether a servo goal changed within the last three commands.

        Changes up to `MOTION_THRESHOLD` do not count.
        """
        last = read_goals(self.goals, self.joints, 3)[:, 1:]
        return len(last) == 3 and float(np.abs(last[-1] - last[0]).max()) > MOTION_THRESHOLD


def bench() -> list[Metric]:
    """Measure emergency-stop delays without a flood and under each network flood."""
    metrics = []
    for name in (NO_FLOOD, *flood.FLOOD_FUNCTIONS):
        with watched_server() as server:
            metrics += stop_metrics(name, measure_stops(server, name, STOPS_PER_FLOOD))
    return metrics


def stop_metrics(name: str, stops: list[StopDelay]) -> list[Metric]:
    """Return 99th percentiles of emergency-stop delays under a flood."""
    acknowledged = [stop.acknowledged for stop in stops]
    still = [stop.still for stop in stops if stop.still is not None]
    load = f"load {processor_load():.1f}"
    return [
        _p99(f"bml.stop.acknowledged_p99.{name}", acknowledged, MAX_ACKNOWLEDGE_DELAY, load),
        _p99(f"bml.stop.still_p99.{name}", still, MAX_STILL_DELAY, load),
    ]


@contextmanager
def watched_server() -> Iterator[WatchedServer]:
    """Start a server that records its servo goals, on a free port.

    Kill it on exit.
    """
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
    """Flood a server from another process while the context is open."""
    if name == NO_FLOOD:
        yield
        return
    with subprocess.Popen([sys.executable, flood.__file__, name, str(port)]) as process:
        try:
            sleep(FLOOD_START_TIME)
            yield
        finally:
            process.kill()


def measure_stops(server: WatchedServer, name: str, stops: int) -> list[StopDelay]:
    """Measure emergency-stop delays under a flood, by all channels in turn.

    Args:
        server: to stop.
        name: kind of flood, or `NO_FLOOD`.
        stops: total number of stops.
    """
    random, numbers, delays = Random(7), count(), list[StopDelay]()
    with Client(port=server.port) as client, _open_channels(server) as channels, flooding(name, server.port):
        for k in range(stops):
            client.do("resume")
            client.send(BLOCK_TEMPLATE.format(f"moves{next(numbers)}"))
            end = monotonic() + MOTION_TIMEOUT
            while not server.is_moving() and monotonic() < end:
                sleep(0.01)
            sleep(random.uniform(0.0, 0.2))
            delays.append(_stop(server, channels[k % len(channels)]))
            while client.receive(0.0):
                pass
    return delays


def _stop(server: WatchedServer, stop: Callable[[], None]) -> StopDelay:
    sent = monotonic()
    stop()
    acknowledged = monotonic() - sent
    sleep(max(0.0, SETTLING_TIME - acknowledged))
    commands = read_goals(server.goals, server.joints, round(200 * (SETTLING_TIME + acknowledged)))
    times, goals = commands[:, 0] - sent, commands[:, 1:]
    moved = np.abs(goals - goals[-1]).max(axis=1) > GOAL_RESOLUTION
    moved[:-1] |= np.abs(np.diff(goals, axis=0)).max(axis=1) > GOAL_RESOLUTION
    late = times[moved & (times > 0.0)]
    return StopDelay(1000.0 * acknowledged, 1000.0 * float(late.max()) if len(late) else None)


@contextmanager
def _open_channels(server: WatchedServer) -> Iterator[tuple[Callable[[], None], ...]]:
    """Yield functions that stop the robot and await the acknowledgement."""
    with (
        Client(port=server.port) as present,
        connect(f"ws://127.0.0.1:{server.port}") as web,
        StopLine(port=server.port) as line,
    ):

        def by_tcp() -> None:
            present.stop()
            _await(lambda: present.receive(ACKNOWLEDGE_TIMEOUT))

        def by_new_connection() -> None:
            with Client(port=server.port, timeout=ACKNOWLEDGE_TIMEOUT) as client:
                client.stop()
                _await(lambda: client.receive(ACKNOWLEDGE_TIMEOUT))

        def by_websocket() -> None:
            web.send(STOP_MESSAGE)
            _await(lambda: str(web.recv(ACKNOWLEDGE_TIMEOUT)))

        def by_standard_input() -> None:
            if server.process.stdin is not None and server.process.stdout is not None:
                server.process.stdin.write(STOP_MESSAGE + "\0")
                server.process.stdin.flush()
                _await(server.process.stdout.readline)

        def by_stop_line() -> None:
            line.stop(ACKNOWLEDGE_TIMEOUT)

        yield by_tcp, by_new_connection, by_websocket, by_standard_input, by_stop_line


def _await(receive: Callable[[], str | None]) -> None:
    while (message := receive()) is not None:
        if message.startswith("{") and json.loads(message).get("told") == "stopped":
            return
    raise RuntimeError("the stop was not acknowledged")


def _port(stderr: IO[str] | None) -> int:
    line = stderr.readline() if stderr is not None else ""
    port = re.search(r"listening at \S*:(\d+)", line)
    if port is None:
        raise RuntimeError(f"the server did not open: {line}")
    return int(port[1])


def _p99(name: str, values: list[float], goal: float, load: str) -> Metric:
    if not values:
        return Metric(name, None, "ms", goal, "lower", why="nothing moved")
    why = f"median {np.median(values):.0f}, {len(values)} stops, {load}"
    return Metric(name, float(np.percentile(values, 99)), "ms", goal, "lower", why=why)
