"""Axes of figures: data positions, clipping at the limits, and escaped text."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from kinesic.report.plots.axes import FIGURE_WIDTH, UNITS_PER_INCH, Figure, PlotAxes, ThemeColour, nice_ticks


@pytest.fixture
def drawn() -> tuple[Figure, PlotAxes]:
    """Draw square axes of 1 in with left and lower margins."""
    figure = Figure(3.0)
    axes = figure.axes(2.0, 1.0, 1.0, 1.0)
    axes.limit_x(0.0, 10.0)
    axes.limit_y(-1.0, 1.0)
    return figure, axes


def numbers(text: str) -> list[float]:
    return [float(value) for value in re.findall(r"-?[\d.]+", text)]


def elements(figure: Figure, tag: str) -> list[ElementTree.Element]:
    (text,) = re.findall(r"<svg.*</svg>", figure.svg())
    return [element for element in ElementTree.fromstring(text).iter() if element.tag == tag]


def test_plot_data_are_drawn_at_their_coordinates(drawn: tuple[Figure, PlotAxes]):
    figure, axes = drawn
    axes.line(np.array([0.0, 5.0, 10.0]), np.array([-1.0, 0.0, 1.0]), ThemeColour.PLANNED)
    (line,) = elements(figure, "polyline")
    assert numbers(line.attrib["points"]) == [
        0.0,
        UNITS_PER_INCH,
        UNITS_PER_INCH / 2,
        UNITS_PER_INCH / 2,
        UNITS_PER_INCH,
        0.0,
    ]
    _, inner = elements(figure, "svg")
    assert [float(inner.attrib[name]) for name in ("x", "y", "width", "height")] == [
        2 * UNITS_PER_INCH,
        UNITS_PER_INCH,
        UNITS_PER_INCH,
        UNITS_PER_INCH,
    ]
    assert inner.attrib["overflow"] == "hidden", "what is beyond the limits is cut"


def test_plot_axis_runs_backwards_if_its_first_limit_is_the_larger_one(drawn: tuple[Figure, PlotAxes]):
    figure, axes = drawn
    axes.limit_x(10.0, 0.0)
    axes.limit_y(4.0, 0.0)
    axes.bars([(1.0, 2.0)], 1.0, 3.0, ThemeColour.SPEECH, 0.5)
    frame, bar = elements(figure, "rect")
    assert "fill:none" in frame.attrib["style"]
    places = [float(bar.attrib[name]) for name in ("x", "y", "width", "height")]
    assert places == pytest.approx(
        [0.8 * UNITS_PER_INCH, UNITS_PER_INCH / 4, 0.1 * UNITS_PER_INCH, UNITS_PER_INCH / 2], abs=0.01
    )


def test_missing_upper_axis_limit_leaves_headroom_above_the_data(drawn: tuple[Figure, PlotAxes]):
    _, axes = drawn
    axes.line(np.array([0.0, 1.0]), np.array([2.0, 8.0]), ThemeColour.PLANNED)
    axes.limit_y(0.0)
    assert axes.y_limits == (0.0, pytest.approx(8.4))


def test_markup_in_plot_texts_is_escaped(drawn: tuple[Figure, PlotAxes]):
    figure, axes = drawn
    axes.write((1.0, 1.0), "<script>\x9b&", align="right")
    text = next(element for element in elements(figure, "text") if element.text == "<script> &")
    assert "text-anchor:end" in text.attrib["style"]
    assert (float(text.attrib["x"]), float(text.attrib["y"])) == (3 * UNITS_PER_INCH, UNITS_PER_INCH)


def test_tick_labels_are_drawn_only_if_enabled(drawn: tuple[Figure, PlotAxes]):
    figure, axes = drawn
    assert {element.text for element in elements(figure, "text")} >= {"0", "10", "\u22121"}
    axes.labelled, axes.ticks = False, 0
    assert elements(figure, "text") == []


def test_plot_states_the_left_and_right_end_of_its_time_axis_for_the_playhead():
    figure = Figure(1.0)
    figure.axes(1.1, 0.3, 4.4, 0.5, timed=True)
    assert 'data-from="0.10000" data-to="0.50000"' in figure.svg()
    assert FIGURE_WIDTH == 11.0


@pytest.mark.parametrize(
    ("limits", "most", "names"),
    [
        ((0.0, 11.6), 10, ["0", "2", "4", "6", "8", "10"]),
        ((0.0, 1.1), 3, ["0.0", "0.5", "1.0"]),
        ((-16.0, 14.0), 3, ["\u221210", "0", "10"]),
        ((10.0, 0.0), 4, ["0.0", "2.5", "5.0", "7.5", "10.0"]),
        ((2e-4, 9e-4), 4, ["0.0002", "0.0004", "0.0006", "0.0008"]),
        ((3.0, 3.0), 3, []),
    ],
)
def test_plot_axis_ticks_are_few_round_values(limits: tuple[float, float], most: int, names: list[str]):
    ticks = nice_ticks(*limits, most)
    assert [name for _, name in ticks] == names
    assert all(min(limits) - 1e-9 <= value <= max(limits) + 1e-9 for value, _ in ticks)
