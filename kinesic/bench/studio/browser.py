"""Headless Chromium driven by the Chrome debugging protocol.

It opens pages, moves the pointer and evaluates scripts.
"""

import shutil
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, sleep
from typing import Literal, TypeVar

import msgspec
from websockets.sync.client import connect
from websockets.sync.connection import Connection

CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome")
# Command-line flags of every started browser.
CHROMIUM_FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",  # WebGL without a graphics card
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--remote-debugging-port=0",
)
PORT_FILE = "DevToolsActivePort"  # file in the profile with the port and name of the running browser
BROWSER_TIMEOUT = 60.0  # [s] time limit of a browser start, answer or page condition
POLL_INTERVAL = 0.02  # [s] interval between checks of a page condition

MouseEvent = Literal["mousePressed", "mouseMoved", "mouseReleased"]
Value = TypeVar("Value")
EMPTY_REPLY = msgspec.Raw(b"")


class Reply(msgspec.Struct):
    """Answer of the browser to a protocol call.

    Other messages have no number.
    """

    id: int = 0
    result: msgspec.Raw = EMPTY_REPLY
    error: msgspec.Raw = EMPTY_REPLY


class Evaluated(msgspec.Struct):
    """Value of a JavaScript expression as wrapped by the browser."""

    result: dict[str, msgspec.Raw]
    exceptionDetails: msgspec.Raw = EMPTY_REPLY  # noqa: N815 - the browser's name


def find_binary(names: Sequence[str] = CHROMIUM_NAMES) -> str | None:
    """Return the path of an installed Chromium.

    Args:
        names: names of the program, the preferred one first.

    Returns:
        None if none is installed.
    """
    return next(filter(None, map(shutil.which, names)), None)


class Page:
    """Protocol connection to an open page or to the browser itself."""

    def __init__(self, connection: Connection) -> None:
        self._connection, self._numbers = connection, count(1)

    def send(self, method: str, **parameters: object) -> int:
        """Send a protocol call without waiting, and return its number."""
        number = next(self._numbers)
        self._connection.send(msgspec.json.encode({"id": number, "method": method, "params": parameters}).decode())
        return number

    def call(self, method: str, **parameters: object) -> msgspec.Raw:
        """Send a protocol call and return the browser's answer.

        Raises:
            RuntimeError: the browser reports an error.
        """
        number = self.send(method, **parameters)
        while (reply := msgspec.json.decode(self._connection.recv(timeout=BROWSER_TIMEOUT), type=Reply)).id != number:
            pass
        if bytes(reply.error):
            raise RuntimeError(f"the browser does not {method}: {bytes(reply.error).decode()}")
        return reply.result

    def read(self, expression: str, kind: type[Value]) -> Value:
        """Evaluate a JavaScript expression, and convert its value to a type.

        Raises:
            RuntimeError: the expression fails or has no value.
        """
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        evaluated = msgspec.json.decode(answer, type=Evaluated)
        if bytes(evaluated.exceptionDetails) or "value" not in evaluated.result:
            raise RuntimeError(f"the page does not tell {expression}: {bytes(answer).decode()}")
        return msgspec.json.decode(evaluated.result["value"], type=kind)

    def wait(self, expression: str) -> None:
        """Wait until a JavaScript expression is true.

        Raises:
            RuntimeError: it is still false after `BROWSER_TIMEOUT`.
        """
        end = monotonic() + BROWSER_TIMEOUT
        while not self.read(f"Boolean({expression})", bool):
            if monotonic() > end:
                raise RuntimeError(f"the page never fulfils {expression}")
            sleep(POLL_INTERVAL)

    def move(self, kind: MouseEvent, x: float, y: float) -> None:
        """Send a mouse event at a page position [CSS pixels].

        The page's reaction is not awaited.
        """
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)


class Browser(subprocess.Popen[bytes]):
    """Chromium process with additional flags that runs until `end`."""

    def __init__(self, *flags: str, profile: Path | None = None, names: Sequence[str] = CHROMIUM_NAMES) -> None:
        """Start the browser.

        Args:
            flags: further command-line flags.
            profile: folder of the user's profile, kept afterwards; None for a temporary one.
            names: names of the program, the preferred one first.
        """
        self._profile = TemporaryDirectory(prefix="kinesic-chromium-", ignore_cleanup_errors=True)
        folder = Path(self._profile.name) if profile is None else profile
        (folder / PORT_FILE).unlink(missing_ok=True)  # of a browser that was killed
        command = [str(find_binary(names)), *CHROMIUM_FLAGS, f"--user-data-dir={folder}", *flags, "about:blank"]
        super().__init__(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = monotonic() + BROWSER_TIMEOUT
        while not (port_lines := _read_words(folder / PORT_FILE))[1:]:
            if monotonic() > end:
                raise RuntimeError(f"{command[0]} does not open")
            sleep(POLL_INTERVAL)
        self.address, self.name = f"ws://127.0.0.1:{port_lines[0]}/devtools/", port_lines[1].rpartition("/")[2]

    def end(self) -> None:
        """Terminate the browser and remove its files."""
        self.terminate()
        self.wait(BROWSER_TIMEOUT)
        self._profile.cleanup()

    @contextmanager
    def open_page(self, url: str) -> Iterator[Page]:
        """Open a page with a fresh profile and discard both on exit."""
        with connect(f"{self.address}browser/{self.name}", max_size=None) as connection:
            browser_target = Page(connection)
            context = msgspec.json.decode(
                browser_target.call("Target.createBrowserContext", disposeOnDetach=True), type=dict[str, str]
            )["browserContextId"]
            target = msgspec.json.decode(
                browser_target.call("Target.createTarget", url="about:blank", browserContextId=context),
                type=dict[str, str],
            )["targetId"]
            with connect(f"{self.address}page/{target}", max_size=None) as page_connection:
                page = Page(page_connection)
                page.call("Page.navigate", url=url)
                yield page
            browser_target.call("Target.disposeBrowserContext", browserContextId=context)


@contextmanager
def open_browser(*flags: str) -> Iterator[Browser]:
    """Start Chromium with additional flags and end it on exit."""
    browser = Browser(*flags)
    try:
        yield browser
    finally:
        browser.end()


def _read_words(file: Path) -> list[str]:
    """Split a file into words, none if the file is missing."""
    return file.read_text().split() if file.exists() else []
