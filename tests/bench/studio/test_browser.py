"""The bench of the studio's page, in a real browser with a real server."""

from collections.abc import Iterator

import pytest

from kinesic.bench import studio
from kinesic.bench.studio.browser import Page, find_binary, open_browser

pytestmark = pytest.mark.realtime


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    if find_binary() is None:
        pytest.skip(studio.NO_BROWSER)
    with open_browser() as browser, browser.open_page("data:text/html,<p id=p>here</p>") as found:
        yield found


def test_what_a_page_tells_has_its_kind_and_what_it_does_not_tell_is_said(page: Page):
    page.wait("document.querySelector('#p') !== null")
    assert page.read("document.querySelector('#p').textContent", str) == "here"
    assert page.read("[1, 2.5]", list[float]) == [1.0, 2.5]
    with pytest.raises(RuntimeError, match=r"does not tell nowhere.*ReferenceError"):
        page.read("nowhere", str)
    with pytest.raises(RuntimeError, match=r"does not Page\.fly.*wasn't found"):
        page.call("Page.fly")


def test_the_pointer_moves_on_the_page(page: Page):
    page.read("void addEventListener('mousemove', event => window.at = [event.clientX, event.clientY]), 0", int)
    page.move("mouseMoved", 20.0, 30.0)
    page.wait("window.at")
    assert page.read("at", list[float]) == [20.0, 30.0]
