"""Fitting of labels and lines into the available space of a plot."""

from collections.abc import Iterable

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.report.plots.axes import FONT_SIZE, UNITS_PER_INCH

MAX_LINE_POINTS = 1000  # approximate largest number of drawn points of a line
_LETTER_WIDTH = 0.55 * FONT_SIZE / UNITS_PER_INCH  # [in] mean character width


def fit_text(words: str, width: float) -> str:
    """Shorten a text to fit a width [in]."""
    letters = int(width / _LETTER_WIDTH)
    return words if len(words) <= letters else words[: letters - 1] + "\u2026" if letters > 1 else ""


def spaced_indices(times: Iterable[float], min_interval: float) -> list[int]:
    """Return the indices of times at least `min_interval` [s] apart."""
    kept: list[int] = []
    last = -np.inf
    for k, time in enumerate(times):
        if time - last >= min_interval:
            kept.append(k)
            last = time
    return kept


def thin_line(times: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Reduce a line to about `MAX_LINE_POINTS` points, keeping its extremes.

    Times and values are (m,).
    """
    size = int(np.ceil(2 * len(times) / MAX_LINE_POINTS))
    if size < 3:
        return times, values
    starts = np.arange(0, len(times), size)
    pieces = np.split(values, starts[1:])
    extremes = [
        sorted({start + int(p.argmin()), start + int(p.argmax())}) for start, p in zip(starts, pieces, strict=True)
    ]
    kept = np.unique([0, len(times) - 1, *(k for pair in extremes for k in pair)])
    return times[kept], values[kept]
