"""Figures of the page, as SVG in its colours: axes with few ticks that take data and draw them in place."""

from collections.abc import Callable, Iterable
from enum import StrEnum
from math import ceil, floor, log10
from typing import Literal

import numpy as np
from markupsafe import Markup, escape

from kinesic.body.arrays import Floats


class ThemeColour(StrEnum):
    """Variables of the page's style sheet, so that one figure suits light and dark."""

    INK = "var(--ink)"
    FAINT = "var(--faint)"
    GRID = "var(--grid)"
    OUTSIDE = "var(--outside)"
    ASKED = "var(--asked)"
    PLANNED = "var(--planned)"
    PERFORMED = "var(--performed)"
    SPEECH = "var(--speech)"
    FAIL = "var(--fail)"


WIDTH = 11.0  # [in] of a figure; the page scales it
INCH = 72  # units of the drawing, which are those of type
SMALL = 7.5  # size of letters
TICK, GAP = 2.0, 3.0  # length of a tick, and air to its label
TICK_SPACING = 60.0  # between ticks of time, at least
TICK_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)  # between ticks, times a power of ten
ABOVE = 0.05  # share of what is drawn that is left free above it, where nobody sets a limit

Align = Literal["left", "center", "right"]
ANCHORS: dict[Align, str] = {"left": "start", "center": "middle", "right": "end"}
DrawingLayer = Literal["under", "lines", "over"]


class Figure:
    """A figure to which axes are added."""

    def __init__(self, height: float, *, width: float = WIDTH, style: str = "plot") -> None:
        """Begins a figure.

        Args:
            height: [in].
            width: [in]; the page scales it to its own.
            style: its classes in the style sheet of the page.
        """
        self.height, self.width, self._style = height, width, style
        self._axes: list[Axes] = []
        self._words: list[str] = []

    def axes(self, left: float, bottom: float, width: float, height: float, *, timed: bool = False) -> "Axes":
        """Adds axes.

        Args:
            left: [in] from the figure's left.
            bottom: [in] from its foot.
            width: [in].
            height: [in].
            timed: whether they run over performance time, in which the replay shows where it is.
        """
        self._axes.append(Axes(left * INCH, (self.height - bottom - height) * INCH, width * INCH, height * INCH, timed))
        return self._axes[-1]

    def write(self, left: float, bottom: float, words: str) -> None:
        """Writes a title at a place [in] from the figure's left foot."""
        self._words.append(_text(left * INCH, (self.height - bottom) * INCH, words, ThemeColour.INK, "left", size=9.0))

    def svg(self) -> Markup:
        """Makes an element of the page of it."""
        body = "".join([*(axes.svg() for axes in self._axes), *self._words])
        columns = sorted({(axes.left, axes.left + axes.width) for axes in self._axes if axes.timed})
        heads = "".join(
            f'<i class="playhead" data-from="{x0 / INCH / self.width:.5f}" data-to="{x1 / INCH / self.width:.5f}"></i>'
            for x0, x1 in columns
        )
        view = f'viewBox="0 0 {self.width * INCH:g} {self.height * INCH:g}"'
        drawn = f"<svg {view}>{body}</svg>{heads}"
        return Markup(f'<div class="{self._style}"><div>{drawn}</div></div>')  # every text is escaped


