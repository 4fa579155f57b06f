"""Drives a headless Chromium over its debugging protocol: opens a page, asks it things, clicks.

A process of tests starts it once and keeps it to its end; each page has a profile of its own there, which goes with it.
"""

import atexit
import json
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, sleep

from websockets.sync.client import ClientConnection, connect

BINARIES = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 60.0  # [s] with a machine on which others work, too
FOREIGN = "evil.example"  # which it is told to find on this machine, as a rebinding name server would
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",  # WebGL without a graphics card
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--window-size=1000,700",
    f"--host-resolver-rules=MAP {FOREIGN} 127.0.0.1",
    "--remote-debugging-port=0",
)


def binary() -> str | None:
    """Path of a Chromium; None where none is installed."""
    return next(filter(None, map(shutil.which, BINARIES)), None)


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
def opened(url: str, *more: str) -> Iterator[Page]:
    """A page with a profile of its own, both gone afterwards, in the browser that has these flags more."""
    browser = _browser(more)
    if browser.poll() is not None:  # a page brought it down, and others shall not pay for that
        _browser.cache_clear()
        browser = _browser(more)
    with connect(f"{browser.address}browser/{browser.name}", max_size=None) as connection:
        door = Page(connection)
        context = door.call("Target.createBrowserContext", disposeOnDetach=True)["browserContextId"]
        target = door.call("Target.createTarget", url=url, browserContextId=context)["targetId"]
        with connect(f"{browser.address}page/{target}", max_size=None) as own:
            yield Page(own, context)
        door.call("Target.disposeBrowserContext", browserContextId=context)


class Browser(subprocess.Popen):
    """A Chromium, which runs until `end`."""

    def __init__(self, more: tuple[str, ...]) -> None:
        self._profile = TemporaryDirectory(prefix="kinesic-chromium-", ignore_cleanup_errors=True)
        folder = Path(self._profile.name)
        super().__init__(
            [str(binary()), *FLAGS, f"--user-data-dir={folder}", *more, "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        end = monotonic() + PATIENCE
        while not (found := _lines(folder / "DevToolsActivePort"))[1:]:
            assert monotonic() < end, "Chromium does not open"
            sleep(0.02)
        self.address, self.name = f"ws://127.0.0.1:{found[0]}/devtools/", found[1].rpartition("/")[2]

    def end(self) -> None:
        """Ends it, and removes what it has written."""
        self.terminate()
        self.wait(PATIENCE)
        self._profile.cleanup()


@cache
def _browser(more: tuple[str, ...]) -> Browser:
    """The browser of this process that has these flags."""
    browser = Browser(more)
    atexit.register(browser.end)
    return browser


def _lines(file: Path) -> list[str]:
    """Of a file, none as long as it is not there."""
    return file.read_text().split() if file.exists() else []
