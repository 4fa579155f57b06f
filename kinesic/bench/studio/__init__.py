"""Benchmark of the studio page and its server from outside.

It measures edits, dragged hands, page loads and watching.
"""

import gzip
import os
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, sleep
from typing import Literal

import msgspec
import numpy as np

from kinesic.bench.bml.server import Server, open_server
from kinesic.bench.metric import Metric
from kinesic.bench.studio.browser import Browser, find_binary, open_browser
from kinesic.bench.studio.dragging import WINDOW_SIZE, time_drags, time_first_paints
from kinesic.bench.studio.editing import EDIT_SHIFT, EDITED_BLOCK, time_page_edits
from kinesic.body.robot import Robot
from kinesic.client import Client
from kinesic.studio.page import PAGE_FOLDER

BENCH_ROBOT = "upper36"  # robot with 36 joints, fingers included
MAX_EDIT_TIME = 300.0  # [ms] goal for the 95th percentile of replanning after an edit
MAX_REACH_TIME = 33.0  # [ms] goal for the 95th percentile of answers while a hand is dragged
MAX_WATCH_LOAD = 5.0  # [% of a core] goal for the extra CPU load of a watching client
MAX_BUNDLE_SIZE = 200.0  # [kB] goal for the compressed size of the page's scripts
# [ms] goals of the page metrics; None: measured without a goal.
PAGE_GOALS = {
    "studio.page_edit_p95": MAX_EDIT_TIME,
    "studio.drag_p95": 33.0,
    "studio.first_paint_p95": 1000.0,
    "studio.first_robot_p95": None,
}
CIRCLE_RADIUS = 0.08  # [m] radius of the dragged hand's circle
WATCH_RATE = 20  # [1/s] body states sent to a watching client
POINTER_RATE = 60  # [1/s] IK requests while a hand is dragged
EDIT_COUNT = 40  # number of timed edits of a document
REACH_COUNT = 200  # number of timed IK requests
WATCH_SECONDS = 10.0  # [s] time during which a client watches
PAGE_EDITS = 20  # number of timed edits on the page
PAGE_LOADS = 10  # number of timed cold loads of the page
DRAG_SECONDS = 8.0  # [s] duration of a drag, short enough for the page's latency buffer
BROWSER_MISSING = "no Chromium: apt-get install chromium"
ANSWER_TIMEOUT = 60.0  # [s] time limit of the server's answer

QuestionName = Literal["plan", "reach"]


def bench() -> list[Metric]:
    """Measure replanning, dragging, watching and loading in the studio."""
    with open_server("--robot", BENCH_ROBOT) as server, Client(port=server.port) as client:
        edits, reaches = time_edits(client, EDIT_COUNT), time_reaches(client, REACH_COUNT)
        load = watching_load(server, client, WATCH_SECONDS)
    no_load = "" if load is not None else "this system does not report the CPU time of a process"
    return [
        _p95("studio.edit_p95", edits, MAX_EDIT_TIME),
        _p95("studio.reach_p95", reaches, MAX_REACH_TIME),
        Metric("studio.watch", load, "% of a core", MAX_WATCH_LOAD, "lower", why=no_load),
        Metric("studio.bundle", bundle_size(), "kB", MAX_BUNDLE_SIZE, "lower", why="compressed scripts"),
        *bench_page(),
    ]


def bench_page() -> list[Metric]:
    """Measure the studio page in a browser with the default robot."""
    if find_binary() is None:
        return [Metric(name, None, "ms", goal, "lower", why=BROWSER_MISSING) for name, goal in PAGE_GOALS.items()]
    size = f"--window-size={WINDOW_SIZE[0]},{WINDOW_SIZE[1]}"
    with TemporaryDirectory() as folder:  # takes the backups of the edited document
        options = ("--no-browser", "--no-sound", "--folder", folder)
        with open_server(*options, verb="studio") as server, open_browser(size) as browser:
            return time_page(browser, f"http://localhost:{server.port}/", PAGE_LOADS, DRAG_SECONDS)


