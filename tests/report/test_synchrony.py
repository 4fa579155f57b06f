"""Times between words and highest hand speed in report and page."""

from pathlib import Path

from kinesic.controller.dry_run import dry_run
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.report.page import format_shift, write_page
from kinesic.report.report import report
from kinesic.session.plan import plan


def page(performance: DryRun, folder: Path) -> str:
    path = folder / "page.html"
    write_page(performance, report(performance, source="x.bml"), path=path)
    return path.read_text(encoding="utf-8")


def test_report_states_the_time_between_a_word_and_the_fastest_hand_motion(
    known: Setup, calm: DryRun, tmp_path: Path
) -> None:
    tied = (
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><speech id="s" start="1.5"><text>Well, '
        '<sync id="m"/>hello</text></speech><gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m"/></bml>'
    )
    performed = dry_run(plan(tied, known))
    data, (stroke,) = report(performed, source="x.bml"), performed.stroke_lags
    rows = {row["id"]: row for row in data["sync"]}
    row = rows["b:g:stroke"]
    assert (row["word"], row["accent_s"], row["fastest_s"]) == ("s:m", stroke.accent, stroke.fastest)
    assert row["fastest_lag_s"] == row["fastest_s"] - row["accent_s"] == stroke.lag
    assert {row["word"] for id, row in rows.items() if id != "b:g:stroke"} == {None}
    assert data["synchrony"] == {"strokes": 1, "median_s": abs(stroke.lag)}
    written = page(performed, tmp_path)
    assert f"peak hand speed {1000 * abs(stroke.lag):.0f}&#8239;ms from the word (median)" in written
    assert f'{format_shift(stroke.lag)} <span class="faint">s:m</span>' in written
    assert "peak hand speed" not in page(calm, tmp_path)
