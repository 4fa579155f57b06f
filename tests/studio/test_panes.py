"""Pane sizes and timeline zoom, set by mouse and keyboard and stored by the browser."""

import pytest

from .conftest import Studio
from .test_page import middle
from .test_tracks import press

pytestmark = pytest.mark.realtime

DRAWN = False  # WebGL pictures are tested in test_stage.py
WIDE = {"width": 1400, "height": 900, "deviceScaleFactor": 1, "mobile": False}
OPENED = "window.kinesicStudio !== undefined && kinesicStudio.state().planned > 0"
SIZE = "(r => [r.width, r.height])(document.querySelector('#%s').getBoundingClientRect())"


@pytest.fixture(autouse=True)
def wide_window(studio: Studio) -> None:
    """Set a window size that shows all panes side by side."""
    studio.page.call("Emulation.setDeviceMetricsOverride", **WIDE)


def reload(studio: Studio) -> None:
    """Load the page again."""
    studio.page.call("Page.enable")
    studio.page.call("Page.reload")
    studio.page.event("Page.loadEventFired")
    studio.page.call("Page.disable")
    studio.page.until(OPENED)


def test_dragged_pane_sizes_of_the_studio_survive_a_reload(studio: Studio):
    x, y = middle(studio, ".border.timeline")
    studio.page.drag((x, y), (x, y - 50), (x, y - 100))
    _, height = studio.page.value(SIZE % "timeline")
    assert height == pytest.approx(900 - y + 100, abs=6)
    x, y = middle(studio, ".border.document")
    studio.page.drag((x, y), (x + 40, y), (x + 80, y))
    width, _ = studio.page.value(SIZE % "document")
    assert width == pytest.approx(x + 80, abs=6)
    reload(studio)
    assert studio.page.value(SIZE % "timeline")[1] == pytest.approx(height, abs=2)
    assert studio.page.value(SIZE % "document")[0] == pytest.approx(width, abs=2)


def test_pane_borders_of_the_studio_move_by_arrow_keys_within_their_limits(studio: Studio):
    for name, smaller in (("document", "ArrowLeft"), ("details", "ArrowRight"), ("timeline", "ArrowDown")):
        border = f"document.querySelector('.border.{name}')"
        studio.page.value(f"{border}.focus()")
        before = float(studio.page.value(f"{border}.getAttribute('aria-valuenow')"))
        press(studio, smaller)
        now = float(studio.page.value(f"{border}.getAttribute('aria-valuenow')"))
        assert now == pytest.approx(before - 2, abs=1)
        press(studio, "Home")
        assert studio.page.value(f"{border}.getAttribute('aria-valuenow')") == studio.page.value(
            f"{border}.getAttribute('aria-valuemin')"
        )
        studio.page.value(f"{border}.dispatchEvent(new MouseEvent('dblclick'))")


def test_studio_timeline_scale_set_by_zoom_buttons_and_wheel_survives_a_reload(studio: Studio):
    pixel = studio.page.value("kinesicStudio.timeline.pixel")
    for _ in range(3):
        studio.page.click("#zoom-in")
    near = studio.page.value("kinesicStudio.timeline.pixel")
    assert near == pytest.approx(pixel / 1.4**3, rel=0.1) or near == pytest.approx(1 / 400, rel=0.1)
    assert studio.page.value("document.querySelector('#rows').scrollWidth") > 1500
    reload(studio)
    assert studio.page.value("kinesicStudio.timeline.pixel") == pytest.approx(near, rel=0.1)
    x, y = middle(studio, "#rows")
    studio.page.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=300, modifiers=2)
    studio.page.until(f"kinesicStudio.timeline.pixel > {1.3 * near}")
    studio.page.click("#zoom-all")
    assert studio.page.value("document.querySelector('#rows').scrollWidth") <= 1400