def time_page(browser: Browser, url: str, loads: int, seconds: float) -> list[Metric]:
    """Measure drawing latencies and cold loads of the studio page."""
    painted, drawn = time_first_paints(browser, url, loads)
    with browser.open_page(url) as page:
        drags = time_drags(page, seconds)
        edits = time_page_edits(page, PAGE_EDITS)
    measured = zip(PAGE_GOALS.items(), (edits, drags, painted, drawn), strict=True)
    return [_p95(name, values, goal) for (name, goal), values in measured]


def time_edits(client: Client, count: int) -> list[float]:
    """Measure replanning times [ms] after moving a stroke.

    A first edit is not counted.
    """
    return [_time_answer(client, "plan", k, bml=EDITED_BLOCK.format(EDIT_SHIFT * k)) for k in range(count + 1)][1:]


def time_reaches(client: Client, count: int) -> list[float]:
    """Measure IK answer times [ms] while a hand is dragged.

    The first answer is not counted.
    """
    robot = Robot.load(BENCH_ROBOT)
    centre = robot.skeleton.frames(robot.skeleton.rest).origins[robot.arm("r").wrist] + (0.15, 0.0, 0.2)
    angles = np.linspace(0.0, 2 * np.pi, count + 1)
    positions = centre + CIRCLE_RADIUS * np.stack([np.zeros(count + 1), np.cos(angles), np.sin(angles)], axis=1)
    times = []
    for k, position in enumerate(positions):
        sleep(1 / POINTER_RATE)
        times.append(_time_answer(client, "reach", k, side="right", target=position.tolist()))
    return times[1:]


def watching_load(server: Server, client: Client, seconds: float) -> float | None:
    """Measure the server's extra CPU load [%] for a watching client.

    The result is None if the system does not report CPU times.
    """
    idle = _measure_cpu_load(server, lambda: sleep(seconds))
    client.do("watch", rate=WATCH_RATE)
    watched = _measure_cpu_load(server, lambda: _receive_states(client, seconds))
    client.do("watch", rate=0)
    return None if idle is None or watched is None else max(0.0, watched - idle)


def bundle_size() -> float:
    """Return the compressed size [kB] of the studio page's scripts."""
    return sum(len(gzip.compress(path.read_bytes())) for path in PAGE_FOLDER.glob("*.js")) / 1000


def _time_answer(client: Client, question: QuestionName, number: int, **values: object) -> float:
    """Return the time [ms] from a client request to its answer.

    Raises:
        RuntimeError: the server refuses the request, or sends no answer in time.
    """
    began = monotonic()
    client.do(question, id=number, **values)
    while (message := client.receive(ANSWER_TIMEOUT)) is not None:
        reply = msgspec.json.decode(message) if message.startswith("{") else {}
        if reply.get("told") == question and reply.get("id") == number and "error" not in reply:
            return 1000 * (monotonic() - began)
        if reply.get("told") in (question, "refused"):
            raise RuntimeError(f"{question}: {reply.get('why') or reply.get('error')}")
    raise RuntimeError(f"{question}: no answer in {ANSWER_TIMEOUT:g} s")


def _measure_cpu_load(server: Server, pass_time: Callable[[], None]) -> float | None:
    """Return the server's CPU load [%] during a call."""
    before, began = _read_cpu_time(server.process.pid), monotonic()
    pass_time()
    after = _read_cpu_time(server.process.pid)
    return None if before is None or after is None else 100 * (after - before) / (monotonic() - began)


def _read_cpu_time(pid: int) -> float | None:
    """Return the CPU time [s] of a process.

    The result is None if the system does not report it.
    """
    status = Path(f"/proc/{pid}/stat")
    if sys.platform != "win32" and status.is_file():
        after_name = status.read_text().rsplit(")", 1)[1].split()
        return (int(after_name[11]) + int(after_name[12])) / os.sysconf("SC_CLK_TCK")
    return None


def _receive_states(client: Client, seconds: float) -> None:
    """Receive body states from the server for a duration [s].

    Raises:
        RuntimeError: none arrived, so that nothing was measured.
    """
    end, received = monotonic() + seconds, 0
    while (remaining := end - monotonic()) > 0.0:
        received += (client.receive(remaining) or "").startswith('{"told":"body"')
    if not received:
        raise RuntimeError("watch: the server sends no body states")


def _p95(name: str, values: list[float], goal: float | None) -> Metric:
    return Metric(name, float(np.percentile(values, 95)), "ms", goal, "lower", why=f"median {np.median(values):.1f}")
