"""Server and browser of the studio, each a process that can be killed and started again."""

import os
import re
import socket
import sys
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from multiprocessing import forkserver
from multiprocessing.process import BaseProcess
from pathlib import Path
from time import monotonic, sleep

from websockets.sync.client import connect

from kinesic.bench.studio.browser import Browser
from kinesic.child import child_context
from kinesic.cli import main

from ..chromium import DEFAULT_FLAGS, NO_TRIANGLES_SCRIPT, Page

EDIT_INTERVAL = 0.1  # [s] between two edits
POLL_INTERVAL = 0.02  # [s] between two checks of the server's port
MAX_WAIT = 300.0  # [s] longest wait for the page or the folder, as starts of servers take long on a busy machine
DOCUMENT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc"><wait id="w{}" duration="1"/></bml>'
LOADED, QUESTION = "Page.loadEventFired", "Page.javascriptDialogOpening"  # events of the browser
# modules that a fork server imports once for all servers and planners
PRELOADED_MODULES = (__name__, "kinesic.serve.planner", "kinesic.session.setup", "kinesic.cli.live.studio")


def run_server(folder: Path, port: int) -> None:
    """Run `kinesic studio` in this process."""
    os.chdir(folder)
    server = forkserver._forkserver  # the planner comes from it, too: another one would import all modules again
    forkserver.ensure_running = server.ensure_running = lambda: None
    sys.argv = ["kinesic", "studio", "--listen", f"127.0.0.1:{port}", "--no-browser", "--no-sound"]
    main()


def free_port() -> int:
    """Return a port that no program uses."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


@dataclass
class Machine:
    """Server process and browser with a page, all of which can be killed and started again."""

    folder: Path  # the server's documents
    profiles: Path  # folder of browser profiles
    port: int = field(default_factory=free_port)
    number: int = 0  # of the last edit
    profile_count: int = 0
    times: dict[int, float] = field(default_factory=dict)  # [s] time of each edit
    server: BaseProcess | None = None
    browser: Browser | None = None
    page: Page | None = None
    _tab: ExitStack = field(default_factory=ExitStack)

    def start_server(self) -> None:
        """Start the server, and wait until it accepts connections."""
        self.server = child_context(*PRELOADED_MODULES).Process(target=run_server, args=(self.folder, self.port))
        self.server.start()
        end = monotonic() + MAX_WAIT
        while True:
            assert monotonic() < end, "the server does not listen"
            assert self.server.is_alive(), "the server has ended"
            with suppress(OSError), socket.create_connection(("127.0.0.1", self.port)):
                return
            sleep(POLL_INTERVAL)

    def kill_server(self) -> None:
        self.server.kill()
        self.server.join()

    def start_browser(self, *, is_new: bool = False) -> None:
        """Open the studio in a new browser process, with the storage of the last one unless it is new."""
        self.profile_count += is_new
        profile = self.profiles / str(self.profile_count)
        profile.mkdir(exist_ok=True)
        self.browser = Browser(*DEFAULT_FLAGS, profile=profile)
        self._connect()

    def _connect(self) -> None:
        with connect(f"{self.browser.address}browser/{self.browser.name}", max_size=None) as connection:
            target = Page(connection).call("Target.createTarget", url="about:blank")["targetId"]
        self.page = Page(self._tab.enter_context(connect(f"{self.browser.address}page/{target}", max_size=None)))
        self.page.call("Page.addScriptToEvaluateOnNewDocument", source=NO_TRIANGLES_SCRIPT)
        self.page.call("Page.navigate", url=f"http://localhost:{self.port}/")
        self.wait()

    def kill_browser(self) -> None:
        self.browser.kill()
        self.browser.end()
        self._tab.close()

    def close(self) -> None:
        self.kill_browser()
        self.kill_server()

    def wait(self) -> None:
        self.page.until("window.kinesicStudio !== undefined && kinesicStudio.state().connection === 'open'")

    def edit(self, seconds: float) -> None:
        """Edit the document again and again for `seconds` [s]."""
        end = monotonic() + seconds
        while monotonic() < end or not self.times:
            self.number += 1
            area = "document.querySelector('#text')"
            text = DOCUMENT.format(self.number)
            self.page.value(f"{area}.value = {text!r}; {area}.dispatchEvent(new Event('input')); 0")
            self.times[self.number] = monotonic()
            sleep(EDIT_INTERVAL)

    def crash_page(self) -> None:
        self.page.call("Inspector.enable")
        self.page.call("Page.enable")  # a crashed page answers no calls
        self.page.post("Page.crash")
        self.page.event("Inspector.targetCrashed")

    def open_again(self) -> None:
        """Open the studio in the tab of a crashed page."""
        self.page.post("Page.navigate", url=f"http://localhost:{self.port}/")
        self.page.event(LOADED)
        self.wait()

    def reload(self) -> None:
        self.page.call("Page.enable")
        self.page.post("Page.reload")
        if self.page.event(QUESTION, LOADED) == QUESTION:
            self.page.call("Page.handleJavaScriptDialog", accept=True)
            self.page.event(LOADED)
        self.wait()

    def recover(self) -> None:
        """Accept the offer of the unsaved document."""
        self.page.until("!document.querySelector('#recovery').hidden")
        self.page.click("#recover")
        self.page.until("/<wait/.test(kinesicStudio.state().text)")

    def lost_time(self, crashed: float) -> float:
        """Return the age [s] at the crash of the oldest edit that the page does not show any more."""
        shown = int(re.search(r"w(\d+)", self.page.value("kinesicStudio.state().text"))[1])
        return max((crashed - time for number, time in self.times.items() if number > shown), default=0.0)
