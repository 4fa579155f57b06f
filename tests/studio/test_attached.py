"""Page of a remote robot with torque off: display, posture capture and torque enabling."""

import asyncio
import re
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from time import monotonic, sleep

import numpy as np
import pytest

from kinesic.serve.server import Address
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.pages import WebFile
from kinesic.session.setup import set_up
from kinesic.studio.page import page_files
from kinesic.studio.relay import open_relay

from ..chromium import binary, opened
from ..serve.conftest import running
from ..serve.sinks.test_arming import TOKEN, Limp
from .conftest import PATIENT, Studio

pytestmark = pytest.mark.realtime


@contextmanager
def relay(port: int, files: Mapping[str, WebFile], own: int = 0) -> Iterator[Address]:
    """Run a relay to a server in a thread, on its own port."""
    loop, results, ready = asyncio.new_event_loop(), [], threading.Event()
    ended = asyncio.Event()

    async def act() -> None:
        async with open_relay(Address("127.0.0.1", own), Address("127.0.0.1", port), files) as door:
            results.append(door)
            ready.set()
            await ended.wait()

    thread = threading.Thread(target=lambda: loop.run_until_complete(act()))
    thread.start()
    try:
        assert ready.wait(10.0)
        yield results[0]
    finally:
        loop.call_soon_threadsafe(ended.set)
        thread.join(10.0)
        loop.close()


@pytest.fixture
def limp() -> Limp:
    return Limp()


@pytest.fixture
def attached(tmp_path, limp: Limp) -> Iterator[Studio]:
    if binary() is None:
        pytest.skip("no Chromium: apt-get install chromium")
    setup = set_up()
    with (
        running(PATIENT, Access(TOKEN), more=[limp]) as server,
        relay(server.port, page_files(setup.robot, setup.lexicon)) as door,
        opened(f"http://{door}/", drawn=False) as page,
    ):
        page.until("window.kinesicStudio !== undefined && kinesicStudio.state().connection === 'locked'")
        yield Studio(page, server, tmp_path)


def test_studio_captures_a_posture_of_a_remote_robot_and_enables_its_torque(attached: Studio, limp: Limp):
    page, robot = attached.page, set_up().robot
    page.value(f"document.querySelector('#token').value = '{TOKEN}'")
    page.click("#lock button")
    attached.until("s.connection === 'open' && s.report !== null")
    page.until("document.querySelectorAll('#strips .strip').length === 3")
    page.until("document.querySelector('#strips .faulty') !== null")
    strips = page.value("[...document.querySelectorAll('#strips .strip:not(.head)')].map(each => each.textContent)")
    assert strips == ["hinge14011.9", "hinge2silent\u2013\u2013"]

    page.value("document.querySelector('#lexicon').open = true")
    page.value(
        "(s => { s.value = 'idea bowl'; s.dispatchEvent(new Event('input')) })(document.querySelector('#search'))"
    )
    page.click("[aria-label='Edit a copy of conduit']")
    page.until("document.querySelector('#file').textContent === 'my_conduit.toml'")
    attached.until("s.draft?.gesture === 'my_conduit'")
    page.click("#mode-robot")
    attached.until("s.mode === 'robot'")
    page.value(
        "[...document.querySelectorAll('#keys .acts button')].find(e => e.textContent === 'Capture pose').click()"
    )
    attached.until("s.past === 1")
    seen = re.search(r"at = \[([^\]]+)\]", attached.state("text"))
    frames = robot.skeleton.frames(limp.health().angles)
    hands = [frames.origins[robot.arm(side).wrist] - robot.gesture_origin for side in "lr"]
    outward, up, forward = np.mean([[sign * y, z, x] for sign, (x, y, z) in zip((1, -1), hands, strict=True)], axis=0)
    expected = np.array([outward, up, forward]) / robot.arm_length
    assert [float(value) for value in seen[1].split(",")] == pytest.approx(expected.tolist(), abs=2e-3)

    assert page.value("document.querySelector('#perform').disabled")
    assert page.value("document.querySelector('#perform').textContent") == "Perform (motors off)"
    page.click("#arm")
    page.until("document.querySelector('#arming').open")
    page.value("document.querySelector('#arm-yes').click()")  # a script's click does not count
    assert page.value("document.querySelector('#arming').open"), "the question still waits for a person's click"
    page.press("Escape", 27)
    assert not page.value("document.querySelector('#arming').open"), "closed at once, not after the timeout of 30 s"
    assert not limp.armed
    attached.until("s.stopped")  # Escape also stops the robot
    page.click("#resume")
    attached.until("!s.stopped")
    ask(page)
    page.click("#arm-yes")
    attached.until("s.report.servos.state === 'armed' && !document.querySelector('#perform').disabled")
    assert limp.armed


def ask(page) -> None:
    """Request torque until the server asks for confirmation, which it does only at rest."""
    end = monotonic() + 30.0
    while monotonic() < end and not page.value("document.querySelector('#arming').open"):
        page.click("#arm")
        sleep(0.5)
    assert page.value("document.querySelector('#arming').open")
