"""Longer looks at the page: what people who cannot see it find, and its memory after a minute of play."""

import pytest

from .conftest import Studio
from .test_bundle import CLIENT

AXE = CLIENT / "node_modules" / "axe-core" / "axe.min.js"
GROWTH = 8e6  # [bytes] of the heap, in a minute

pytestmark = [pytest.mark.soak, pytest.mark.realtime]


@pytest.mark.skipif(not AXE.is_file(), reason="axe-core is not installed: make studio")
def test_nothing_stands_in_the_way_of_anybody(studio: Studio):
    page = studio.page
    page.call("Runtime.evaluate", expression=AXE.read_text(encoding="utf-8"))
    page.value("document.querySelector('#lexicon').open = true")
    for scheme in ("light", "dark"):
        page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        found = "axe.run().then(result => result.violations.map(each => [each.impact, each.help, each.nodes[0].html]))"
        assert page.value(found) == []


def test_a_minute_of_play_leaves_no_memory_behind(studio: Studio):
    page = studio.page
    page.click("#loop")
    page.click("#play")
    heap = "new Promise(done => setTimeout(() => done(performance.memory.usedJSHeapSize), {}))"
    page.call("HeapProfiler.collectGarbage")
    before = page.value(heap.format(1000))
    for _ in range(6):
        page.value(heap.format(10_000))
    page.call("HeapProfiler.collectGarbage")
    assert page.value(heap.format(1000)) - before < GROWTH
    page.click("#play")
