"""The studio's page in a browser: how soon it is seen, and how soon a dragged hand is drawn where it was dragged to."""

from math import cos, sin
from time import monotonic, sleep

from kinesic.bench.studio.browser import Browser, Page

WINDOW_SIZE = (1280, 887)  # [pixels] with the browser's own 87
MOVES = 59  # [1/s] of the pointer, so that they come at all moments between two frames, of which there are 60
WAY = 40.0  # [CSS pixels] to each side on which the hand is dragged
SETTLED = 1.0  # [s] after which the page has drawn all that it opens with
STATE = "kinesicStudio.state()"
READY = f"window.kinesicStudio !== undefined && {STATE}.planned > 0 && {STATE}.drawn > 0 && {STATE}.left !== null"
PAINTED = "performance.getEntriesByName('first-contentful-paint')"
SEEN = (
    "new Promise(seen => (function look() { "
    f"if (window.kinesicStudio !== undefined && {STATE}.drawn > 0) seen(performance.now()); "
    "else requestAnimationFrame(look); })())"
)  # [ms] from the page's address until its robot is drawn


def time_first_paints(browser: Browser, url: str, count: int) -> tuple[list[float], list[float]]:
    """Times cold loads of the page [ms]: until anything is painted, and until its robot is drawn."""
    painted, seen = list[float](), list[float]()
    for _ in range(count):
        with browser.open_page(url) as page:
            seen.append(page.read(SEEN, float))
            page.wait(f"{PAINTED}.length > 0")
            painted.append(page.read(f"{PAINTED}[0].startTime", float))
    return painted, seen


def time_drags(page: Page, seconds: float) -> list[float]:
    """Drags a hand on the open page, and times each posture [ms]: from the pointer's move until it is drawn."""
    page.wait(READY)
    page.read("void document.querySelector('#view-front').click(), 0", int)
    sleep(SETTLED)
    x, y = (page.read(f"{STATE}.left.{axis}", float) for axis in "xy")
    page.move("mousePressed", x, y)
    page.read(f"{STATE}.latencies.length = 0", int)
    began, k = monotonic(), 0
    while (now := monotonic() - began) < seconds:
        page.move("mouseMoved", x + WAY * sin(3.0 * now), y - WAY + WAY * cos(2.0 * now))
        k += 1
        sleep(max(0.0, began + k / MOVES - monotonic()))
    found = page.read(f"{STATE}.latencies", list[float])
    page.move("mouseReleased", x, y)
    page.wait(f"{STATE}.drawn > 0")
    return found
