"""Axes that draw data as SVG in the colours of the page."""

from collections.abc import Callable, Iterable
from enum import StrEnum
from math import ceil, floor, log10
from typing import Literal

import numpy as np
from markupsafe import Markup, escape

from kinesic.body.arrays import Floats


class ThemeColour(StrEnum):
    """CSS variables for plot colours in light and dark themes."""

    INK = "var(--ink)"
    FAINT = "var(--faint)"
    GRID = "var(--grid)"
    OUTSIDE = "var(--outside)"
    ASKED = "var(--asked)"
    PLANNED = "var(--planned)"
    PERFORMED = "var(--performed)"
    SPEECH = "var(--speech)"
    FAIL = "var(--fail)"


FIGURE_WIDTH = 11.0  # [in] width of a plot before the page scales it
UNITS_PER_INCH = 72  # SVG units, equal to typographic points
FONT_SIZE = 7.5  # [pt] size of all plot texts
TICK_LENGTH = 2.0  # [pt] length of axis ticks
LABEL_GAP = 3.0  # [pt] gap between a tick and its label
TICK_SPACING = 60.0  # [pt] smallest distance between time ticks
TICK_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)  # tick intervals, times a power of ten
HEADROOM_FRACTION = 0.05  # free height above data / height of the data, if no upper axis limit is given

Align = Literal["left", "center", "right"]
TEXT_ANCHORS: dict[Align, str] = {"left": "start", "center": "middle", "right": "end"}  # SVG text anchors, by alignment
DrawingLayer = Literal["under", "lines", "over"]


class Figure:
    """An SVG drawing that contains axes."""

    def __init__(self, height: float, *, width: float = FIGURE_WIDTH, style: str = "plot") -> None:
        """Create an empty figure.

        Args:
            height: [in].
            width: [in]; the page scales it.
            style: CSS classes of the figure.
        """
        self.height, self.width, self._style = height, width, style
        self._axes: list[PlotAxes] = []
        self._words: list[str] = []

    def axes(self, left: float, bottom: float, width: float, height: float, *, timed: bool = False) -> "PlotAxes":
        """Add axes at a position within the figure.

        Args:
            left: [in] from the left edge of the figure.
            bottom: [in] from its bottom edge.
            width: [in].
            height: [in].
            timed: whether the abscissa is performance time, on which the replay shows its position.
        """
        self._axes.append(
            PlotAxes(
                left * UNITS_PER_INCH,
                (self.height - bottom - height) * UNITS_PER_INCH,
                width * UNITS_PER_INCH,
                height * UNITS_PER_INCH,
                timed,
            )
        )
        return self._axes[-1]

    def write(self, left: float, bottom: float, words: str) -> None:
        """Write a title at a position [in] from the lower left corner."""
        self._words.append(
            _text(
                left * UNITS_PER_INCH, (self.height - bottom) * UNITS_PER_INCH, words, ThemeColour.INK, "left", size=9.0
            )
        )

    def svg(self) -> Markup:
        """Return the figure as an SVG element."""
        body = "".join([*(axes.svg() for axes in self._axes), *self._words])
        columns = sorted({(axes.left, axes.left + axes.width) for axes in self._axes if axes.timed})
        spans = ((x0 / UNITS_PER_INCH / self.width, x1 / UNITS_PER_INCH / self.width) for x0, x1 in columns)
        heads = "".join(f'<i class="playhead" data-from="{x0:.5f}" data-to="{x1:.5f}"></i>' for x0, x1 in spans)
        view = f'viewBox="0 0 {self.width * UNITS_PER_INCH:g} {self.height * UNITS_PER_INCH:g}"'
        drawn = f"<svg {view}>{body}</svg>{heads}"
        return Markup(f'<div class="{self._style}"><div>{drawn}</div></div>')  # every text is escaped


