"""The studio from outside: how soon an edit is planned, a dragged hand drawn and a page opened; what watching costs."""

import gzip
import os
from collections.abc import Callable
from pathlib import Path
from time import monotonic, sleep
from typing import Literal

import msgspec
import numpy as np

from kinesic.bench.bml.server import Server, open_server
from kinesic.bench.figure import Figure
from kinesic.bench.studio.browser import Browser, find_binary, open_browser
from kinesic.bench.studio.dragging import WINDOW_SIZE, time_drags, time_first_paints
from kinesic.body.robot import Robot
from kinesic.client import Client
from kinesic.studio.page import PAGE

ROBOT = "upper36"  # the larger one: 36 hinges with fingers
EDITED = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="edited"><speech id="s"><text>Well, this one here is '
    'rather <sync id="a"/>small, light as a <sync id="b"/>feather, and the other one over there is <sync id="c"/>large.'
    '</text></speech><gesture id="g" lexeme="BEAT" mode="LEFT_HAND" stroke="s:a+{:.3f}"/>'
    '<gesture id="h" lexeme="GIVE" stroke="s:b"/><gesture id="i" lexeme="BEAT" mode="RIGHT_HAND" stroke="s:c"/>'
    '<head id="n" lexeme="NOD" stroke="s:c"/></bml>'
)  # about 5 s
EDIT, REACH, WATCH, BUNDLE = 700.0, 33.0, 5.0, 200.0  # [ms], [ms], [% of a core], [kB]
PAGE_GOALS = {"studio.drag_p95": 33.0, "studio.first_paint_p95": 1000.0, "studio.first_robot_p95": None}  # [ms]
STEP, CIRCLE = 0.01, 0.08  # [s] later at each edit; [m] on which a hand is dragged
RATE, MOVES = 20, 60  # [1/s] of watching, and of moves of a pointer
EDITS, REACHES, SECONDS = 40, 200, 10.0
LOADS, DRAGGED = 10, 8.0  # of the page; [s], in which fewer postures are drawn than the page keeps latencies of
NO_BROWSER = "no Chromium: apt-get install chromium"
PATIENCE = 60.0  # [s] until anything is answered

Asked = Literal["plan", "reach"]


def bench() -> list[Figure]:
    """Measures edits, dragged hands, watching, what a browser loads, and how soon it shows that."""
    with open_server("--robot", ROBOT) as server, Client(port=server.port) as client:
        edits, reaches = time_edits(client, EDITS), time_reaches(client, REACHES)
        share = watching_share(server, client, SECONDS)
    no_share = "" if share is not None else "this system does not tell what a process has calculated"
    return [
        _p95("studio.edit_p95", edits, EDIT),
        _p95("studio.reach_p95", reaches, REACH),
        Figure("studio.watch", share, "% of a core", WATCH, "lower", why=no_share),
        Figure("studio.bundle", bundle_size(), "kB", BUNDLE, "lower", why="of scripts, compressed"),
        *bench_page(),
    ]


def bench_page() -> list[Figure]:
    """Measures the page in a browser, with the robot that a studio has where none is named."""
    if find_binary() is None:
        return [Figure(name, None, "ms", goal, "lower", why=NO_BROWSER) for name, goal in PAGE_GOALS.items()]
    size = f"--window-size={WINDOW_SIZE[0]},{WINDOW_SIZE[1]}"
    with open_server("--no-browser", "--no-sound", verb="studio") as server, open_browser(size) as browser:
        return time_page(browser, f"http://localhost:{server.port}/", LOADS, DRAGGED)


def time_page(browser: Browser, url: str, loads: int, seconds: float) -> list[Figure]:
    """Times a dragged hand for some seconds, and so many cold loads of the page."""
    painted, seen = time_first_paints(browser, url, loads)
    with browser.open_page(url) as page:
        drags = time_drags(page, seconds)
    measured = zip(PAGE_GOALS.items(), (drags, painted, seen), strict=True)
    return [_p95(name, values, goal) for (name, goal), values in measured]


def time_edits(client: Client, count: int) -> list[float]:
    """Times the new plan of a document of 5 s in which a stroke was moved [ms], so many times after a first one."""
    return [_ask(client, "plan", k, bml=EDITED.format(STEP * k)) for k in range(count + 1)][1:]


def time_reaches(client: Client, count: int) -> list[float]:
    """Times the answers while a hand is dragged round a circle [ms], so many after a first one."""
    robot = Robot.load(ROBOT)
    centre = robot.skeleton.frames(robot.skeleton.rest).origins[robot.arm("r").wrist] + (0.15, 0.0, 0.2)
    angles = np.linspace(0.0, 2 * np.pi, count + 1)
    places = centre + CIRCLE * np.stack([np.zeros(count + 1), np.cos(angles), np.sin(angles)], axis=1)
    found = []
    for k, place in enumerate(places):
        sleep(1 / MOVES)
        found.append(_ask(client, "reach", k, side="right", target=place.tolist()))
    return found[1:]


def watching_share(server: Server, client: Client, seconds: float) -> float | None:
    """Measures how much more of a core [%] the server needs while a client watches; None where it is not told."""
    still = _share(server, lambda: sleep(seconds))
    client.do("watch", rate=RATE)
    watched = _share(server, lambda: _listen(client, seconds))
    client.do("watch", rate=0)
    return None if still is None or watched is None else max(0.0, watched - still)


def bundle_size() -> float:
    """Measures what a browser loads of the page's scripts [kB], compressed."""
    return sum(len(gzip.compress(path.read_bytes())) for path in PAGE.glob("*.js")) / 1000


def _ask(client: Client, question: Asked, number: int, **values: object) -> float:
    """[ms] from a question to the answer with its number."""
    began = monotonic()
    client.do(question, id=number, **values)
    while (message := client.receive(PATIENCE)) is not None:
        told = msgspec.json.decode(message) if message.startswith("{") else {}
        if told.get("told") == question and told.get("id") == number and "error" not in told:
            return 1000 * (monotonic() - began)
        if told.get("told") in (question, "refused"):
            raise RuntimeError(f"{question}: {told.get('why') or told.get('error')}")
    raise RuntimeError(f"{question}: no answer in {PATIENCE:g} s")


def _share(server: Server, pass_time: Callable[[], None]) -> float | None:
    """[%] of a core that the server takes meanwhile."""
    before, began = _processor_time(server.process.pid), monotonic()
    pass_time()
    after = _processor_time(server.process.pid)
    return None if before is None or after is None else 100 * (after - before) / (monotonic() - began)


def _processor_time(pid: int) -> float | None:
    """[s] that a process has calculated; None where the system does not tell."""
    told = Path(f"/proc/{pid}/stat")
    if not told.is_file():
        return None
    after_name = told.read_text().rsplit(")", 1)[1].split()
    return (int(after_name[11]) + int(after_name[12])) / os.sysconf("SC_CLK_TCK")


def _listen(client: Client, seconds: float) -> None:
    """Hears how the body is, at most as long as asked; who hears nothing measures nothing."""
    end, heard = monotonic() + seconds, 0
    while (left := end - monotonic()) > 0.0:
        heard += (client.receive(left) or "").startswith('{"told":"body"')
    if not heard:
        raise RuntimeError("watch: the server tells nothing of the body")


def _p95(name: str, values: list[float], goal: float | None) -> Figure:
    return Figure(name, float(np.percentile(values, 95)), "ms", goal, "lower", why=f"median {np.median(values):.1f}")
