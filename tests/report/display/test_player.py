"""Inline replay of a notebook in a browser."""

from collections.abc import Iterator

import pytest

from kinesic.metrics.dry_run import DryRun

from ...chromium import Page, binary, opened
from .frames import the_frame

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(binary() is None, reason="no Chromium: apt-get install chromium"),
]


@pytest.fixture(scope="module")
def page(calm: DryRun, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """Return a page that shows the HTML of a plan as a notebook does."""
    path = tmp_path_factory.mktemp("notebook") / "frame.html"
    path.write_text(the_frame(calm.plan._repr_html_())["srcdoc"], encoding="utf-8")
    with opened(path.as_uri()) as result:
        result.until("document.querySelector('#stage')?.hidden === false")
        yield result


def test_replay_in_a_notebook_display_stops_at_its_end(page: Page):
    clock = "Number(document.querySelector('[data-part=clock]').textContent.split(' ')[0])"
    end = page.value("Number(document.querySelector('[data-part=time]').max)")
    with page.undrawn():
        page.value(
            "const slider = document.querySelector('[data-part=time]');"
            f"slider.value = {end} - 0.5; slider.dispatchEvent(new Event('input'))"
        )
        page.click("[data-part=play]")
        page.until(f"{clock} > {end} - 0.3")
        page.until(f"Math.abs({clock} - {end}) < 0.01 && !document.querySelector('.playing')")


def test_playhead_of_the_timeline_in_a_notebook_display_follows_the_replay(page: Page):
    place = "parseFloat(document.querySelector('.plot.broad .playhead').style.left)"
    page.value("document.querySelector('[data-part=time]').value = 0")
    page.value("document.querySelector('[data-part=time]').dispatchEvent(new Event('input'))")
    first = page.value(place)
    page.value("document.querySelector('[data-part=time]').value = 2")
    page.value("document.querySelector('[data-part=time]').dispatchEvent(new Event('input'))")
    assert float(str(page.value(place))) > float(str(first)) + 5.0
