"""Loss of edits when the page, the browser or the server crashes, with a server in a process of its own."""

import random
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic, sleep

import pytest

from kinesic.serve.desk.archive import ARCHIVE_NAME

from .. import chromium
from ..chromium import Page, binary, opened

pytestmark = [pytest.mark.realtime, pytest.mark.soak]

CRASH_COUNT = 200  # crashes and reloads of a run
MAX_LOST_TIME = 2.0  # [s] largest age of edits that a crash may lose
MAX_EDITING_TIME = 3.0  # [s] longest time of edits before a crash
EDIT_INTERVAL = 0.1  # [s] between two edits
MAX_WAIT = 300.0  # [s] longest wait for the page or the folder, as starts of servers take long on a busy machine
KINDS = ("reload", "page", "browser", "server", "server and page", "server and browser")
DOCUMENT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc"><wait id="w{}" duration="1"/></bml>'
LOADED, QUESTION = "Page.loadEventFired", "Page.javascriptDialogOpening"  # events of the browser


@dataclass
class Machine:
    """Server process and browser page, both of which can be killed and started again."""

    folder: Path
    port: int = 0
    number: int = 0  # of the last edit
    times: dict[int, float] = field(default_factory=dict)  # [s] time of each edit
    server: subprocess.Popen[str] | None = None
    page: Page | None = None
    _tab: ExitStack = field(default_factory=ExitStack)

    def start_server(self) -> None:
        command = [sys.executable, "-m", "kinesic", "studio", "--listen", f"127.0.0.1:{self.port}"]
        self.server = subprocess.Popen(
            [*command, "--no-browser", "--no-sound"], stderr=subprocess.PIPE, text=True, cwd=self.folder
        )
        self.port = next(
            int(found[1]) for line in self.server.stderr if (found := re.search(r"the studio: \S+:(\d+)", line))
        )

    def kill_server(self) -> None:
        self.server.kill()
        self.server.wait()
        self.server.stderr.close()

    def open_tab(self) -> None:
        """Open the page with a new profile, which has no storage."""
        self._tab.close()
        self.page = self._tab.enter_context(opened(f"http://localhost:{self.port}/", drawn=False))
        self.wait()

    def close(self) -> None:
        self._tab.close()
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


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Machine]:
    monkeypatch.setattr(chromium, "MAX_WAIT", MAX_WAIT)
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    result = Machine(tmp_path)
    result.start_server()
    result.open_tab()
    yield result
    result.close()


def fail(machine: Machine, kind: str) -> None:
    """Let a part fail in one of the ways of `KINDS`, and return to the document."""
    if kind == "reload":
        machine.reload()
        return
    if "server" in kind:
        machine.kill_server()
    if kind != "server":
        machine.crash_page()
    if "server" in kind:
        machine.start_server()
    if kind == "server":
        machine.wait()
        return
    if "browser" in kind:
        machine.open_tab()
    else:
        machine.open_again()
    machine.recover()


def read_backups(folder: Path) -> list[str]:
    return [path.read_text() for path in (folder / ARCHIVE_NAME).glob("backup_*.txt")]


def test_random_browser_crashes_and_reloads_lose_at_most_two_seconds_of_studio_edits(machine: Machine):
    """Write the loss of each failure."""
    chance = random.Random(49)
    losses: dict[str, list[float]] = {kind: [] for kind in KINDS}
    for _ in range(CRASH_COUNT):
        machine.times.clear()
        machine.edit(chance.uniform(0.0, MAX_EDITING_TIME))
        kind = chance.choice(KINDS)
        crashed = monotonic()
        fail(machine, kind)
        losses[kind].append(machine.lost_time(crashed))
        sys.stdout.write(f"{kind}: {losses[kind][-1]:.2f} s of edits lost\n")
        assert losses[kind][-1] <= MAX_LOST_TIME, (kind, losses)
        if kind in ("reload", "server"):
            assert losses[kind][-1] == 0.0, (kind, losses)
        end = monotonic() + MAX_WAIT  # after a crash of the server, the folder gets the text again
        text = machine.page.value("kinesicStudio.state().text")
        while not any(text in backup for backup in read_backups(machine.folder)):
            assert monotonic() < end, (kind, text)
            sleep(0.05)
