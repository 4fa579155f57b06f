"""Drives a headless Chromium over its debugging protocol: opens a page, asks it things, clicks.

A process of tests starts it once and keeps it to its end; each page has a profile of its own there, which goes with it.
"""

import atexit
import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from time import monotonic, sleep

from websockets.sync.client import ClientConnection, connect

from kinesic.bench.studio.browser import Browser
from kinesic.bench.studio.browser import find_binary as binary

__all__ = ["binary", "browser", "opened"]

PATIENCE = 60.0  # [s] with a machine on which others work, too
FOREIGN = "evil.example"  # which it is told to find on this machine, as a rebinding name server would
NO_TRIANGLES = "window.drawElements ??= WebGL2RenderingContext.prototype.drawElements,"
NO_TRIANGLES += "WebGL2RenderingContext.prototype.drawElements = () => undefined, 0"
FLAGS = ("--window-size=1000,700", f"--host-resolver-rules=MAP {FOREIGN} 127.0.0.1")


class Page:
    """An open page, or the browser itself."""

    def __init__(self, connection: ClientConnection, context: str = "") -> None:
        self._connection, self._calls = connection, 0
        self.context = context  # its profile

    def call(self, method: str, **parameters: object) -> dict:
        self._calls += 1
        self._connection.send(json.dumps({"id": self._calls, "method": method, "params": parameters}))
        while True:
            told = json.loads(self._connection.recv(timeout=PATIENCE))
            if told.get("id") == self._calls:
                assert "error" not in told, told
                return told["result"]

    def value(self, expression: str) -> object:
        """What an expression is worth in the page."""
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def until(self, expression: str) -> None:
        """Waits until an expression is true."""
        end = monotonic() + PATIENCE
        while not self.value(expression):
            assert monotonic() < end, f"never: {expression}"
            sleep(0.02)

    def drag(self, begin: tuple[float, float], *steps: tuple[float, float]) -> None:
        """A real press of the mouse at a point, moves to others, and a release at the last."""
        for kind, (x, y) in (("mouseMoved", begin), ("mousePressed", begin), *(("mouseMoved", at) for at in steps)):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)
        x, y = steps[-1]
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left", clickCount=1)

    def press(self, key: str, code: int) -> None:
        """A key that is pressed and let go; `code` is its Windows key code."""
        for kind in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)

    @contextmanager
    def undrawn(self) -> Iterator[None]:
        """Lets WebGL draw no triangles meanwhile, which in software take most of a processor: nobody looks at them."""
        self.value(NO_TRIANGLES)
        try:
            yield
        finally:
            self.value("WebGL2RenderingContext.prototype.drawElements = window.drawElements, 0")

    def click(self, selector: str) -> None:
        """A real click of the mouse in the middle of an element."""
        middle = self.value(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
            "e.scrollIntoView({block: 'center'});"
            "const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()"
        )
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=middle[0], y=middle[1], button="left", clickCount=1)


@contextmanager
def opened(url: str, *more: str, drawn: bool = True) -> Iterator[Page]:
    """A page with a profile of its own, both gone afterwards, in the browser that has these flags more.

    Where it is not drawn, WebGL draws no triangles in it.
    """
    chromium = browser(*more)
    with connect(f"{chromium.address}browser/{chromium.name}", max_size=None) as connection:
        door = Page(connection)
        context = door.call("Target.createBrowserContext", disposeOnDetach=True)["browserContextId"]
        first = url if drawn else "about:blank"
        target = door.call("Target.createTarget", url=first, browserContextId=context)["targetId"]
        with connect(f"{chromium.address}page/{target}", max_size=None) as own:
            page = Page(own, context)
            if not drawn:
                page.call("Page.addScriptToEvaluateOnNewDocument", source=NO_TRIANGLES)
                page.call("Page.navigate", url=url)
            yield page
        door.call("Target.disposeBrowserContext", browserContextId=context)


def browser(*more: str) -> Browser:
    """The browser of this process that has these flags; another one where a page has brought it down."""
    if _browser(more).poll() is not None:  # others shall not pay for that
        _browser.cache_clear()
    return _browser(more)


@cache
def _browser(more: tuple[str, ...]) -> Browser:
    """The browser of this process that has these flags."""
    begun = Browser(*FLAGS, *more)
    atexit.register(begun.end)
    return begun
