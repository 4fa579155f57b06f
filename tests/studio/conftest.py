"""One server and one browser for all tests of the page."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import ceil
from pathlib import Path

import pytest

from kinesic.cli.live.studio import StudioPlanning
from kinesic.cli.options import Planning
from kinesic.controller.perform import set_up
from kinesic.serve.wire.pages import WebFile
from kinesic.serve.wire.quotas import Quotas
from kinesic.studio.page import page_files

from ..chromium import Page, binary, opened
from ..serve.conftest import Running, running

PATIENT = Quotas(planning=60.0)  # others work on the machine, too
STEP = 10.0  # [s] that the browser may be silent


@dataclass
class Studio:
    """An open page, and the server behind it."""

    page: Page
    server: Running
    folder: Path
    files: Mapping[str, WebFile] = field(default_factory=dict)  # of the page

    def state(self, name: str) -> object:
        """One thing that the page knows."""
        return self.page.value(f"kinesicStudio.state().{name}")

    def until(self, condition: str) -> None:
        """Waits until something is so; `s` is what the page knows."""
        self.page.until(f"(s => {condition})(kinesicStudio.state())")

    def rest(self, seconds: float) -> None:
        """Lets the page do what it does for a while."""
        for _ in range(ceil(seconds / STEP)):
            self.page.value(f"new Promise(done => setTimeout(done, {1000 * min(STEP, seconds)}))")

    def heap(self) -> float:
        """Memory [bytes] that the page's script holds, without what nobody needs any more."""
        self.page.call("HeapProfiler.collectGarbage")
        return self.page.call("Runtime.getHeapUsage")["usedSize"]

    def write(self, text: str) -> None:
        """Replaces the document, as if it were typed, and waits for its plan or its error."""
        if self.state("text") == text:
            return
        planned, area = self.state("planned"), "document.querySelector('#text')"
        script = f"{area}.value = {text!r}; {area}.dispatchEvent(new Event('input'))"
        self.page.call("Runtime.evaluate", expression=script)
        self.until(f"s.planned > {planned} || !document.querySelector('#fault').hidden")


@pytest.fixture(scope="module")
def studio(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    """The page in a browser, with a real server and its twin; modules that look at no picture have DRAWN = False."""
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    folder, setup = tmp_path_factory.mktemp("documents"), set_up()
    files = page_files(setup.robot, setup.lexicon)
    make_setup = replace(StudioPlanning.of(Planning("upper22", "neutral", {"voice": "auto"})), folder=folder).set_up
    with running(PATIENT, files=files, folder=folder, make_setup=make_setup) as server:
        url = f"http://localhost:{server.port}/"
        with opened(url, drawn=getattr(request.module, "DRAWN", True)) as page:
            page.until("window.kinesicStudio !== undefined && kinesicStudio.state().planned > 0")
            yield Studio(page, server, folder, files)
