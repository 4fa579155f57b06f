"""The page of a robot elsewhere, limp and guarded by a token: seen, moved by hand, captured, armed by a person."""

import asyncio
import re
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from time import monotonic, sleep

import numpy as np
import pytest

from kinesic.controller.perform import set_up
from kinesic.serve.server import Address
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.pages import WebFile
from kinesic.studio.page import page_files
from kinesic.studio.relay import open_relay

from ..chromium import binary, opened
from ..serve.conftest import running
from ..serve.sinks.test_arming import TOKEN, Limp
from .conftest import PATIENT, Studio

pytestmark = pytest.mark.realtime


@contextmanager
def relay(port: int, files: Mapping[str, WebFile], own: int = 0) -> Iterator[Address]:
    """A relay to a server, in a thread, on a port of its own."""
    loop, found, ready = asyncio.new_event_loop(), [], threading.Event()
    ended = asyncio.Event()

    async def act() -> None:
        async with open_relay(Address("127.0.0.1", own), Address("127.0.0.1", port), files) as door:
            found.append(door)
            ready.set()
            await ended.wait()

    thread = threading.Thread(target=lambda: loop.run_until_complete(act()))
    thread.start()
    try:
        assert ready.wait(10.0)
        yield found[0]
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


def test_a_limp_robot_elsewhere_is_seen_captured_and_armed_by_a_person_alone(attached: Studio, limp: Limp):
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
    page.click("#arm")
    page.until("document.querySelector('#arming').open")
    page.value("document.querySelector('#arm-yes').click()")  # a script is no person
    assert page.value("document.querySelector('#arming').open"), "the question still waits for a person"
    page.press("Escape", 27)
    assert not page.value("document.querySelector('#arming').open"), "at once, not when nobody has answered for 30 s"
    assert not limp.armed
    attached.until("s.stopped")  # Escape stops, whatever is open
    page.click("#resume")
    attached.until("!s.stopped")
    ask(page)
    page.click("#arm-yes")
    attached.until("s.report.servos.state === 'armed' && !document.querySelector('#perform').disabled")
    assert limp.armed


def ask(page) -> None:
    """Asks for torque until the server asks back: it does not while the motion goes on, as it does after a stop."""
    end = monotonic() + 30.0
    while monotonic() < end and not page.value("document.querySelector('#arming').open"):
        page.click("#arm")
        sleep(0.5)
    assert page.value("document.querySelector('#arming').open")
