"""Figures of the report's page."""

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from kinesic.metrics.dry_run import DryRun
from kinesic.motion.desired import join_keys
from kinesic.report.page import write_page
from kinesic.report.plots.fitting import MAX_LINE_POINTS, fit_text, spaced_indices, thin_line
from kinesic.report.plots.hands import hands
from kinesic.report.plots.joints import HingeCurves, joints, still_hinges
from kinesic.report.plots.margins import margins
from kinesic.report.plots.score import NARROW_LAYOUT, draw_timeline
from kinesic.report.report import report


def words_of(figure: str) -> set[str | None]:
    drawn = re.findall(r"<svg.*</svg>", figure, flags=re.DOTALL)
    return {element.text for one in drawn for element in ElementTree.fromstring(one).iter()}


@pytest.fixture(scope="module")
def moves(hurried: DryRun) -> list[str]:
    return list(joints(hurried, HingeCurves.of(hurried)))


@pytest.fixture(scope="module")
def acts(hurried: DryRun) -> str:
    return draw_timeline(hurried.plan, float(hurried.measured.times[-1])) or ""


@pytest.fixture(scope="module")
def ways(hurried: DryRun) -> str:
    return hands(hurried)


def test_report_plots_are_valid_xml_and_show_only_moving_joints(
    hurried: DryRun, moves: list[str], acts: str, ways: str
) -> None:
    drawn = set().union(*(words_of(figure) for figure in moves))
    names = set(hurried.plan.setup.robot.skeleton.names)
    assert "skullbase_tilt" in drawn
    assert drawn & names == names - set(still_hinges(hurried, HingeCurves.of(hurried)))
    assert {"offer", "NOD", "Hello there,"} <= words_of(acts)
    assert len(words_of(ways)) > 3


def test_plots_over_time_have_playheads_at_their_axes(hurried: DryRun, moves: list[str], acts: str, ways: str) -> None:
    for figure in (acts, margins(hurried), *moves):
        heads = re.findall(r'class="playhead" data-from="([\d.]+)" data-to="([\d.]+)"', figure)
        assert heads
        assert all(0.0 < float(begin) < float(end) < 1.0 for begin, end in heads)
    assert "playhead" not in ways


def test_narrow_timeline_plot_has_the_labels_of_the_wide_one_above_the_bars(hurried: DryRun, acts: str) -> None:
    narrow = draw_timeline(hurried.plan, float(hurried.measured.times[-1]), NARROW_LAYOUT) or ""
    assert {"offer", "NOD"} <= words_of(narrow) & words_of(acts)
    (head,) = re.findall(r'class="playhead" data-from="([\d.]+)" data-to="([\d.]+)"', narrow)
    assert float(head[0]) == pytest.approx(NARROW_LAYOUT.left / NARROW_LAYOUT.width, abs=1e-4)
    assert float(head[1]) == pytest.approx(1 - NARROW_LAYOUT.right / NARROW_LAYOUT.width, abs=1e-4)


def test_plot_line_reduced_to_fewer_points_keeps_its_extremes() -> None:
    times = np.arange(120_000) / 100
    values = np.sin(times)
    values[77_777], values[4_321] = 5.0, -5.0
    few_times, few = thin_line(times, values)
    assert len(few) <= MAX_LINE_POINTS + 2
    assert (few.max(), few.min()) == (5.0, -5.0)
    assert few_times[0] == times[0]
    assert few_times[-1] == times[-1]
    assert (np.diff(few_times) > 0).all()


def test_plot_labels_are_shortened_to_the_available_width() -> None:
    assert fit_text("short", 3.0) == "short"
    assert fit_text("a very long name of a behaviour", 1.0).endswith("\u2026")
    assert fit_text("long", 0.01) == ""
    assert spaced_indices([0.0, 0.1, 1.0, 1.4, 2.1], 1.0) == [0, 2, 4]


def test_report_page_interpolates_the_desired_motion_once_for_all_plots_and_once_for_the_player(
    hurried: DryRun, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn, draw, data = [], join_keys, report(hurried, source="hurried.bml")
    monkeypatch.setattr("kinesic.planning.plan.join_keys", lambda *keys: drawn.append(keys) or draw(*keys))
    write_page(hurried, data, path=tmp_path / "report.html")
    assert len(drawn) == 2
