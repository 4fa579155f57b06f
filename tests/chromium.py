"""Drives a headless Chromium over its debugging protocol: opens a page, asks it things, clicks."""

import json
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep
from urllib.request import urlopen

from websockets.sync.client import ClientConnection, connect

BINARIES = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 60.0  # [s] with a machine on which others work, too


def binary() -> str | None:
    """Path of a Chromium; None where none is installed."""
    return next(filter(None, map(shutil.which, BINARIES)), None)


class Page:
    """An open page."""

    def __init__(self, connection: ClientConnection) -> None:
        self._connection, self._calls = connection, 0

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
def opened(url: str, profile: Path, *more: str) -> Iterator[Page]:
    """A page in a browser of its own, with more flags, which is gone afterwards."""
    flags = [
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--remote-debugging-port=0",
        f"--user-data-dir={profile}",
    ]
    with subprocess.Popen(
        [str(binary()), *flags, *more, url], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as browser:
        try:
            with connect(_address(profile, url), max_size=None) as connection:
                yield Page(connection)
        finally:
            browser.terminate()


def _address(profile: Path, url: str) -> str:
    """Of the socket of the page."""
    end = monotonic() + PATIENCE
    while True:
        try:
            port = (profile / "DevToolsActivePort").read_text().split()[0]
            with urlopen(f"http://127.0.0.1:{port}/json") as answer:
                for target in json.load(answer):
                    if target["url"] == url and target["type"] == "page":
                        return target["webSocketDebuggerUrl"]
        except (OSError, IndexError):
            pass
        assert monotonic() < end, "Chromium does not open the page"
        sleep(0.05)
