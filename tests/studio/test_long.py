"""Longer looks at the page: what people who cannot see it find, and its memory after half an hour of play."""

import pytest

from .conftest import Studio
from .test_bundle import CLIENT

AXE = CLIENT / "node_modules" / "axe-core" / "axe.min.js"
GROWTH = 8e6  # [bytes] of the heap
HALF_HOUR, WARM = 1800.0, 20.0  # [s]

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


def test_half_an_hour_of_play_leaves_no_memory_behind(studio: Studio):
    """Looped, while the robot is watched; the heap is weighed after each sixth of the time."""
    studio.page.click("#loop")
    studio.page.click("#play")
    studio.rest(WARM)
    before, found = studio.heap(), []
    for _ in range(6):
        studio.rest(HALF_HOUR / 6)
        found.append(studio.heap() - before)
    studio.page.click("#play")
    assert max(found) < GROWTH, found
    assert found[-1] - found[2] < GROWTH / 4, f"it grows on and on: {found}"
