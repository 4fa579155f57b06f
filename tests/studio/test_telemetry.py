"""Telemetry over time in the browser: recording, scrubbing and export."""

import csv
from pathlib import Path
from time import monotonic, sleep

from ..chromium import MAX_WAIT
from .conftest import Studio

DRAWN = False  # WebGL pictures are tested in test_stage.py
RAISED = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="raise">'
    '<gesture id="g" lexeme="stop" mode="RIGHT_HAND" start="0"/></bml>'
)
RECORDING = "kinesicStudio.recording.recording"


def scrub(studio: Studio, before: float) -> None:
    slider = "document.querySelector('#history-time')"
    studio.page.value(f"{slider}.value = '{before}'; {slider}.dispatchEvent(new Event('input')); 0")


def perform(studio: Studio) -> None:
    """Raise a hand, and wait until it is down again."""
    studio.write(RAISED)
    studio.page.click("#perform")
    studio.until("s.mode === 'robot' && s.report.planned.some(angle => Math.abs(angle) > 0.9)")
    studio.until("s.report.planned.every(angle => Math.abs(angle) < 0.6)")


def test_studio_shows_recorded_posture_and_values_until_return_to_live_telemetry(studio: Studio):
    perform(studio)
    page = studio.page
    highest = (
        f"(reports => reports.reduce((best, each) => Math.max(...each.planned.map(Math.abs)) >"
        f" Math.max(...best.planned.map(Math.abs)) ? each : best))({RECORDING}.reports)"
    )
    time = page.value(f"{highest}.time")
    end = page.value(f"{RECORDING}.end")
    scrub(studio, time - end - 0.01)
    shown = page.value("kinesicStudio.robot.shown.planned")
    assert max(map(abs, shown)) > 0.8, "the raised hand"
    assert max(map(abs, studio.state("report")["planned"])) < 0.6, "the robot itself rests"
    assert "s earlier" in page.value("document.querySelector('#history-status').textContent")
    angles = "[...document.querySelectorAll('#strips .value')].map(each => each.textContent).filter(text => text)"
    raised = page.value(angles)
    studio.rest(0.3)
    assert page.value(angles) == raised, "new reports do not replace the shown one"
    page.click("#history-live")
    assert page.value("kinesicStudio.robot.earlier === null")
    studio.rest(0.3)
    assert page.value(angles) != raised


def test_time_of_the_studio_telemetry_chart_is_chosen_with_the_pointer(studio: Studio):
    page = studio.page
    page.value("document.querySelector('#measure').value = 'tracking'; 0")
    page.value("document.querySelector('#history-chart').scrollIntoView({block: 'center'})")
    studio.rest(1.0)
    chart = "document.querySelector('#history-chart')"
    pixels = f"{chart}.getContext('2d').getImageData(0, 0, {chart}.width, {chart}.height).data"
    assert page.value(f"{pixels}.filter((value, k) => k % 4 === 3 && value > 0).length") > 0
    x, y, width = page.value(f"(r => [r.x, r.y + r.height / 2, r.width])({chart}.getBoundingClientRect())")
    page.drag((x + width - 2, y), (x + width - 4, y), (x + 0.75 * width, y))
    before, least = page.value("(e => [Number(e.value), Number(e.min)])(document.querySelector('#history-time'))")
    assert -120.0 <= least <= -20.0
    assert abs(before / least - 0.25) < 0.02
    assert page.value("kinesicStudio.robot.earlier !== null")
    page.click("#history-live")


def test_studio_exports_a_telemetry_recording_as_a_csv_file(studio: Studio, tmp_path: Path):
    studio.page.call(
        "Browser.setDownloadBehavior",
        behavior="allow",
        downloadPath=str(tmp_path),
        browserContextId=studio.page.context,
    )
    studio.page.click("#history-save")
    end, file = monotonic() + MAX_WAIT, tmp_path / "recording.csv"
    while not file.exists():
        assert monotonic() < end
        sleep(0.05)
    rows = list(csv.DictReader(file.read_text().splitlines()))
    hinges = studio.page.value("kinesicStudio.about.robot.hinges")
    assert set(rows[0]) == {"time_s", *(f"{name}_{kind}_deg" for name in hinges for kind in ("planned", "measured"))}
    times = [float(row["time_s"]) for row in rows]
    assert times == sorted(times)
    assert len(rows) > 20
    largest = max(abs(float(row[f"{name}_planned_deg"])) for row in rows for name in hinges)
    assert largest > 50.0, "the raised hand"