class PlotAxes:
    """Rectangular plot area with x and y axis."""

    def __init__(self, left: float, top: float, width: float, height: float, timed: bool) -> None:
        self.left, self.top, self.width, self.height, self.timed = left, top, width, height, timed
        self.labelled = True  # whether numbers stand below
        self.ticks = 3  # spaces between ticks of the ordinate, at most; 0: it has none
        self._x, self._y = (0.0, 1.0), (0.0, 1.0)
        self._highest = -np.inf  # of what is drawn
        self._drawn: list[tuple[DrawingLayer, Callable[[], str]]] = []

    def limit_x(self, first: float, last: float) -> None:
        """Set the x values at the left and right end."""
        self._x = (first, last)

    def limit_y(self, low: float, high: float | None = None) -> None:
        """Set the y values at the bottom and top.

        None selects a value slightly beyond the data drawn before.
        """
        if high is None:
            high = self._highest + HEADROOM_FRACTION * (self._highest - low) if self._highest > low else low + 1.0
        self._y = (low, high)

    @property
    def y_limits(self) -> tuple[float, float]:
        """Lowest and highest y value shown."""
        return self._y

    def line(
        self,
        x: Floats,
        y: Floats,
        colour: ThemeColour,
        *,
        width: float = 1.1,
        dashed: bool = False,
    ) -> None:
        """Draw a line through (m,) points."""
        self._highest = max(self._highest, float(y.max(initial=-np.inf)))
        look = f"fill:none;stroke:{colour};stroke-width:{width:g};stroke-linejoin:round;stroke-linecap:round"
        dashes = ";stroke-dasharray:4 2;stroke-linecap:butt" if dashed else ""

        def draw() -> str:
            points = " ".join(f"{a:.2f},{b:.2f}" for a, b in zip(self._across(x), self._down(y), strict=True))
            return f'<polyline style="{look}{dashes}" points="{points}"/>'

        self._drawn.append(("lines", draw))

    def bars(
        self, spans: Iterable[tuple[float, float]], low: float, high: float, colour: ThemeColour, opacity: float = 1.0
    ) -> None:
        """Draw a bar from `low` to `high` for each time span."""
        ends = [np.array(span) for span in spans]

        def draw() -> str:
            y0, y1 = sorted(self._down(np.array([low, high])))
            look = f"fill:{colour};fill-opacity:{opacity:g}"
            return "".join(
                f'<rect style="{look}" x="{x0:.2f}" y="{y0:.2f}" width="{x1 - x0:.2f}" height="{y1 - y0:.2f}"/>'
                for x0, x1 in (sorted(self._across(span)) for span in ends)
            )

        self._drawn.append(("under", draw))

    def band(self, low: float, high: float, colour: ThemeColour) -> None:
        """Fill the area between two y values over the whole width."""
        self.bars([self._x], low, high, colour)

    def level(
        self, y: float, colour: ThemeColour, *, width: float = 0.8, span: tuple[float, float] | None = None
    ) -> None:
        """Draw a horizontal line at a y value."""

        def draw() -> str:
            x0, x1 = self._across(np.array(span or self._x))
            (at,) = self._down(np.array([y]))
            return _strokes([(x0, at, x1, at)], colour, width)

        self._drawn.append(("lines", draw))

    def verticals(
        self, at: Iterable[float], colour: ThemeColour, *, width: float = 1.0, span: tuple[float, float] | None = None
    ) -> None:
        """Draw vertical lines over the whole y range or part of it."""
        places = np.array([*at], dtype=np.float64)

        def draw() -> str:
            y0, y1 = self._down(np.array(span or self._y))
            return _strokes([(x, y0, x, y1) for x in self._across(places)], colour, width)

        self._drawn.append(("lines", draw))

    def dots(self, x: Floats, y: Floats, fill: ThemeColour, edge: ThemeColour) -> None:
        """Draw a dot at each of (m,) points."""

        def draw() -> str:
            look = f"fill:{fill};stroke:{edge};stroke-width:.8"
            return "".join(
                f'<circle style="{look}" cx="{a:.2f}" cy="{b:.2f}" r="1.4"/>'
                for a, b in zip(self._across(x), self._down(y), strict=True)
            )

        self._drawn.append(("over", draw))

    def write(
        self,
        at: tuple[float, float],
        words: str,
        *,
        colour: ThemeColour = ThemeColour.INK,
        place: Literal["axes", "time", "data"] = "axes",
        align: Align = "left",
    ) -> None:
        """Write a text in or next to the axes.

        Args:
            at: position of the aligned side of the text and of its base line.
            words: text, possibly from a foreign document.
            colour: colour of the text.
            place: "axes": both are fractions of the axes; "time": the first is a time; "data": both are data.
            align: side of the text at that position.
        """

        def draw() -> str:
            x = self.width * at[0] if place == "axes" else float(self._across(np.array([at[0]]))[0])
            y = self.height * (1 - at[1]) if place != "data" else float(self._down(np.array([at[1]]))[0])
            return _text(self.left + x, self.top + y, words, colour, align)

        self._drawn.append(("over", draw))

    def write_heading(self, title: str, note: str, *, height: float) -> None:
        """Write a heading at the left and a note at the right.

        The height is a fraction of the axes.
        """
        self.write((0.0, height), title)
        self.write((1.0, height), note, colour=ThemeColour.FAINT, align="right")

    def svg(self) -> str:
        """Return the axes and their clipped data as SVG."""
        inside = "".join(
            draw() for layer_name in ("under", "lines") for layer, draw in self._drawn if layer == layer_name
        )
        over = [draw() for layer, draw in self._drawn if layer == "over"]
        words = "".join(text for text in over if text.startswith("<text"))
        dots = "".join(text for text in over if not text.startswith("<text"))
        place = f'x="{self.left:.2f}" y="{self.top:.2f}" width="{self.width:.2f}" height="{self.height:.2f}"'
        frame = f'<rect style="fill:none;stroke:{ThemeColour.GRID};stroke-width:.5" {place}/>'
        grid, labels = self._scale()
        return f'{frame}<svg overflow="hidden" {place}>{grid}{inside}{dots}</svg>{labels}{words}'

    def _scale(self) -> tuple[str, str]:
        """Draw grid lines, ticks and tick labels."""
        foot, left = self.top + self.height, self.left
        grid, ticks, numbers = [], [], []
        for value, name in nice_ticks(*self._x, max(int(self.width / TICK_SPACING), 1)):
            (x,) = self._across(np.array([value]))
            grid.append((x, 0.0, x, self.height))
            ticks.append((left + x, foot, left + x, foot + TICK_LENGTH))
            if self.labelled:
                numbers.append(
                    _text(left + x, foot + TICK_LENGTH + LABEL_GAP + 0.7 * FONT_SIZE, name, ThemeColour.FAINT, "center")
                )
        for value, name in nice_ticks(*self._y, self.ticks) if self.ticks else ():
            (y,) = self._down(np.array([value]))
            grid.append((0.0, y, self.width, y))
            ticks.append((left - TICK_LENGTH, self.top + y, left, self.top + y))
            numbers.append(
                _text(left - TICK_LENGTH - LABEL_GAP, self.top + y + 0.36 * FONT_SIZE, name, ThemeColour.FAINT, "right")
            )
        return _strokes(grid, ThemeColour.GRID, 0.5), _strokes(ticks, ThemeColour.FAINT, 0.5) + "".join(numbers)

    def _across(self, x: Floats) -> list[float]:
        first, last = self._x
        places: list[float] = ((x - first) / (last - first) * self.width).tolist()
        return places

    def _down(self, y: Floats) -> list[float]:
        low, high = self._y
        places: list[float] = ((high - y) / (high - low) * self.height).tolist()
        return places