class Axes:
    """A rectangle with an abscissa and an ordinate; what is drawn beyond its limits is cut."""

    def __init__(self, left: float, top: float, width: float, height: float, timed: bool) -> None:
        self.left, self.top, self.width, self.height, self.timed = left, top, width, height, timed
        self.labelled = True  # whether numbers stand below
        self.ticks = 3  # spaces between ticks of the ordinate, at most; 0: it has none
        self._x, self._y = (0.0, 1.0), (0.0, 1.0)
        self._highest = -np.inf  # of what is drawn
        self._drawn: list[tuple[DrawingLayer, Callable[[], str]]] = []

    def limit_x(self, first: float, last: float) -> None:
        """Sets the values at the left and the right end."""
        self._x = (first, last)

    def limit_y(self, low: float, high: float | None = None) -> None:
        """Sets the values at the foot and at the top; None: a little above what is drawn by now."""
        if high is None:
            high = self._highest + ABOVE * (self._highest - low) if self._highest > low else low + 1.0
        self._y = (low, high)

    @property
    def y_limits(self) -> tuple[float, float]:
        """The values at the foot and at the top."""
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
        """Draws a line through (m,) points."""
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
        """Draws a bar from `low` to `high` for each (begin, end)."""
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
        """Fills everything between two values of the ordinate."""
        self.bars([self._x], low, high, colour)

    def level(
        self, y: float, colour: ThemeColour, *, width: float = 0.8, span: tuple[float, float] | None = None
    ) -> None:
        """Draws a line at a value of the ordinate, all across or over a span of the abscissa."""

        def draw() -> str:
            x0, x1 = self._across(np.array(span or self._x))
            (at,) = self._down(np.array([y]))
            return _strokes([(x0, at, x1, at)], colour, width)

        self._drawn.append(("lines", draw))

    def verticals(
        self, at: Iterable[float], colour: ThemeColour, *, width: float = 1.0, span: tuple[float, float] | None = None
    ) -> None:
        """Draws lines at values of the abscissa, from foot to top or over a span of the ordinate."""
        places = np.array([*at], dtype=np.float64)

        def draw() -> str:
            y0, y1 = self._down(np.array(span or self._y))
            return _strokes([(x, y0, x, y1) for x in self._across(places)], colour, width)

        self._drawn.append(("lines", draw))

    def dots(self, x: Floats, y: Floats, fill: ThemeColour, edge: ThemeColour) -> None:
        """Draws a dot at each of (m,) points."""

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
        """Writes a text, which may stand outside.

        Args:
            at: the text's side that `align` names, and its base line.
            words: may come from strangers.
            colour: of the text.
            place: "axes": both of `at` are shares of the axes; "time": the first is a time; "data": both are data.
            align: which side of the text lies there.
        """

        def draw() -> str:
            x = self.width * at[0] if place == "axes" else float(self._across(np.array([at[0]]))[0])
            y = self.height * (1 - at[1]) if place != "data" else float(self._down(np.array([at[1]]))[0])
            return _text(self.left + x, self.top + y, words, colour, align)

        self._drawn.append(("over", draw))

    def head(self, what: str, note: str, *, height: float) -> None:
        """Writes what is shown above the left end, and a note above the right end, at a share of the height."""
        self.write((0.0, height), what)
        self.write((1.0, height), note, colour=ThemeColour.FAINT, align="right")

    def svg(self) -> str:
        """Draws everything: a nested drawing cuts what is beyond the limits."""
        inside = "".join(draw() for wanted in ("under", "lines") for layer, draw in self._drawn if layer == wanted)
        over = [draw() for layer, draw in self._drawn if layer == "over"]
        words = "".join(text for text in over if text.startswith("<text"))
        dots = "".join(text for text in over if not text.startswith("<text"))
        place = f'x="{self.left:.2f}" y="{self.top:.2f}" width="{self.width:.2f}" height="{self.height:.2f}"'
        frame = f'<rect style="fill:none;stroke:{ThemeColour.GRID};stroke-width:.5" {place}/>'
        grid, labels = self._scale()
        return f'{frame}<svg overflow="hidden" {place}>{grid}{inside}{dots}</svg>{labels}{words}'

    def _scale(self) -> tuple[str, str]:
        """Lines of the grid inside, and ticks with numbers outside."""
        foot, left = self.top + self.height, self.left
        grid, ticks, numbers = [], [], []
        for value, name in nice_ticks(*self._x, max(int(self.width / TICK_SPACING), 1)):
            (x,) = self._across(np.array([value]))
            grid.append((x, 0.0, x, self.height))
            ticks.append((left + x, foot, left + x, foot + TICK))
            if self.labelled:
                numbers.append(_text(left + x, foot + TICK + GAP + 0.7 * SMALL, name, ThemeColour.FAINT, "center"))
        for value, name in nice_ticks(*self._y, self.ticks) if self.ticks else ():
            (y,) = self._down(np.array([value]))
            grid.append((0.0, y, self.width, y))
            ticks.append((left - TICK, self.top + y, left, self.top + y))
            numbers.append(_text(left - TICK - GAP, self.top + y + 0.36 * SMALL, name, ThemeColour.FAINT, "right"))
        return _strokes(grid, ThemeColour.GRID, 0.5), _strokes(ticks, ThemeColour.FAINT, 0.5) + "".join(numbers)

    def _across(self, x: Floats) -> list[float]:
        first, last = self._x
        places: list[float] = ((x - first) / (last - first) * self.width).tolist()
        return places

    def _down(self, y: Floats) -> list[float]:
        low, high = self._y
        places: list[float] = ((high - y) / (high - low) * self.height).tolist()
        return places


def nice_ticks(first: float, last: float, most: int) -> list[tuple[float, str]]:
    """Finds round values between two limits, which divide them into at most `most` spaces, with their numbers."""
    low, high = sorted((first, last))
    least = (high - low) / most
    if not least > 0 or not np.isfinite(least):
        return []
    power = 10.0 ** floor(log10(least))
    step = next(factor * power for factor in TICK_STEPS if factor * power >= least * (1 - 1e-9))
    digits = next(digits for digits in range(12) if abs(round(step, digits) - step) < 1e-6 * step)
    counts = range(ceil(low / step - 1e-9), floor(high / step + 1e-9) + 1)
    return [(count * step, f"{count * step + 0.0:.{digits}f}".replace("-", "\u2212")) for count in counts]


def _strokes(ends: Iterable[tuple[float, float, float, float]], colour: ThemeColour, width: float) -> str:
    path = "".join(f"M{x0:.2f} {y0:.2f}L{x1:.2f} {y1:.2f}" for x0, y0, x1, y1 in ends)
    return f'<path style="stroke:{colour};stroke-width:{width:g}" d="{path}"/>' if path else ""


def _text(x: float, y: float, words: str, colour: ThemeColour, align: Align, *, size: float = SMALL) -> str:
    printable = "".join(letter if letter.isprintable() else " " for letter in words)
    look = f"font-size:{size:g}px;fill:{colour};text-anchor:{ANCHORS[align]}"
    return f'<text style="{look}" x="{x:.2f}" y="{y:.2f}">{escape(printable)}</text>'
