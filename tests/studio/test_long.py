"""Longer looks at the page: what people who cannot see it find, and what half an hour of play leaves in memory."""

import multiprocessing
import os
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from math import ceil
from pathlib import Path

import pytest

from .conftest import STEP, Studio
from .test_bundle import CLIENT

AXE = CLIENT / "node_modules" / "axe-core" / "axe.min.js"
HALF_HOUR, WARM = 1800.0, 30.0  # [s]
PARTS = 6  # of the time, after each of which all is weighed

pytestmark = [pytest.mark.soak, pytest.mark.realtime]


@dataclass(frozen=True)
class Weight:
    """What page and server hold."""

    heap: float  # [bytes] of the page's script
    nodes: float  # of the page's document, those that only its script holds among them
    listeners: float
    server: float  # [bytes] of all processes of the server

    @classmethod
    def of(cls, studio: Studio) -> "Weight":
        studio.server.witness.commands.clear()  # of the tests' own: all that the robot was told
        heap, counted = studio.heap(), studio.page.call("Memory.getDOMCounters")
        return cls(heap, counted["nodes"], counted["jsEventListeners"], sum(resident()))


MOST = Weight(8e6, 500, 100, 60e6)  # that each may be more than at the beginning
CREEP = Weight(2e6, 100, 20, 15e6)  # and in the second half of the time


def resident() -> Iterator[float]:
    """Memory [bytes] of the server, which runs here, and of its processes."""
    for process in (os.getpid(), *(each.pid for each in multiprocessing.active_children())):
        yield int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not AXE.is_file(), reason="axe-core is not installed: make studio")
def test_nothing_stands_in_the_way_of_anybody(studio: Studio):
    page = studio.page
    page.call("Runtime.evaluate", expression=AXE.read_text(encoding="utf-8"))
    page.value("document.querySelector('#lexicon').open = true")
    for scheme in ("light", "dark"):
        page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        found = "axe.run().then(result => result.violations.map(each => [each.impact, each.help, each.nodes[0].html]))"
        assert page.value(found) == []


def test_half_an_hour_of_play_leaves_no_memory_behind(studio: Studio):
    """Looped, while the robot is watched; page and server are weighed after each sixth of the time."""
    studio.page.click("#loop")
    studio.page.click("#play")
    studio.rest(WARM)
    found = [Weight.of(studio)]
    for _ in range(PARTS):
        for _ in range(ceil(HALF_HOUR / PARTS / STEP)):
            studio.rest(STEP)
            studio.server.witness.commands.clear()
        found.append(Weight.of(studio))
    studio.page.click("#play")
    first, middle, last = (astuple(found[k]) for k in (0, PARTS // 2, PARTS))
    assert all(now - then < most for now, then, most in zip(last, first, astuple(MOST), strict=True)), found
    assert all(now - then < most for now, then, most in zip(last, middle, astuple(CREEP), strict=True)), found