def nice_ticks(first: float, last: float, max_count: int) -> list[tuple[float, str]]:
    """Return round values between two limits, with their labels.

    They divide the range into at most `max_count` intervals.
    """
    low, high = sorted((first, last))
    min_step = (high - low) / max_count
    if not min_step > 0 or not np.isfinite(min_step):
        return []
    power = 10.0 ** floor(log10(min_step))
    step = next(factor * power for factor in TICK_STEPS if factor * power >= min_step * (1 - 1e-9))
    digits = next(digits for digits in range(12) if abs(round(step, digits) - step) < 1e-6 * step)
    counts = range(ceil(low / step - 1e-9), floor(high / step + 1e-9) + 1)
    return [(count * step, f"{count * step + 0.0:.{digits}f}".replace("-", "\u2212")) for count in counts]


def _strokes(ends: Iterable[tuple[float, float, float, float]], colour: ThemeColour, width: float) -> str:
    path = "".join(f"M{x0:.2f} {y0:.2f}L{x1:.2f} {y1:.2f}" for x0, y0, x1, y1 in ends)
    return f'<path style="stroke:{colour};stroke-width:{width:g}" d="{path}"/>' if path else ""


def _text(x: float, y: float, words: str, colour: ThemeColour, align: Align, *, size: float = FONT_SIZE) -> str:
    printable = "".join(letter if letter.isprintable() else " " for letter in words)
    look = f"font-size:{size:g}px;fill:{colour};text-anchor:{TEXT_ANCHORS[align]}"
    return f'<text style="{look}" x="{x:.2f}" y="{y:.2f}">{escape(printable)}</text>'
