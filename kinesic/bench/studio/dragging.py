"""Measurement of the studio page's opening time and of redrawing dragged hands.

First paint and drawing of a dragged hand.
"""

from math import cos, sin
from time import monotonic, sleep

from kinesic.bench.studio.browser import Browser, Page

WINDOW_SIZE = (1280, 887)  # [pixels] width and height of the browser window, 87 of the height for its bars
POINTER_RATE = 59  # [1/s] mouse moves; not 60, so that they fall on all times within a drawn frame
DRAG_AMPLITUDE = 40.0  # [CSS pixels] amplitude of the dragged pointer
SETTLING_TIME = 1.0  # [s] wait for the page to finish its first drawing
STATE_SCRIPT = "kinesicStudio.state()"
READY_SCRIPT = (
    f"window.kinesicStudio !== undefined && {STATE_SCRIPT}.planned > 0 && {STATE_SCRIPT}.drawn > 0"
    f" && {STATE_SCRIPT}.left !== null"
)
PAINT_SCRIPT = "performance.getEntriesByName('first-contentful-paint')"
DRAWN_SCRIPT = (
    "new Promise(seen => (function look() { "
    f"if (window.kinesicStudio !== undefined && {STATE_SCRIPT}.drawn > 0) seen(performance.now()); "
    "else requestAnimationFrame(look); })())"
)  # [ms] from navigation until the robot is drawn


def time_first_paints(browser: Browser, url: str, count: int) -> tuple[list[float], list[float]]:
    """Return first-paint and robot-drawing times [ms] of cold page loads.

    Each load opens the page with a fresh browser profile.
    """
    painted, drawn = list[float](), list[float]()
    for _ in range(count):
        with browser.open_page(url) as page:
            drawn.append(page.read(DRAWN_SCRIPT, float))
            page.wait(f"{PAINT_SCRIPT}.length > 0")
            painted.append(page.read(f"{PAINT_SCRIPT}[0].startTime", float))
    return painted, drawn


def time_drags(page: Page, seconds: float) -> list[float]:
    """Drag a hand on the studio page and return drawing latencies [ms].

    A latency is the time from the pointer's move until the posture is drawn.
    """
    page.wait(READY_SCRIPT)
    page.read("void document.querySelector('#view-front').click(), 0", int)
    sleep(SETTLING_TIME)
    x, y = (page.read(f"{STATE_SCRIPT}.left.{axis}", float) for axis in "xy")
    page.move("mousePressed", x, y)
    page.read(f"{STATE_SCRIPT}.latencies.length = 0", int)
    began, k = monotonic(), 0
    while (now := monotonic() - began) < seconds:
        page.move(
            "mouseMoved", x + DRAG_AMPLITUDE * sin(3.0 * now), y - DRAG_AMPLITUDE + DRAG_AMPLITUDE * cos(2.0 * now)
        )
        k += 1
        sleep(max(0.0, began + k / POINTER_RATE - monotonic()))
    latencies = page.read(f"{STATE_SCRIPT}.latencies", list[float])
    page.move("mouseReleased", x, y)
    page.wait(f"{STATE_SCRIPT}.drawn > 0")
    return latencies
