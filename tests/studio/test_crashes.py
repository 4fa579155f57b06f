"""Loss of edits when the page, the browser or the server crashes, with a server in a process of its own."""

import random
import sys
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

import pytest

from kinesic.serve.desk.archive import ARCHIVE_NAME

from .. import chromium
from ..chromium import binary
from .crashing import MAX_WAIT, Machine

pytestmark = [pytest.mark.realtime, pytest.mark.soak]

SEEDS = range(8)  # of the runs, which can be repeated one by one
CRASH_COUNT = 25  # crashes and reloads of a run; 200 of all runs
MAX_LOST_TIME = 2.0  # [s] largest age of edits that a crash may lose
MAX_EDITING_TIMES = (1.0, 3.0, 12.0)  # [s] a browser writes its storage to the disk after some seconds
KINDS = (  # the processes that are killed; a new browser has no storage
    "reload",
    "page",
    "browser",
    "browser, opened as a new one",
    "server",
    "server and page",
    "server and browser",
    "server and browser, opened as a new one",
)


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Machine]:
    monkeypatch.setattr(chromium, "MAX_WAIT", MAX_WAIT)
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    documents, profiles = tmp_path / "documents", tmp_path / "profiles"
    documents.mkdir()
    profiles.mkdir()
    result = Machine(documents, profiles)
    result.start_server()
    result.start_browser()
    yield result
    result.close()


def fail(machine: Machine, kind: str) -> None:
    """Let a part fail in one of the ways of `KINDS`, and return to the document."""
    if kind == "reload":
        machine.reload()
        return
    if "server" in kind:
        machine.kill_server()
    if "browser" in kind:
        machine.kill_browser()
    elif "page" in kind:
        machine.crash_page()
    if "server" in kind:
        machine.start_server()
    if kind == "server":
        machine.wait()
        return
    if "browser" in kind:
        machine.start_browser(is_new="new" in kind)
    else:
        machine.open_again()
    machine.recover()


def wait_for_backup(machine: Machine, text: str) -> None:
    """Wait until the server's folder has the text, which it gets again after a crash."""
    end = monotonic() + MAX_WAIT
    while not any(text in path.read_text() for path in (machine.folder / ARCHIVE_NAME).glob("backup_*.txt")):
        assert monotonic() < end, text
        sleep(0.05)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_studio_crashes_and_reloads_lose_at_most_two_seconds_of_edits(machine: Machine, seed: int):
    """Write the loss of each failure."""
    chance = random.Random(seed)
    for _ in range(CRASH_COUNT):
        machine.times.clear()
        machine.edit(chance.uniform(0.0, chance.choice(MAX_EDITING_TIMES)))
        kind = chance.choice(KINDS)
        crashed = monotonic()
        fail(machine, kind)
        lost = machine.lost_time(crashed)
        sys.stdout.write(f"seed {seed}, {kind}: {lost:.2f} s of edits lost\n")
        assert lost <= (0.0 if kind in ("reload", "server") else MAX_LOST_TIME), kind
        wait_for_backup(machine, machine.page.value("kinesicStudio.state().text"))
