"""Clock of the page during a performance on the robot."""

import pytest

from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
WAVE = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">
  <gesture id="g" lexeme="wave" start="0"/>
</bml>"""
LABEL = "document.querySelector('#performing').textContent"


def test_studio_clock_shows_the_time_of_a_running_performance_and_stops_at_its_end(studio: Studio):
    studio.write(WAVE)
    studio.until("s.draft?.block === 'doc' && !document.querySelector('#perform').disabled")
    assert studio.page.value(LABEL) == ""
    studio.page.click("#perform")
    studio.page.until(f"/^Performing [0-9]+[.][1-9] s$/.test({LABEL})")
    studio.page.until(f"{LABEL} === 'Finished'")
    assert studio.state("time") == pytest.approx(studio.state("draft")["duration"])
    duration = f"{studio.state('draft')['duration']:.2f}"
    assert studio.page.value("document.querySelector('#clock').textContent") == f"{duration} / {duration} s"


def test_studio_does_not_report_a_stopped_performance_as_finished(studio: Studio):
    studio.write(WAVE)
    studio.page.click("#perform")
    studio.page.until(f"{LABEL}.startsWith('Performing')")
    studio.page.click("#stop")
    studio.until("s.stopped")
    studio.rest(1.0)
    assert studio.page.value(LABEL) == ""
    studio.page.click("#resume")
    studio.until("!s.stopped")
