"""Long tests of the page: accessibility, and memory after half an hour of playback."""

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
HALF_HOUR, WARM = 1800.0, 30.0  # [s] durations of the measured playback and of the warm-up before it
PARTS = 6  # number of memory measurements during the playback

pytestmark = [pytest.mark.soak, pytest.mark.realtime]


@dataclass(frozen=True)
class Weight:
    """Memory use of page and server at one time."""

    heap: float  # [bytes] memory of the page's script
    nodes: float  # DOM nodes, including detached ones
    listeners: float
    server: float  # [bytes] memory of all processes of the server

    @classmethod
    def of(cls, studio: Studio) -> "Weight":
        studio.server.witness.commands.clear()  # log of the test itself
        heap, counted = studio.heap(), studio.page.call("Memory.getDOMCounters")
        return cls(heap, counted["nodes"], counted["jsEventListeners"], sum(resident()))


MAX_GROWTH = Weight(8e6, 500, 100, 60e6)  # largest growth over the whole playback
MAX_LATE_GROWTH = Weight(2e6, 100, 20, 15e6)  # largest growth in the second half of the playback


def resident() -> Iterator[float]:
    """Yield the resident memory [bytes] of the server's processes, including this one."""
    for process in (os.getpid(), *(item.pid for item in multiprocessing.active_children())):
        yield int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not AXE.is_file(), reason="axe-core is not installed: make studio")
def test_studio_page_has_no_accessibility_violations(studio: Studio):
    page = studio.page
    page.call("Runtime.evaluate", expression=AXE.read_text(encoding="utf-8"))
    page.value("document.querySelector('#lexicon').open = true")
    page.click("#show-palette")
    opened = "new MouseEvent('contextmenu', {bubbles: true, cancelable: true})"
    page.value(f"document.querySelector('.block').dispatchEvent({opened})")
    page.until("document.querySelector('#track-menu') !== null")
    for scheme in ("light", "dark"):
        page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        result = "axe.run().then(result => result.violations.map(each => [each.impact, each.help, each.nodes[0].html]))"
        assert page.value(result) == []


def test_half_an_hour_of_studio_playback_leaks_no_memory(studio: Studio):
    """Measure the memory after each sixth of the looped playback."""
    studio.page.click("#loop")
    studio.page.click("#play")
    studio.rest(WARM)
    results = [Weight.of(studio)]
    for _ in range(PARTS):
        for _ in range(ceil(HALF_HOUR / PARTS / STEP)):
            studio.rest(STEP)
            studio.server.witness.commands.clear()
        results.append(Weight.of(studio))
    studio.page.click("#play")
    first, middle, last = (astuple(results[k]) for k in (0, PARTS // 2, PARTS))
    assert all(now - then < most for now, then, most in zip(last, first, astuple(MAX_GROWTH), strict=True)), results
    assert all(now - then < most for now, then, most in zip(last, middle, astuple(MAX_LATE_GROWTH), strict=True)), (
        results
    )
