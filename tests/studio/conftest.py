"""Fixtures: one server per test folder, and one page per test module."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import ceil
from pathlib import Path
from shutil import rmtree
from time import monotonic, sleep

import pytest

from kinesic.cli.live.studio import StudioPlanning
from kinesic.cli.options import Planning
from kinesic.client import Client
from kinesic.serve.wire.pages import WebFile
from kinesic.serve.wire.quotas import Quotas
from kinesic.session.setup import set_up
from kinesic.studio.page import page_files

from ..chromium import MAX_WAIT, Page, binary, opened
from ..serve.conftest import Running, running

PATIENT = Quotas(planning=60.0)  # quotas with a planning time [s] sufficient on a busy machine
STEP = 10.0  # [s] longest wait for an answer of the browser
BACKUP_DELAY = 0.2  # [s] time for the server to write the last backup of a closed page


@dataclass(frozen=True)
class Desk:
    """Server of a folder of documents with a simulated robot."""

    server: Running
    folder: Path
    files: Mapping[str, WebFile]

    def clear(self) -> None:
        """Interrupt the robot until it rests, and empty the folder.

        A last backup of a closed page may come late.
        """
        with self.server.client() as client:
            client.do("resume")
            client.do("interrupt")
            end = monotonic() + MAX_WAIT
            while '"resting"' not in _read_status(client):
                assert monotonic() < end, "the robot does not come to rest"
                sleep(0.05)
        while paths := list(self.folder.iterdir()):
            for path in paths:
                if path.is_dir():
                    rmtree(path, ignore_errors=True)
                else:
                    path.unlink(missing_ok=True)
            sleep(BACKUP_DELAY)


def _read_status(client: Client) -> str:
    """Request the state of the robot, and return the answer."""
    client.do("status")
    while '"status"' not in (message := client.receive(MAX_WAIT) or ""):
        pass
    return message


@dataclass
class Studio:
    """Open page of the studio with its server."""

    page: Page
    server: Running
    folder: Path
    files: Mapping[str, WebFile] = field(default_factory=dict)

    def state(self, name: str) -> object:
        """Return an entry of the page's state."""
        return self.page.value(f"kinesicStudio.state().{name}")

    def until(self, condition: str) -> None:
        """Wait for a condition; `s` is the state of the page."""
        self.page.until(f"(s => {condition})(kinesicStudio.state())")

    def rest(self, seconds: float) -> None:
        """Let the page run for `seconds` [s]."""
        for _ in range(ceil(seconds / STEP)):
            self.page.value(f"new Promise(done => setTimeout(done, {1000 * min(STEP, seconds)}))")

    def heap(self) -> float:
        """Return the script's memory [bytes] after garbage collection."""
        self.page.call("HeapProfiler.collectGarbage")
        return self.page.call("Runtime.getHeapUsage")["usedSize"]

    def write(self, text: str) -> None:
        """Replace the document like typed text and wait for its plan or error."""
        if self.state("text") == text:
            return
        planned, area = self.state("planned"), "document.querySelector('#text')"
        script = f"{area}.value = {text!r}; {area}.dispatchEvent(new Event('input'))"
        self.page.call("Runtime.evaluate", expression=script)
        self.until(f"s.planned > {planned} || !document.querySelector('#fault').hidden")

    def save_as(self, name: str) -> None:
        """Save the document under a name in the dialog."""
        self.page.click("#save-as")
        field = "document.querySelector('#save-name')"
        self.page.until("document.querySelector('#saving').open")
        self.page.value(f"{field}.value = {name!r}; {field}.dispatchEvent(new Event('input'))")
        self.page.click("#save-ok")


@pytest.fixture(scope="package")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Desk]:
    """Server with a simulated robot, shared by all modules of this folder."""
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    folder, setup = tmp_path_factory.mktemp("documents"), set_up()
    files = page_files(setup.robot, setup.lexicon)
    make_setup = replace(StudioPlanning.of(Planning("upper22", "neutral", {"voice": "auto"})), folder=folder).set_up
    with running(PATIENT, files=files, folder=folder, make_setup=make_setup) as server:
        yield Desk(server, folder, files)


@pytest.fixture(scope="module")
def studio(request: pytest.FixtureRequest, desk: Desk) -> Iterator[Studio]:
    """Page in a new profile, an empty folder and a robot at rest.

    Modules without checks of pictures set DRAWN = False.
    """
    with opened(f"http://localhost:{desk.server.port}/", drawn=getattr(request.module, "DRAWN", True)) as page:
        page.until("window.kinesicStudio !== undefined && kinesicStudio.state().planned > 0")
        yield Studio(page, desk.server, desk.folder, desk.files)
    desk.clear()
