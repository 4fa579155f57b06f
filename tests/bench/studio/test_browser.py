"""Benchmark of the studio's page with a real browser."""

from collections.abc import Iterator

import pytest

from kinesic.bench import studio
from kinesic.bench.studio.browser import Page, find_binary, open_browser

pytestmark = pytest.mark.realtime


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    if find_binary() is None:
        pytest.skip(studio.BROWSER_MISSING)
    with open_browser() as browser, browser.open_page("data:text/html,<p id=p>here</p>") as opened:
        yield opened


def test_browser_page_returns_typed_values_and_reports_javascript_errors(page: Page):
    page.wait("document.querySelector('#p') !== null")
    assert page.read("document.querySelector('#p').textContent", str) == "here"
    assert page.read("[1, 2.5]", list[float]) == [1.0, 2.5]
    with pytest.raises(RuntimeError, match=r"does not tell nowhere.*ReferenceError"):
        page.read("nowhere", str)
    with pytest.raises(RuntimeError, match=r"does not Page\.fly.*wasn't found"):
        page.call("Page.fly")


def test_browser_page_receives_pointer_moves(page: Page):
    page.read("void addEventListener('mousemove', event => window.at = [event.clientX, event.clientY]), 0", int)
    page.move("mouseMoved", 20.0, 30.0)
    page.wait("window.at")
    assert page.read("at", list[float]) == [20.0, 30.0]
