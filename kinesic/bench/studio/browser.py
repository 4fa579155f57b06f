"""A headless Chromium, driven over its debugging protocol: opens pages, moves the pointer, reads what a page says."""

import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, sleep
from typing import Literal, TypeVar

import msgspec
from websockets.sync.client import connect
from websockets.sync.connection import Connection

BINARIES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",  # WebGL without a graphics card
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--remote-debugging-port=0",
)
PATIENCE = 60.0  # [s] until it opens, answers, or shows what is waited for
LOOK = 0.02  # [s] between two looks at that

Mouse = Literal["mousePressed", "mouseMoved", "mouseReleased"]
Value = TypeVar("Value")
NOTHING = msgspec.Raw(b"")


class Reply(msgspec.Struct):
    """What the browser answers to a call; other messages have no number."""

    id: int = 0
    result: msgspec.Raw = NOTHING
    error: msgspec.Raw = NOTHING


class Evaluated(msgspec.Struct):
    """What an expression is worth, as the browser wraps it."""

    result: dict[str, msgspec.Raw]
    exceptionDetails: msgspec.Raw = NOTHING  # noqa: N815 - the browser's word


def find_binary() -> str | None:
    """Finds the path of a Chromium; None where none is installed."""
    return next(filter(None, map(shutil.which, BINARIES)), None)


class Page:
    """An open page, or the browser itself."""

    def __init__(self, connection: Connection) -> None:
        self._connection, self._numbers = connection, count(1)

    def send(self, method: str, **parameters: object) -> int:
        """Calls without waiting for the answer, and gives the call's number."""
        number = next(self._numbers)
        self._connection.send(msgspec.json.encode({"id": number, "method": method, "params": parameters}).decode())
        return number

    def call(self, method: str, **parameters: object) -> msgspec.Raw:
        """Calls, and gives what the browser answers."""
        number = self.send(method, **parameters)
        while (reply := msgspec.json.decode(self._connection.recv(timeout=PATIENCE), type=Reply)).id != number:
            pass
        if bytes(reply.error):
            raise RuntimeError(f"the browser does not {method}: {bytes(reply.error).decode()}")
        return reply.result

    def read(self, expression: str, kind: type[Value]) -> Value:
        """Reads what an expression of the page's script is worth, which is of some kind."""
        told = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        found = msgspec.json.decode(told, type=Evaluated)
        if bytes(found.exceptionDetails) or "value" not in found.result:
            raise RuntimeError(f"the page does not tell {expression}: {bytes(told).decode()}")
        return msgspec.json.decode(found.result["value"], type=kind)

    def wait(self, expression: str) -> None:
        """Waits until an expression is true."""
        end = monotonic() + PATIENCE
        while not self.read(f"Boolean({expression})", bool):
            if monotonic() > end:
                raise RuntimeError(f"the page is never so: {expression}")
            sleep(LOOK)

    def move(self, kind: Mouse, x: float, y: float) -> None:
        """Presses, moves or lets go the left button at a place [CSS pixels], without waiting for what comes of it."""
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)


class Browser(subprocess.Popen[bytes]):
    """A Chromium with these flags more, which runs until `end`."""

    def __init__(self, *more: str) -> None:
        self._profile = TemporaryDirectory(prefix="kinesic-chromium-", ignore_cleanup_errors=True)
        folder = Path(self._profile.name)
        command = [str(find_binary()), *FLAGS, f"--user-data-dir={folder}", *more, "about:blank"]
        super().__init__(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = monotonic() + PATIENCE
        while not (found := _words(folder / "DevToolsActivePort"))[1:]:
            if monotonic() > end:
                raise RuntimeError(f"{command[0]} does not open")
            sleep(LOOK)
        self.address, self.name = f"ws://127.0.0.1:{found[0]}/devtools/", found[1].rpartition("/")[2]

    def end(self) -> None:
        """Ends it, and removes what it has written."""
        self.terminate()
        self.wait(PATIENCE)
        self._profile.cleanup()

    @contextmanager
    def open_page(self, url: str) -> Iterator[Page]:
        """Opens a page of which nothing is known yet; it, and what is known of it, are gone afterwards."""
        with connect(f"{self.address}browser/{self.name}", max_size=None) as connection:
            door = Page(connection)
            context = msgspec.json.decode(
                door.call("Target.createBrowserContext", disposeOnDetach=True), type=dict[str, str]
            )["browserContextId"]
            target = msgspec.json.decode(
                door.call("Target.createTarget", url="about:blank", browserContextId=context), type=dict[str, str]
            )["targetId"]
            with connect(f"{self.address}page/{target}", max_size=None) as own:
                page = Page(own)
                page.call("Page.navigate", url=url)
                yield page
            door.call("Target.disposeBrowserContext", browserContextId=context)


@contextmanager
def open_browser(*more: str) -> Iterator[Browser]:
    """Opens a Chromium with these flags more, and ends it."""
    browser = Browser(*more)
    try:
        yield browser
    finally:
        browser.end()


def _words(file: Path) -> list[str]:
    """Of a file, none as long as it is not there."""
    return file.read_text().split() if file.exists() else []
