"""Headless Chromium over its debugging protocol: pages, expressions and input.

A test process starts the browser once and keeps it. Each page has a separate profile, which is deleted with the page.
"""

import atexit
import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from time import monotonic, sleep

from websockets.sync.client import ClientConnection, connect

from kinesic.bench.studio.browser import CHROMIUM_NAMES, Browser, find_binary

__all__ = ["binary", "browser", "opened"]

# The same engine without windows, tabs and menus uses half of the processor time.
PREFERRED_NAMES = ("chromium-headless-shell", *CHROMIUM_NAMES)

MAX_WAIT = 60.0  # [s] longest wait, on a machine that is shared with other work
FOREIGN_HOST = "evil.example"  # host name that the browser resolves to this machine, as after DNS rebinding
NO_TRIANGLES_SCRIPT = "window.drawElements ??= WebGL2RenderingContext.prototype.drawElements,"
NO_TRIANGLES_SCRIPT += "WebGL2RenderingContext.prototype.drawElements = () => undefined, 0"
DEFAULT_FLAGS = ("--window-size=1000,700", f"--host-resolver-rules=MAP {FOREIGN_HOST} 127.0.0.1")


def binary() -> str | None:
    """Return the path of the browser of the tests.

    The result is None if none is installed.
    """
    return find_binary(PREFERRED_NAMES)


class Page:
    """Page of a running browser, or the browser itself."""

    def __init__(self, connection: ClientConnection, context: str = "") -> None:
        self._connection, self._calls = connection, 0
        self.context = context  # its profile

    def call(self, method: str, **parameters: object) -> dict:
        self._calls += 1
        self._connection.send(json.dumps({"id": self._calls, "method": method, "params": parameters}))
        while True:
            data = json.loads(self._connection.recv(timeout=MAX_WAIT))
            if data.get("id") == self._calls:
                assert "error" not in data, data
                return data["result"]

    def event(self, *names: str) -> str:
        """Wait for the next event with one of the given names, and return its name."""
        while True:
            data = json.loads(self._connection.recv(timeout=MAX_WAIT))
            if data.get("method") in names:
                return data["method"]

    def post(self, method: str, **parameters: object) -> None:
        """Call a method without waiting for its result."""
        self._calls += 1
        self._connection.send(json.dumps({"id": self._calls, "method": method, "params": parameters}))

    def value(self, expression: str) -> object:
        """Return the value of an expression in the page."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in result, result["exceptionDetails"]
        return result["result"].get("value")

    def until(self, expression: str) -> None:
        """Wait until an expression is true."""
        end = monotonic() + MAX_WAIT
        while not self.value(expression):
            assert monotonic() < end, f"never: {expression}"
            sleep(0.02)

    def drag(self, begin: tuple[float, float], *steps: tuple[float, float]) -> None:
        """Drag the mouse with its button pressed from `begin` through all steps."""
        for kind, (x, y) in (("mouseMoved", begin), ("mousePressed", begin), *(("mouseMoved", at) for at in steps)):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)
        x, y = steps[-1]
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left", clickCount=1)

    def press(self, key: str, code: int) -> None:
        """Press and release a key with its Windows key code."""
        for kind in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)

    @contextmanager
    def undrawn(self) -> Iterator[None]:
        """Stop WebGL from drawing triangles within the `with` block.

        Software rendering would use most of a processor for pictures without a viewer.
        """
        self.value(NO_TRIANGLES_SCRIPT)
        try:
            yield
        finally:
            self.value("WebGL2RenderingContext.prototype.drawElements = window.drawElements, 0")

    def click(self, selector: str) -> None:
        """Click the mouse in the middle of an element."""
        middle = self.value(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
            "e.scrollIntoView({block: 'center'});"
            "const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()"
        )
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=middle[0], y=middle[1], button="left", clickCount=1)


@contextmanager
def opened(url: str, *more: str, drawn: bool = True) -> Iterator[Page]:
    """Open a page with a temporary profile in a browser with the given flags.

    Unless it is drawn, WebGL draws no triangles in it.
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
                page.call("Page.addScriptToEvaluateOnNewDocument", source=NO_TRIANGLES_SCRIPT)
                page.call("Page.navigate", url=url)
            yield page
        door.call("Target.disposeBrowserContext", browserContextId=context)


def browser(*more: str) -> Browser:
    """Return this process's browser with the given flags, restarted after a crash."""
    if _browser(more).poll() is not None:  # other pages keep running
        _browser.cache_clear()
    return _browser(more)


@cache
def _browser(more: tuple[str, ...]) -> Browser:
    """Start the browser of this process with the given flags."""
    begun = Browser(*DEFAULT_FLAGS, *more, names=PREFERRED_NAMES)
    atexit.register(begun.end)
    return begun
